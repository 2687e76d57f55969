"""make bench: runs every benchmark program and gathers runs/bench/bench.json.

Each program build/bin/bench_* prints one JSON object a line: {name, value, unit, reference, ratio, ranks}. Programs
whose name ends in _ranks are run with 1 and with 2 ranks; bench_structure counts its own threads as ranks. Last comes the
closed valve beside CalculiX (tests/bench/structure_calculix.py), which skips CalculiX's half where it is not installed.
"""

import json
import os
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent


def run(program, ranks):
    words = [str(program)]
    if ranks > 1:
        words = ["mpirun", "--oversubscribe", "--bind-to", "none", "-np", str(ranks)] + words
    environment = dict(os.environ, OMPI_ALLOW_RUN_AS_ROOT="1", OMPI_ALLOW_RUN_AS_ROOT_CONFIRM="1", OMP_NUM_THREADS="1")
    done = subprocess.run(words, env=environment, stdout=subprocess.PIPE, text=True)
    if done.returncode:
        sys.exit(f"error: {program.name} on {ranks} ranks failed with exit code {done.returncode}")
    return [json.loads(line) for line in done.stdout.splitlines() if line.startswith("{")]


def main():
    programs = sorted((ROOT / "build" / "bin").glob("bench_*"))
    entries = []
    for program in programs:
        for ranks in (1, 2) if program.name.endswith("_ranks") else (1,):
            found = run(program, ranks)
            entries += found
            for entry in found:
                print(f"{entry['name']} = {entry['value']:.4g} {entry['unit']} ({entry['ranks']} ranks)")
    out = ROOT / "runs" / "bench" / "bench.json"
    out.parent.mkdir(parents=True, exist_ok=True)
    out.write_text(json.dumps(entries, indent=2) + "\n")
    print(f"written: {out.relative_to(ROOT)}")
    subprocess.run([sys.executable, ROOT / "tests" / "bench" / "structure_calculix.py"], check=True)


if __name__ == "__main__":
    main()
