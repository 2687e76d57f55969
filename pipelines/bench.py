"""make bench: runs every benchmark program and gathers runs/bench/bench.json.

    python3 pipelines/bench.py [WORD ...]       only programs whose names hold one of the words; "calculix" is the last one

Each program build/bin/bench_* prints one JSON object a line: {name, value, unit, reference, ratio, ranks}. Programs
whose name ends in _ranks are run with 1 and with 2 ranks; bench_structure counts its own threads as ranks. Last comes the
closed valve beside CalculiX (tests/bench/structure_calculix.py), which skips CalculiX's half where it is not installed.
bench.json is the list of these objects; run.json beside it says by which command, at which commit and on which machine it
was made, and how busy that was. Both are rewritten as a whole after every program, so that a run that is stopped leaves
what it has measured.
"""

import json
import os
import subprocess
import sys
import time

from structure_runs import ROOT, provenance, replace

OUT = ROOT / "runs" / "bench" / "bench.json"


def run(program, ranks):
    words = [str(program)]
    if ranks > 1:
        words = ["mpirun", "--oversubscribe", "--bind-to", "none", "-np", str(ranks)] + words
    environment = dict(os.environ, OMPI_ALLOW_RUN_AS_ROOT="1", OMPI_ALLOW_RUN_AS_ROOT_CONFIRM="1", OMP_NUM_THREADS="1")
    entries = []
    with subprocess.Popen(words, env=environment, stdout=subprocess.PIPE, text=True) as process:
        for line in process.stdout:
            if line.startswith("{"):
                entry = json.loads(line)
                entries.append(entry)
                share = f", {100 * entry['ratio']:.0f} % of the bound" if entry.get("ratio") else ""
                print(f"  {entry['name']} = {entry['value']:.4g} {entry['unit']} ({entry['ranks']} ranks{share})", flush=True)
    if process.returncode:
        sys.exit(f"error: {program.name} on {ranks} ranks failed with exit code {process.returncode}")
    return entries


def main():
    words = sys.argv[1:]
    wanted = lambda name: not words or any(word in name for word in words)
    programs = [p for p in sorted((ROOT / "build" / "bin").glob("bench_*")) if wanted(p.name)]
    if not programs and not wanted("calculix"):
        sys.exit(f"error: no program build/bin/bench_* holds {' or '.join(words)} in its name; 'make build' makes them")
    entries, made = [], provenance() | {"programs": {}}
    start = time.monotonic()
    for program in programs:
        for ranks in (1, 2) if program.name.endswith("_ranks") else (1,):
            print(f"{program.name}, {ranks} ranks ({time.monotonic() - start:.0f} s since the start)", flush=True)
            began = time.monotonic()
            entries += run(program, ranks)
            made["programs"][f"{program.name}, {ranks} ranks"] = {"wall_s": round(time.monotonic() - began, 1)}
            replace(OUT, json.dumps(entries, indent=2) + "\n")
            replace(OUT.with_name("run.json"), json.dumps(made, indent=2) + "\n")
    if programs:
        print(f"written: {OUT.relative_to(ROOT)} after {time.monotonic() - start:.0f} s", flush=True)
    if wanted("calculix"):
        subprocess.run([sys.executable, ROOT / "tests" / "bench" / "structure_calculix.py"], check=True)
    print(f"all: {time.monotonic() - start:.0f} s")


if __name__ == "__main__":
    main()
