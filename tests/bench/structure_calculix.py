"""The closed valve of bench_structure by Newton, here and with CalculiX, on the same meshes and with the same law.

    python3 tests/bench/structure_calculix.py [BUILD] [--large]      writes runs/bench/calculix.json and prints tables

Error: the largest difference of the four probes' displacements from those of the finest hex27 mesh, over the largest
displacement; --large adds meshes of 64 x 64. Time: processor time of the whole program on one thread (mesh, solution, output), which other work on the
machine disturbs less than wall time; wall time is in the file too. CalculiX tries a first increment of the whole load
and of a quarter; the faster one counts. Without CalculiX (apt-get install calculix-ccx) only our half runs, and says so.
"""

import json
import math
import os
import resource
import shutil
import subprocess
import sys
import tempfile
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent.parent
sys.path.insert(0, str(ROOT / "pipelines"))
from structure_runs import provenance, replace

SIZES = (8, 16, 32, 64) if "--large" in sys.argv else (8, 16, 32)
REFERENCE = ("hex27-mixed", 24, 1)
OURS = [("hex8-mixed", n, 2) for n in SIZES] + [("hex27-mixed", n, 1) for n in (4, 6, 8, 16)] + \
       [("tet10-mixed", n, 1) for n in (4, 8, 16)]
THEIRS = [("C3D8", n, 2) for n in SIZES] + [("C3D20R", n, 1) for n in (4, 6, 8, 12, 16)] + \
         [("C3D20", n, 1) for n in (8,)] + [("C3D10", n, 1) for n in (8,)]
NORMAL = (-math.sin(math.pi / 3), math.cos(math.pi / 3))


def measured(words, threads=1, **options):
    """Runs a program; returns it with its wall and processor seconds."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    start = time.monotonic()
    done = subprocess.run(words, env=dict(os.environ, OMP_NUM_THREADS=str(threads)), stdout=subprocess.PIPE,
                          stderr=subprocess.STDOUT, text=True, **options)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    used = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    return done, time.monotonic() - start, used


def ours(program, element, n, layers, threads=1):
    done, wall, used = measured([program, "valve", element, str(n), str(layers)], threads)
    lines = [line for line in done.stdout.splitlines() if line.startswith("{")]
    if done.returncode or not lines:
        return {"program": "valsalva", "element": element, "n": n, "failed": done.stdout.strip()[-200:]}
    found = json.loads(lines[0])
    return {"program": "valsalva", "element": element, "n": n, "unknowns": found["unknowns"], "wall_s": wall,
            "processor_s": used, "iterations": found["iterations"], "threads": threads,
            "probes_mm": found["probes_mm"]}


def probes_of(text, nodes):
    """The last table of displacements; CalculiX marks nodes in local axes with an L."""
    at = {}
    for line in text.splitlines():
        words = line.split()
        if len(words) in (4, 5) and words[0].isdigit():
            x, y, z = map(float, words[1:4])
            if len(words) == 5:
                x, y = x * NORMAL[1] + y * NORMAL[0], -x * NORMAL[0] + y * NORMAL[1]
            at[int(words[0])] = [x, y, z]
    return [at[node] for node in nodes]


def theirs(program, ccx, element, n, layers):
    best = {"program": "calculix", "element": element, "n": n, "failed": "no convergence within 60 s of processor time"}
    for first in ("1", "0.25"):
        with tempfile.TemporaryDirectory() as folder:
            deck = Path(folder) / "valve.inp"
            made = subprocess.run([program, "calculix", element, str(n), str(layers), str(deck)],
                                  stdout=subprocess.PIPE, text=True, check=True)
            facts = json.loads(made.stdout.splitlines()[-1])
            deck.write_text(deck.read_text().replace("FIRST, 1", f"{first}, 1"))
            try:
                done, wall, used = measured(["prlimit", "--cpu=60", ccx, "valve"], cwd=folder, timeout=1200)
                found = probes_of((Path(folder) / "valve.dat").read_text(), facts["probes"])
            except (subprocess.TimeoutExpired, KeyError, OSError):
                continue
            if done.returncode or "ERROR" in done.stdout:
                continue
            if used < best.get("processor_s", math.inf):
                best = {"program": "calculix", "element": element, "n": n, "unknowns": facts["unknowns"], "wall_s": wall,
                        "processor_s": used, "iterations": done.stdout.count("\n iteration "), "first": first, "threads": 1,
                        "probes_mm": found}
    return best


def time_at(runs, error):
    """Processor time at this error on the best curve of the runs: interpolated between meshes of one element."""
    best = math.inf
    for element in {run["element"] for run in runs}:
        curve = sorted((run["error"], run["processor_s"]) for run in runs if run["element"] == element)
        for (e0, t0), (e1, t1) in zip(curve, curve[1:]):
            if e0 <= error <= e1 and e1 > e0:
                share = (math.log(error) - math.log(e0)) / (math.log(e1) - math.log(e0))
                best = min(best, math.exp((1 - share) * math.log(t0) + share * math.log(t1)))
        best = min([best] + [t for e, t in curve if e <= error])
    return best


def main():
    folders = [word for word in sys.argv[1:] if not word.startswith("--")]
    build = Path(folders[0]) if folders else ROOT / "build"
    program = str(build / "bin" / "bench_structure")
    reference = ours(program, *REFERENCE)
    largest = max(math.dist(p, (0, 0, 0)) for p in reference["probes_mm"])
    runs = []

    def note(run):
        runs.append(run)
        if "failed" in run:
            print(f"| {run['program']} | {run['element']} | {run['n']} | | | | no solution |", flush=True)
            return
        run["error"] = max(math.dist(p, q) for p, q in zip(run["probes_mm"], reference["probes_mm"])) / largest
        print(f"| {run['program']} | {run['element']} | {run['n']} | {run['unknowns']} | {100 * run['error']:.2f} | "
              f"{run['iterations']} | {run['processor_s']:.2f} |", flush=True)

    print("| program | element | n | unknowns | error % | iterations | processor s |\n|---|---|---|---|---|---|---|")
    for run in OURS:
        note(ours(program, *run))
    ccx = shutil.which("ccx")
    if ccx:
        for run in THEIRS:
            note(theirs(program, ccx, *run))
    else:
        print("CalculiX is not installed (apt-get install calculix-ccx): its half of the comparison is skipped")
    summary = []
    solved = [run for run in runs if "error" in run]
    print("\n| error % | valsalva, s | CalculiX, s | ratio |\n|---|---|---|---|")
    for error in (0.05, 0.024, 0.015, 0.01):
        mine = time_at([run for run in solved if run["program"] == "valsalva"], error)
        other = time_at([run for run in solved if run["program"] == "calculix"], error)
        if math.isinf(mine) or math.isinf(other):
            continue
        summary.append({"error": error, "valsalva_s": mine, "calculix_s": other, "ratio": other / mine})
        print(f"| {100 * error:g} | {mine:.2f} | {other:.2f} | {other / mine:.1f} |")
    out = ROOT / "runs" / "bench" / "calculix.json"
    replace(out, json.dumps(provenance() | {"reference": reference, "runs": runs, "equal_error": summary}, indent=1) + "\n")
    print(f"written: {out.relative_to(ROOT)}")


if __name__ == "__main__":
    main()
