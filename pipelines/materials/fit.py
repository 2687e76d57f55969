#!/usr/bin/python3
"""Fits a material law to uniaxial or biaxial tests of a thin sheet.

  python3 pipelines/materials/fit.py data.csv --law hgo --fibre-angles 10,-10
  python3 pipelines/materials/fit.py data.csv --law ogden --fix mu2_Pa=0 --fix mu3_Pa=0 --plot fit.png --json fit.json

Data: CSV with a header; lines that begin with # are comments. One row a measured state. Columns:
  stretch1, stretch2         stretches along the axes; an empty cell or a missing column: that direction is free (uniaxial)
  nominal1_kPa, nominal2_kPa force per reference area, or cauchy1_kPa, cauchy2_kPa force per present area; _Pa, _kPa or
                             _MPa; needed where the stretch of the same direction is prescribed, ignored elsewhere
  protocol                   optional label
Directions 1 and 2 are the axes of the test; fibre angles are counted from direction 1.

The laws are evaluated by valsalva-material, the optimiser is scipy.optimize.least_squares (trust region reflective), from
several starts with a fixed seed. Stiffnesses and exponents are searched on a logarithmic scale. Residual: nominal stress,
found minus measured, over the largest stress (--weights uniform: the error of measurement is the same everywhere) or over
each stress itself plus 1 % of the largest (--weights relative: the error grows with the stress). The confidence intervals are the linearised ones, from the Jacobian at the optimum and Student's t;
parameters that the data cannot tell apart are named. Exit codes: 0 done, 2 wrong usage or data, 3 no fit, 4 no program.
"""

import argparse
import csv
import difflib
import hashlib
import json
import math
import os
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np
from scipy import optimize, stats

ROOT = Path(__file__).resolve().parent.parent.parent
PASCALS = {"Pa": 1.0, "kPa": 1e3, "MPa": 1e6}
STRESS_COLUMNS = [f"{kind}{axis}_{unit}" for kind in ("nominal", "cauchy") for axis in (1, 2) for unit in PASCALS]
COLUMNS = ["stretch1", "stretch2", "protocol"] + STRESS_COLUMNS
EXPONENT_CAP = 6.0


class InputError(Exception):
    """The user's data or options are wrong: exit code 2."""


class FitFailure(Exception):
    """The optimiser found nothing: exit code 3."""


class ProgramMissing(Exception):
    """valsalva-material or a file is missing: exit code 4."""


def suggestion(word, known):
    near = difflib.get_close_matches(word, known, n=1, cutoff=0.5)
    return f"; did you mean '{near[0]}'?" if near else ""


