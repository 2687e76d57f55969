"""A small case through every stage; then each stage again, killed without warning, resumed, and compared bit for bit.

Usage: small_chain.py BUILD_BIN
"""

import json
import os
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from states import differences, newest

BIN = Path(sys.argv[1]).resolve()
CASE = Path(__file__).with_name("small.toml")
STAGES = ["segment", "mesher", "stent", "crimp", "deploy", "cycle"]


def words(stage, out, *extra):
    command = [str(BIN / f"valsalva-{stage}"), str(CASE), "--fidelity", "draft", "--out", str(out / stage), "--quiet", *extra]
    if stage == "cycle":
        command = ["mpirun", "--oversubscribe", "--bind-to", "none", "-np", "2"] + command
    return command


def environment():
    return dict(os.environ, OMPI_ALLOW_RUN_AS_ROOT="1", OMPI_ALLOW_RUN_AS_ROOT_CONFIRM="1", OMP_NUM_THREADS="1")


def run(stage, out, *extra):
    start = time.monotonic()
    done = subprocess.run(words(stage, out, *extra), env=environment(), stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    if done.returncode:
        sys.exit(f"FAILED  {stage} {' '.join(extra)}: exit code {done.returncode}\n{done.stdout[-3000:]}")
    return time.monotonic() - start


def check_summary(stage, folder):
    """Status, the names of the schema, and no metric that could not be computed."""
    summary = json.loads((folder / stage / "summary.json").read_text())
    keys = ["schema", "stage", "case", "status", "version", "fidelity", "ranks", "steps", "simulated_s", "wall_s",
            "peak_rss_MiB", "inputs", "parameters_sha256", "metrics", "checks"]
    missing = [key for key in keys if key not in summary]
    unknown = [name for name, value in summary["metrics"].items() if value is None]
    if missing or summary["status"] != "ok" or not summary["metrics"]:
        sys.exit(f"FAILED  {stage}: summary.json lacks {missing}, status {summary['status']}")
    print(f"{stage}: {summary['steps']} steps, {summary['wall_s']:.1f} s; not computed: {', '.join(unknown) or 'nothing'}", flush=True)


def kill_and_resume(stage, whole, out, seconds):
    """Kills the stage after its first checkpoint (or late in its run when it writes none), then resumes it."""
    for parent in STAGES[: STAGES.index(stage)]:
        if not (out / parent).exists():
            (out / parent).symlink_to(whole / parent)
    process = subprocess.Popen(words(stage, out), env=environment(), stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, start_new_session=True)
    start = time.monotonic()
    while process.poll() is None and time.monotonic() - start < 3 * seconds + 60:
        if newest(out / stage) and time.monotonic() - start > 0.3 * seconds:
            break
        if not newest(out / stage) and time.monotonic() - start > 0.7 * seconds:
            break
        time.sleep(0.02)
    os.killpg(process.pid, signal.SIGKILL)
    process.wait()
    checkpoint = newest(out / stage)
    run(stage, out, *(["--resume"] if checkpoint else []))
    found = differences(newest(whole / stage), newest(out / stage))
    print(f"{stage}: killed {'after ' + checkpoint.name if checkpoint else 'before its first checkpoint'}; "
          f"{'the same bits' if not found else 'DIFFERS'}", flush=True)
    for line in found[:10]:
        print(f"        {line}")
    return not found


def main():
    with tempfile.TemporaryDirectory() as folder:
        folder = Path(folder)
        whole = folder / "whole"
        seconds = {}
        for stage in STAGES:
            seconds[stage] = run(stage, whole)
            check_summary(stage, whole)
        good = []
        for stage in STAGES:
            out = folder / f"killed-{stage}"
            out.mkdir()
            good.append(kill_and_resume(stage, whole, out, seconds[stage]))
            shutil.rmtree(out, ignore_errors=True)
    print(f"{sum(good)} passed, {len(good) - sum(good)} failed")
    return 0 if all(good) else 1


if __name__ == "__main__":
    sys.exit(main())
