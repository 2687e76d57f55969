"""Runs a case, one stage of it, or a cohort; the Makefile's targets call this.

  python3 pipelines/pipeline.py run demo --fidelity draft
  python3 pipelines/pipeline.py stage crimp demo --force
  python3 pipelines/pipeline.py cohort pipelines/cohorts/anatomies.csv --jobs 2
"""

import argparse
import sys
import time
from pathlib import Path

import cohort
from stages import ORDER, CaseError, Chain


def run_stage(chain, stage, force, resume):
    """Brings one stage up to date. Returns its exit code."""
    if not force and chain.is_up_to_date(stage):
        print(f"== {stage}: up to date ({chain.folder / stage})", flush=True)
        return 0
    print(f"== {stage}", flush=True)
    start = time.monotonic()
    code = chain.run(stage, *(["--resume"] if resume and stage != "report" else []))
    print(f"== {stage}: {'done' if code == 0 else f'failed with exit code {code}'} in {time.monotonic() - start:.0f} s", flush=True)
    return code


def run_case(chain, force=False, resume=False):
    """The whole chain, stopping at the first stage that fails; the report is made of what there is."""
    start = time.monotonic()
    code = 0
    for stage in chain.stages():
        if stage == "report":
            continue
        code = run_stage(chain, stage, force, resume)
        if code:
            break
    report_code = run_stage(chain, "report", True, False)
    print(f"case {chain.name}: {time.monotonic() - start:.0f} s")
    if report_code == 0:
        print(f"report: {(chain.folder / 'report.html').resolve()}")
    return code or report_code


def parse(arguments):
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    commands = parser.add_subparsers(dest="command", required=True)
    for name in ("run", "stage", "cohort"):
        command = commands.add_parser(name)
        if name == "stage":
            command.add_argument("stage", choices=ORDER)
        command.add_argument("file" if name == "cohort" else "case")
        command.add_argument("--fidelity", choices=["draft", "standard", "fine", "reference"])
        command.add_argument("--ranks", type=int)
        command.add_argument("--set", action="append", default=[], dest="overrides", metavar="table.key=value")
        command.add_argument("--force", action="store_true")
        command.add_argument("--resume", action="store_true")
        command.add_argument("--runs", type=Path, default=Path("runs"))
        if name == "cohort":
            command.add_argument("--jobs", type=int, default=1)
    return parser.parse_args(arguments)


def main(arguments):
    options = parse(arguments)
    try:
        if options.command == "cohort":
            return cohort.run(options)
        chain = Chain(options.case, options.fidelity, options.overrides, options.ranks, options.runs)
        if options.command == "run":
            return run_case(chain, options.force, options.resume)
        if options.stage not in chain.stages():
            raise CaseError(f"{chain.path}: the scene has no stage '{options.stage}' (it has {', '.join(chain.stages())})")
        if not chain.fidelity and (level := chain.fidelity_of_run(options.stage)):
            chain.fidelity = level
            print(f"fidelity {level}, as in {chain.folder} (FIDELITY=... for another)", flush=True)
        return run_stage(chain, options.stage, options.force, options.resume)
    except CaseError as error:
        print(f"error: {error}", file=sys.stderr)
        return 2


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