class Measurements:
    """Loads (None: free) and the measured nominal stresses, one per prescribed direction."""

    def __init__(self, path):
        try:
            text = Path(path).read_bytes()
        except OSError as error:
            raise ProgramMissing(f"{path}: {error.strerror}") from error
        self.sha256 = hashlib.sha256(text).hexdigest()
        self.loads, self.measured, self.index, self.protocol = [], [], [], []
        header = None
        try:
            lines = text.decode("utf-8-sig").splitlines()
        except UnicodeDecodeError as error:
            raise InputError(f"{path}: not a text file in UTF-8; expected CSV") from error
        for number, line in enumerate(lines, 1):
            if not line.strip() or line.startswith("#"):
                continue
            cells = [cell.strip() for cell in next(csv.reader([line]))]
            if header is None:
                header = self.check_header(cells, f"{path}:{number}")
            else:
                self.add_row(dict(zip(header, cells)), len(cells), header, f"{path}:{number}")
        if header is None:
            raise InputError(f"{path}: no header line; expected columns such as stretch1,nominal1_kPa")
        if len(self.measured) < 3:
            raise InputError(f"{path}: {len(self.measured)} measured stresses; expected 3 at least")
        self.measured = np.array(self.measured)
        if not np.any(self.measured):
            raise InputError(f"{path}: all measured stresses are zero; nothing can be fitted")

    @staticmethod
    def check_header(cells, where):
        for cell in cells:
            if cell not in COLUMNS:
                raise InputError(f"{where}: unknown column '{cell}'{suggestion(cell, COLUMNS)}; known: stretch1, stretch2, "
                                 "protocol, and nominal1, nominal2, cauchy1, cauchy2 with _Pa, _kPa or _MPa")
        if len(set(cells)) != len(cells):
            raise InputError(f"{where}: a column is named twice")
        if "stretch1" not in cells and "stretch2" not in cells:
            raise InputError(f"{where}: neither stretch1 nor stretch2; expected one of them (uniaxial) or both (biaxial)")
        for axis in (1, 2):
            stress = [c for c in cells if c in STRESS_COLUMNS and c.split("_")[0].endswith(str(axis))]
            if len(stress) > 1:
                raise InputError(f"{where}: {stress[0]} and {stress[1]}; expected one stress column a direction")
            if f"stretch{axis}" in cells and not stress:
                raise InputError(f"{where}: stretch{axis} has no stress; expected a column such as nominal{axis}_kPa")
        return cells

    def add_row(self, row, found, header, where):
        if found != len(header):
            raise InputError(f"{where}: {found} columns; expected {len(header)} as in the header")
        stretch = []
        for axis in (1, 2):
            cell = row.get(f"stretch{axis}", "")
            value = self.number(cell, f"stretch{axis}", where) if cell else None
            if value is not None and not 0.05 <= value <= 20:
                raise InputError(f"{where}: stretch{axis} = {cell}; expected a ratio of lengths, 1 at rest (0.05 to 20)")
            stretch.append(value)
        if stretch == [None, None]:
            raise InputError(f"{where}: both stretches are empty; expected one at least")
        for axis in (1, 2):
            if stretch[axis - 1] is None:
                continue
            column = next(c for c in header if c in STRESS_COLUMNS and c.split("_")[0].endswith(str(axis)))
            if not row[column]:
                raise InputError(f"{where}: {column} is empty although stretch{axis} is prescribed")
            stress = self.number(row[column], column, where) * PASCALS[column.split("_")[1]]
            if column.startswith("cauchy"):
                stress /= stretch[axis - 1]  # incompressible: sigma = l P
            self.measured.append(stress)
            self.index.append(2 * len(self.loads) + axis - 1)
        self.loads.append(stretch)
        self.protocol.append(row.get("protocol", ""))

    @staticmethod
    def number(cell, column, where):
        try:
            value = float(cell)
        except ValueError:
            value = math.nan
        if not math.isfinite(value):
            raise InputError(f"{where}: {column} = '{cell}'; expected a number")
        return value

    def write_loads(self, file):
        file.write("stretch1,stretch2,shear\n")
        for one, two in self.loads:
            file.write(f"{'' if one is None else repr(one)},{'' if two is None else repr(two)},0\n")
        file.flush()


class Law:
    """The parameters of a law as the program describes them."""

    def __init__(self, program, name):
        self.program, self.name = str(program), name
        done = subprocess.run([self.program, "--describe", name], capture_output=True, text=True)
        if done.returncode:
            raise InputError(done.stderr.strip().removeprefix("error: "))
        lines = done.stdout.splitlines()
        self.families = int(lines[0].split(":")[1])
        self.parameters = {row["key"]: row for row in csv.DictReader(lines[1:])}


