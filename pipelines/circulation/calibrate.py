#!/usr/bin/python3
"""Fits the parameters of a case's left heart and Windkessel to target pressures and stroke volume.

  python3 pipelines/circulation/calibrate.py CASE.toml --target stroke_volume_mL=75 --target systolic_pressure_mmHg=120 \\
      --target diastolic_pressure_mmHg=78 [--free KEY]... [--valve-resistance R] [--json out.json]

Targets are figures of the periodic beat that valsalva-circulation prints: stroke_volume_mL, systolic_pressure_mmHg,
diastolic_pressure_mmHg, mean_pressure_mmHg, peak_ventricular_pressure_mmHg, end_diastolic_pressure_mmHg,
peak_flow_mL_per_s, ejection_s. Free keys of [circulation], default: vein_flow_L_per_min,
peripheral_resistance_mmHg_s_per_mL and compliance_mL_per_mmHg, in this order, as many as there are targets.

The model is the 0D loop with an ideal valve of --valve-resistance mmHg s/mL (0.02: an open valve of about 1.7 cm2): the
valve of the flow domain has its own resistance, so take the one that a run has found (mean gradient over mean flow) and
repeat. The optimiser is scipy.optimize.least_squares on the logarithms of the parameters, residuals relative to the
targets. Prints the lines for the case file. Exit codes: 0 done, 2 wrong usage, 3 targets not met within --tolerance
(default 0.01 relative; the best parameters are printed all the same), 4 no program.
"""

import argparse
import csv
import io
import json
import math
import subprocess
import sys
from pathlib import Path

import numpy as np
from scipy import optimize

ROOT = Path(__file__).resolve().parent.parent.parent
DEFAULT_KEYS = ["vein_flow_L_per_min", "peripheral_resistance_mmHg_s_per_mL", "compliance_mL_per_mmHg",
                "lv_elastance_max_mmHg_per_mL", "lv_tau2_fraction"]


def fail(code, message):
    print(f"error: {message}", file=sys.stderr)
    sys.exit(code)


class Loop:
    """The periodic beat as a function of the free keys, through one running program."""

    def __init__(self, program, case, keys, valve_resistance):
        words = [str(program), case, "--valve-resistance", str(valve_resistance), "--stream",
                 ",".join(f"circulation.{key}" for key in keys)]
        try:
            self.process = subprocess.Popen(words, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
        except OSError as error:
            fail(4, f"{program}: {error.strerror}; build first: make build")
        self.figures = self.process.stdout.readline().strip().split(",")
        self.beats = 0

    def __call__(self, values):
        """The figures, or the text of the error."""
        self.process.stdin.write(",".join(repr(float(v)) for v in values) + "\n")
        self.process.stdin.flush()
        line = self.process.stdout.readline().strip()
        self.beats += 1
        if not line or line.startswith("error"):
            return line or "error: the program stopped"
        return dict(zip(self.figures, (float(cell) for cell in next(csv.reader(io.StringIO(line))))))

    def close(self):
        self.process.stdin.close()
        self.process.wait()


def arguments():
    parser = argparse.ArgumentParser(usage=__doc__)
    parser.add_argument("case")
    parser.add_argument("--target", action="append", default=[])
    parser.add_argument("--free", action="append", default=[])
    parser.add_argument("--valve-resistance", type=float, default=0.02)
    parser.add_argument("--tolerance", type=float, default=0.01)
    parser.add_argument("--json", type=Path)
    parser.add_argument("--program", type=Path, default=ROOT / "build" / "bin" / "valsalva-circulation")
    options = parser.parse_args()
    targets = {}
    for pair in options.target:
        name, _, value = pair.partition("=")
        try:
            targets[name] = float(value)
        except ValueError:
            fail(2, f"--target {pair}: expected figure=number")
        if not targets[name] > 0 or not math.isfinite(targets[name]):
            fail(2, f"--target {pair}: expected a positive number")
    if not targets:
        fail(2, "no --target was given; expected at least one, as --target stroke_volume_mL=75")
    keys = [key.removeprefix("circulation.") for key in options.free] or DEFAULT_KEYS[:len(targets)]
    if len(keys) > len(targets):
        fail(2, f"{len(keys)} free keys and {len(targets)} targets; expected at least as many targets as keys")
    return options, targets, keys


def start_values(program, case, keys):
    """Of the case file, else the defaults, as the cycle's --check prints them."""
    done = subprocess.run([str(program.with_name("valsalva-circulation")), case, "--effective"], capture_output=True, text=True)
    if done.returncode:
        sys.stderr.write(done.stderr)
        sys.exit(done.returncode)
    effective = dict(line.split(" = ", 1) for line in done.stdout.splitlines() if " = " in line)
    values = []
    for key in keys:
        text = effective.get(f"circulation.{key}")
        try:
            values.append(float(text))
        except (TypeError, ValueError):
            fail(2, f"--free {key}: not a number of the table [circulation] (found {text})")
        if not values[-1] > 0:
            fail(2, f"--free {key}: is {text}; expected a positive value to start from")
    return values


def main():
    options, targets, keys = arguments()
    if not options.program.is_file():
        fail(4, f"{options.program}: no such program; build first: make build")
    start = start_values(options.program, options.case, keys)
    loop = Loop(options.program, options.case, keys, options.valve_resistance)
    unknown = [name for name in targets if name not in loop.figures]
    if unknown:
        fail(2, f"--target {unknown[0]}: no such figure; expected one of {', '.join(loop.figures)}")
    first = loop(start)
    if isinstance(first, str):
        fail(3, f"the case itself has no periodic beat: {first}")

    def residuals(logarithms):
        figures = loop(np.exp(logarithms))
        if isinstance(figures, str):
            return np.full(len(targets), 10.0)  # no beat there: far from every target
        return np.array([figures[name] / value - 1 for name, value in targets.items()])

    found = optimize.least_squares(residuals, np.log(start), bounds=(np.log(start) - 4, np.log(start) + 4), diff_step=1e-3)
    values = np.exp(found.x)
    figures = loop(values)
    loop.close()
    print("[circulation]")
    for key, value in zip(keys, values):
        print(f"{key} = {value:.6g}")
    print(f"\n# {'figure':34} {'target':>10} {'found':>10}")
    for name, value in figures.items():
        goal = f"{targets[name]:10.4g}" if name in targets else " " * 10
        print(f"# {name:34} {goal} {value:10.4g}")
    worst = float(np.max(np.abs(found.fun)))
    print(f"# largest relative difference {worst:.2g}, {loop.beats} beats computed")
    if options.json:
        options.json.write_text(json.dumps({"parameters": dict(zip(keys, map(float, values))), "figures": figures,
                                            "targets": targets, "largest_relative_difference": worst}, indent=2) + "\n")
    if worst > options.tolerance:
        fail(3, f"the targets are not met together: the largest relative difference is {worst:.2g}, expected {options.tolerance}; "
                "free other keys, or drop a target")


if __name__ == "__main__":
    main()