class Stream:
    """valsalva-material kept open: one line of parameters in, one line of stresses out."""

    def __init__(self, law, keys, fixed, angles, data):
        self.file = tempfile.NamedTemporaryFile("w", suffix=".csv")
        data.write_loads(self.file)
        words = [law.program, "--law", law.name, "--loads", self.file.name, "--stream", ",".join(keys)]
        for key, value in fixed.items():
            words += ["--parameter", f"{key}={value!r}"]
        if angles:
            words += ["--fibre-angles", ",".join(repr(a) for a in angles)]
        self.process = subprocess.Popen(words, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        self.index, self.calls, self.answers, self.last_error = data.index, 0, 0, ""

    def stresses(self, values):
        """None where the law refuses the values."""
        self.calls += 1
        try:
            self.process.stdin.write(",".join(repr(float(v)) for v in values) + "\n")
            self.process.stdin.flush()
        except BrokenPipeError:
            pass
        line = self.process.stdout.readline()
        if not line:
            raise InputError(self.process.stderr.read().strip().removeprefix("error: "))
        if line.startswith("error: "):
            self.last_error = line[7:].strip()
            return None
        self.answers += 1
        return np.array([float(x) for x in line.split(",")])[self.index]

    def close(self):
        self.process.stdin.close()
        self.process.wait()
        self.process.stdout.close()
        self.process.stderr.close()
        self.file.close()


class Scale:
    """How one parameter is searched: logarithmic where it is positive over decades, else linear."""

    def __init__(self, key, row, stress):
        self.key = key
        low, high = (float(row["low"]), float(row["high"])) if row else (0.0, 90.0)
        self.logarithmic = low > 0 and high / low > 50 or key.endswith("_Pa") and low >= 0
        if self.logarithmic:
            low = low if low > 0 else 1e-9 * stress
        self.low, self.high = self.inward(low), self.inward(high)
        # Where the random starts lie.
        if key.endswith("_Pa"):
            first, last = 1e-3 * stress, 10 * stress
            self.start = (max(low, first), min(high, last)) if self.logarithmic else (-stress, stress)
        elif self.logarithmic:
            self.start = (max(low, 0.3), min(high, 200.0))
        else:
            self.start = (low, high)

    def inward(self, value):
        return math.log(value) if self.logarithmic else value

    def outward(self, x):
        return math.exp(x) if self.logarithmic else x

    def random_start(self, share):
        low, high = self.inward(self.start[0]), self.inward(self.start[1])
        return min(max(low + share * (high - low), self.low), self.high)


def fit(data, law, fixed, start, angles, free_angle=False, starts=12, confidence=0.95, weights="uniform"):
    """The best of several least-squares fits, as a dictionary."""
    stress = float(np.max(np.abs(data.measured)))
    unit = np.full(len(data.measured), stress) if weights == "uniform" else np.abs(data.measured) + 0.01 * stress
    keys = [k for k, row in law.parameters.items() if k not in fixed and (row["required"] == "1" or k in start)]
    if free_angle:
        keys.append("fibre_angle_deg")
    if len(data.measured) <= len(keys):
        raise InputError(f"{len(data.measured)} measured stresses for {len(keys)} free parameters; fix some (--fix key=value)")
    scales = [Scale(k, law.parameters.get(k), stress) for k in keys]
    stream = Stream(law, keys, fixed, angles, data)

    def residual(x):
        found = stream.stresses([s.outward(v) for s, v in zip(scales, x)])
        if found is None or not np.all(np.isfinite(found)):
            return np.full(len(data.measured), 1e3)
        return np.clip((found - data.measured) / unit, -1e6, 1e6)

    low, high = np.array([s.low for s in scales]), np.array([s.high for s in scales])
    sampler = stats.qmc.LatinHypercube(d=len(keys), seed=1) if keys else None
    if not keys:
        raise InputError("every parameter is fixed; nothing to fit")
    points = [np.array([s.random_start(u) for s, u in zip(scales, row)]) for row in sampler.random(starts)]
    if start:
        points.insert(0, np.array([min(max(s.inward(start[s.key]), s.low), s.high) if s.key in start else p
                                   for s, p in zip(scales, points[0])]))
    best = None
    try:
        for point in points:
            try:
                found = optimize.least_squares(residual, np.clip(point, low + 1e-9, high - 1e-9), bounds=(low, high), jac="3-point",
                                               x_scale="jac", xtol=1e-12, ftol=1e-12, gtol=1e-12, max_nfev=400)
            except np.linalg.LinAlgError:
                continue
            if best is None or found.cost < best.cost:
                best = found
        if not stream.answers:
            raise InputError(f"the law refuses every start: {stream.last_error}")
        if best is None or np.max(np.abs(best.fun)) >= 1e3 or best.status <= 0 and best.cost > 1e-6:
            raise FitFailure(f"no start of {len(points)} led to a fit; give --start values, or fix parameters"
                             + (f"; the law's last word: {stream.last_error}" if stream.last_error else ""))
        calls = stream.calls
    finally:
        stream.close()
    return summary(best, scales, data, unit, confidence, low, high, calls)


def summary(best, scales, data, unit, confidence, low, high, calls):
    freedom = len(data.measured) - len(scales)
    variance = 2 * best.cost / freedom
    u, singular, vt = np.linalg.svd(best.jac, full_matrices=False)
    weak = singular < 1e-8 * singular[0]
    inverse = np.where(weak, np.inf, 1 / np.where(weak, 1, singular) ** 2)
    finite = np.where(weak, 0, inverse)
    covariance = (vt.T * finite) @ vt * variance
    blind = (vt.T ** 2) @ weak.astype(float) > 1e-6  # parameters with a share in a direction the data do not see
    error = np.sqrt(np.diag(covariance))
    t = stats.t.ppf(0.5 + confidence / 2, freedom)
    warnings, parameters = [], {}
    for i, s in enumerate(scales):
        x = best.x[i]
        reach = math.inf if blind[i] else t * error[i]
        bounds = [s.outward(x - reach) if math.isfinite(reach) else (0.0 if s.logarithmic else -math.inf),
                  s.outward(x + reach) if reach < 300 else math.inf]
        parameters[s.key] = {"value": s.outward(x), "low": bounds[0], "high": bounds[1]}
        if blind[i]:
            warnings.append(f"{s.key}: the data do not determine it")
        elif min(x - low[i], high[i] - x) < 1e-6 * max(1.0, abs(x)):
            warnings.append(f"{s.key}: at the end of its band; its interval means little")
    scale = np.where(error > 0, error, 1)
    correlation = covariance / np.outer(scale, scale)
    for i in range(len(scales)):
        for j in range(i):
            if abs(correlation[i, j]) > 0.98 and not blind[i] and not blind[j]:
                warnings.append(f"{scales[j].key} and {scales[i].key}: correlation {correlation[i, j]:.4f}, "
                                "the data hardly tell them apart")
    residual = best.fun * unit
    spread = np.sum((data.measured - np.mean(data.measured)) ** 2)
    return {"parameters": parameters, "rms_residual_Pa": float(np.sqrt(np.mean(residual**2))),
            "largest_residual_Pa": float(np.max(np.abs(residual))), "r_squared": float(1 - np.sum(residual**2) / spread),
            "measured_stresses": len(data.measured), "degrees_of_freedom": freedom, "confidence": confidence,
            "correlation": correlation.tolist(), "evaluations": calls, "warnings": warnings}


def evaluate(law, values, angles, data):
    """The fitted curve at the measured loads: rows of the program's CSV."""
    with tempfile.NamedTemporaryFile("w", suffix=".csv") as file:
        data.write_loads(file)
        words = [law.program, "--law", law.name, "--loads", file.name]
        for key, value in values.items():
            words += ["--parameter", f"{key}={value!r}"]
        if angles:
            words += ["--fibre-angles", ",".join(repr(a) for a in angles)]
        done = subprocess.run(words, capture_output=True, text=True, check=True)
    return list(csv.DictReader(done.stdout.splitlines()))


def key_values(texts, law, option):
    values = {}
    known = list(law.parameters) + ["fibre_angle_deg"]
    for text in texts:
        key, equals, value = text.partition("=")
        if key not in known:
            raise InputError(f"{option} {text}: law {law.name} has no parameter '{key}'{suggestion(key, known)}")
        try:
            values[key] = float(value)
        except ValueError:
            values[key] = math.nan
        if not equals or not math.isfinite(values[key]):
            raise InputError(f"{option} {text}: expected key=number")
    return values


def read_angles(text, families):
    if not text:
        return []
    try:
        angles = [float(a) for a in text.split(",")]
    except ValueError:
        angles = [math.nan] * 3
    if len(angles) > 2 or not all(map(math.isfinite, angles)):
        raise InputError(f"--fibre-angles {text}: expected one or two numbers, in degrees from direction 1")
    if len(angles) > families:
        raise InputError(f"--fibre-angles {text}: the law has at most {families} fibre families")
    return angles


def plot(path, law, data, curve):
    import matplotlib
    matplotlib.use("Agg")
    import matplotlib.pyplot as plt
    figure, axes = plt.subplots(figsize=(6, 4.2))
    for axis, colour in ((1, "tab:blue"), (2, "tab:red")):
        points = [(data.loads[i // 2][axis - 1], m, float(curve[i // 2][f"nominal{axis}_Pa"]))
                  for i, m in zip(data.index, data.measured) if i % 2 == axis - 1]
        if points:
            points.sort()
            x, measured, found = np.array(points).T
            axes.plot(x, measured / 1e3, "o", ms=3, color=colour, label=f"measured, direction {axis}")
            axes.plot(x, found / 1e3, ".", ms=2, color="black", label=f"{law.name}, direction {axis}")
    axes.set_xlabel("stretch")
    axes.set_ylabel("nominal stress, kPa")
    axes.legend()
    figure.tight_layout()
    figure.savefig(path, dpi=120, metadata={"Software": None})


def report(result, law, out=sys.stdout):
    print(f"{law.name}: {result['measured_stresses']} measured stresses, rms residual {result['rms_residual_Pa']:.4g} Pa, "
          f"R2 {result['r_squared']:.6f}, {100 * result['confidence']:g} % intervals", file=out)
    for key, p in result["parameters"].items():
        print(f"  {key:22} {p['value']:.6g}   [{p['low']:.6g}, {p['high']:.6g}]", file=out)
    for key, value in result["fixed"].items():
        print(f"  {key:22} {value:.6g}   fixed", file=out)
    for warning in result["warnings"]:
        print(f"  warning: {warning}", file=out)


def arguments():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("data", help="CSV with the measured states")
    parser.add_argument("--law", required=True, help="a law of valsalva-material --laws")
    parser.add_argument("--fix", action="append", default=[], metavar="key=value", help="hold a parameter")
    parser.add_argument("--start", action="append", default=[], metavar="key=value",
                        help="first guess; also frees a parameter that has a default")
    parser.add_argument("--fibre-angles", default="", metavar="a,b", help="degrees from direction 1, one a family")
    parser.add_argument("--free-angle", action="store_true", help="fit the angle: the families lie at plus and minus it")
    parser.add_argument("--starts", type=int, default=12, help="random starts (default 12)")
    parser.add_argument("--confidence", type=float, default=0.95, help="of the intervals (default 0.95)")
    parser.add_argument("--weights", choices=("uniform", "relative"), default="uniform", help="see above")
    parser.add_argument("--json", help="write the result here")
    parser.add_argument("--plot", help="write a picture here (PNG)")
    parser.add_argument("--program", default=os.environ.get("VALSALVA_MATERIAL", str(ROOT / "build/bin/valsalva-material")))
    return parser.parse_args()


def run(options):
    if not os.access(options.program, os.X_OK):
        raise ProgramMissing(f"{options.program}: not found; build it (make build) or name it by --program")
    if options.starts < 1:
        raise InputError(f"--starts {options.starts}: expected 1 or more")
    if not 0 < options.confidence < 1:
        raise InputError(f"--confidence {options.confidence}: expected a number between 0 and 1")
    law = Law(options.program, options.law)
    data = Measurements(options.data)
    fixed, start = key_values(options.fix, law, "--fix"), key_values(options.start, law, "--start")
    angles = read_angles(options.fibre_angles, law.families)
    if options.free_angle and not angles:
        raise InputError("--free-angle: give a first guess by --fibre-angles, one number a family")
    if options.free_angle:
        start.setdefault("fibre_angle_deg", abs(angles[0]))
    result = fit(data, law, fixed, start, angles, options.free_angle, options.starts, options.confidence,
                 options.weights)
    result = {"law": law.name, **result, "weights": options.weights, "fixed": fixed, "fibre_angles_deg": angles, "data": options.data, "data_sha256": data.sha256}

    values = {**fixed, **{k: p["value"] for k, p in result["parameters"].items()}}
    angle = values.pop("fibre_angle_deg", None)
    if angle is not None:
        angles = [angle, -angle][: len(angles)]
        result["fibre_angles_deg"] = angles
    curve = evaluate(law, values, angles, data)
    result["largest_exponent"] = max(float(row["exponent"]) for row in curve)
    if result["largest_exponent"] > EXPONENT_CAP:
        result["warnings"].append(f"the exponent reaches {result['largest_exponent']:.3g}: beyond {EXPONENT_CAP:g} the laws "
                                  "continue the exponential by a parabola, and the fit depends on that")
    report(result, law)
    if options.json:
        # JSON has no infinity: an open end of an interval is null.
        for p in result["parameters"].values():
            p.update({end: value if math.isfinite(value) else None for end, value in p.items()})
        Path(options.json).write_text(json.dumps(result, indent=2) + "\n")
    if options.plot:
        plot(options.plot, law, data, curve)


def main():
    try:
        run(arguments())
    except InputError as error:
        sys.exit(fail(error, 2))
    except FitFailure as error:
        sys.exit(fail(error, 3))
    except ProgramMissing as error:
        sys.exit(fail(error, 4))


def fail(error, code):
    print(f"error: {error}", file=sys.stderr)
    return code


if __name__ == "__main__":
    main()
