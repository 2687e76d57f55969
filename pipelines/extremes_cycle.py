"""make extremes, beating valve: values pushed until accuracy, then the run, is lost.

    python3 pipelines/extremes_cycle.py [OUT] [--only PART ...] [--names RUN ...] [--again]     needs build/bin/valsalva-cycle

The valve of leaflet-flutter-2022 in a shortened vessel at h = 1.5 mm, some milliseconds of its motion, unless a part says
otherwise. For each value: the exit code (0 done; 2 refused as input; 3 stopped with the last good state), an error where
there is something to compare with (the remark says what), whether any array of any output (states, history, summary) holds
a value that is not finite, whether a state was left, whether the message names a place:
OUT/cycle-extremes.csv (docs/results), and the limits read from it: OUT/cycle-extremes-limits.csv; with those of the
structure: runs/extremes/extremes.csv and .png.

A run that was made before with the same words is not repeated, whatever the program's version, which every row names;
--again repeats what is asked for. With --only (names of the functions here) or --names (folders in runs/extremes/cycle) the
other rows are those of earlier runs.
"""

import argparse
import hashlib
import json
import math
import subprocess
import time
from pathlib import Path

import structure_runs as runs
from extremes import FOLDER, RESULTS, Extremes

STUDY = Extremes("cycle")
CASES = runs.ROOT / "pipelines" / "cases"
AGAIN, STORED_ONLY, NAMES = False, False, []
# Shortened vessel, leaflet edges of half a cell.
VALVE = {"fluid.spacing_mm": 1.5, "test_section.z_mm": [-15, 0, 20.4, 40], "test_section.radius_mm": [11.5, 11.5, 13.5, 14.3],
         "body.leaflets.divisions": [32, 15], "cycle.initialisation_s": 0.01, "output.checkpoint_s": 1e5, "cycle.history_interval": 5}


def steady(low, high, resistance=None):
    """Constant pressures at both ends, mmHg."""
    out = {"circulation.upstream": "pressure", "circulation.pressure_time_s": [0, 0.4], "circulation.pressure_mmHg": [low, low],
           "circulation.aortic_pressure_mmHg": high, "circulation.downstream": "pressure" if resistance is None else "resistance"}
    return out | ({} if resistance is None else {"circulation.outlet_resistance_mmHg_s_per_mL": resistance})


def run(name, changes, case="leaflet-flutter-2022", base=VALVE, timeout_s=900, steps=None):
    """The case with these keys; read back where the same words were run before. Then without 'rows', but with the tail."""
    sets = dict(base) | changes
    words = [runs.BIN / "valsalva-cycle", CASES / f"{case}.toml", "--fidelity", "draft"]
    words += [word for key, value in sets.items() for word in ("--set", f"{key}={json.dumps(value) if isinstance(value, list) else value}")]
    words += ["--steps", steps] if steps else []
    spoken = " ".join(str(word) for word in words[1:]).replace(str(runs.ROOT), "")
    note = FOLDER / "cycle" / f"{name}.json"
    out = FOLDER / "cycle" / name
    if note.exists() and not (AGAIN and not STORED_ONLY):
        stored = json.loads(note.read_text())
        if stored["words"] == hashlib.sha256(spoken.encode()).hexdigest():
            return stored
    if STORED_ONLY or (NAMES and name not in NAMES):
        return None
    result = runs.run_program(words, out, timeout_s)
    result["version"] = result.get("summary", {}).get("version", "") or version()
    result["words"] = hashlib.sha256(spoken.encode()).hexdigest()
    result["columns"] = columns_of(result.pop("rows", []))
    result.pop("text")
    result.pop("summary", None)
    for path in out.glob("state_*.h5"):
        path.unlink()  # looked through already; a state at fine grids takes much room
    note.parent.mkdir(parents=True, exist_ok=True)
    runs.replace(note, json.dumps(result))
    return result


def version():
    return subprocess.run([runs.BIN / "valsalva-cycle", "--version"], stdout=subprocess.PIPE, text=True).stdout.split()[-1]


def columns_of(rows):
    """What the parts look at of a valve's history; all of a scene of fluid alone."""
    wanted = ("time_s", "q_mL_per_s", "q_in_mL_per_s", "p_ao_mmHg", "p_lvot_mmHg", "orifice_cm2", "max_speed_cm_per_s",
              "max_principal_strain_p99", "law_exponent", "max_cfl")
    names = list(rows[0]) if rows else []
    return {name: [float(row[name]) for row in rows] for name in names if name in wanted or "q_mL_per_s" not in names}


def note(extreme, series, at, result, error=None, remark=""):
    if result is not None:
        STUDY.note(extreme, series, at, result, error, remark)


def solved(result):
    return result is not None and result["exit"] == 0 and bool(result["columns"])


def last(result, name):
    return result["columns"][name][-1]


def mean(result, name, start):
    """Over the time from `start` on."""
    t, v = result["columns"]["time_s"], result["columns"][name]
    pairs = [(t[i] - t[i - 1], v[i]) for i in range(1, len(t)) if t[i] > start]
    return sum(dt * value for dt, value in pairs) / sum(dt for dt, _ in pairs)


def going(result):
    """What a run was like, in words."""
    c = result["columns"]
    return (f"{c['max_cfl'][-1]:.2f} max CFL, fastest {max(c['max_speed_cm_per_s']):.0f} cm/s, largest strain (99 %) "
            f"{max(c['max_principal_strain_p99']):.3f}, exponent {max(c['law_exponent']):.1f}, "
            f"{result['metrics'].get('returns_after_alarm', 0):.0f} returns")


def reynolds():
    """Saline in the pulse duplicator's test section at h = 2 mm: a constant flow, Re = 4 Q / (pi D nu), D = 28 mm."""
    base = {"fluid.spacing_mm": 2, "body.leaflets.divisions": [24, 12], "test_section.z_mm": [-30, -6, -5.5, -1.5, -1, 41],
            "cycle.initialisation_s": 0.004, "cycle.duration_s": 0.064, "output.checkpoint_s": 1e5, "cycle.history_interval": 5,
            "circulation.upstream": "flow", "circulation.downstream": "pressure", "circulation.aortic_pressure_mmHg": 8,
            "circulation.flow_time_s": [0, 0.02, 0.8]}
    for scheme in ("weno5", "upwind3", "centred4"):
        for number in (5000, 20000, 40000, 80000):
            flow = number * math.pi * 28 * 1.0 / 4 / 1000
            result = run(f"reynolds_{scheme}_{number}", {"fluid.convection": scheme, "circulation.flow_mL_per_s": [0, round(flow, 2), round(flow, 2)]},
                         "pulse-duplicator-2020", base)
            error = abs(mean(result, "q_mL_per_s", 0.044) / flow - 1) if solved(result) else None
            note("Reynolds number", scheme, f"Re {number}, {flow:.0f} mL/s", result, error,
                 f"mean flow of the last 20 ms against what is prescribed; {going(result)}" if solved(result) else "")


def heart_rate():
    """A whole beat of the heart with Windkessel at h = 2 mm."""
    base = VALVE | {"fluid.spacing_mm": 2, "body.leaflets.divisions": [24, 12], "circulation.upstream": "heart",
                    "circulation.downstream": "windkessel", "cycle.history_interval": 10, "cycle.duration_s": 0}
    for rate in (60, 120, 200, 30):
        result = run(f"rate_{rate}", {"circulation.period_s": 60 / rate}, base=base, timeout_s=1800)
        m = result["metrics"] if result else {}
        error = m["volume_balance_error_pct"] / 100 if "volume_balance_error_pct" in m else None
        note("heart rate", "up" if rate > 30 else "down", f"{rate} 1/min", result, error,
             "volume gained over the stroke volume; "
             f"stroke volume {m['stroke_volume_mL']:.1f} mL, regurgitation {m['regurgitant_volume_mL']:.1f} mL, mean gradient "
             f"{m['mean_gradient_mmHg']:.1f} mmHg; {going(result)}" if error is not None else "")


def resistance():
    """120 mmHg upstream, a resistance to 80 mmHg downstream: at the end p = 80 mmHg + R Q."""
    for series, values in (("down to none", (0.05, 0.005, 0.0)), ("up to infinite", (0.5, 1.5, 3.5, 9.0, 50.0, 1e3, 1e6, 1e12))):
        for value in values:
            result = run(f"resistance_{value}", steady(120, 80, value) | {"cycle.duration_s": 0.04})
            error, remark = None, ""
            if solved(result):
                q, p = mean(result, "q_mL_per_s", 0.03), mean(result, "p_ao_mmHg", 0.03)
                # The pressure is read 3 mm inside; the head of the jet there is not known better than by the mean flow.
                error = abs(p - 80 - value * q) / 40
                remark = f"mean of the last 10 ms, p - (80 + R Q) over 40 mmHg; {q:.3g} mL/s, {p:.4g} mmHg; {going(result)}"
            note("outlet resistance", series, f"{value} mmHg s/mL", result, error, remark)


def compliance():
    """The heart ejects into the Windkessel for 80 ms; its pressure is integrated again from the recorded flow."""
    base = VALVE | {"circulation.upstream": "heart", "circulation.downstream": "windkessel", "cycle.duration_s": 0.09}
    normal, peripheral, characteristic = 1.9504, 0.9046, 0.042
    for series, factors in (("down", (1, 1e-1, 1e-2, 1e-4, 1e-6)), ("up", (1e1, 1e2, 1e4))):
        for factor in factors:
            result = run(f"compliance_{factor:g}", {"circulation.compliance_mL_per_mmHg": normal * factor}, base=base)
            error, remark = None, ""
            if solved(result):
                t, q, p = (result["columns"][name] for name in ("time_s", "q_mL_per_s", "p_ao_mmHg"))
                begin = next(i for i, time_s in enumerate(t) if time_s > 0.012)
                stored, off = p[begin] - characteristic * q[begin], 0
                for i in range(begin + 1, len(t)):
                    dt = t[i] - t[i - 1]
                    decay = math.exp(-dt / (peripheral * normal * factor))
                    stored = stored * decay + 0.5 * (q[i] + q[i - 1]) * peripheral * (1 - decay)
                    off += dt * (stored + characteristic * q[i] - p[i])
                error = abs(off) / (t[-1] - t[begin]) / max(p[begin:])
                remark = (f"mean difference from the Windkessel integrated again, over the largest pressure; aorta {min(p[begin:]):.1f} to "
                          f"{max(p[begin:]):.1f} mmHg; {going(result)}")
            note("Windkessel compliance", series, f"{factor:g} of normal", result, error, remark)


def thickness():
    """The valve closes under 80 mmHg."""
    for series, shares in (("thinner", (1, 0.5, 0.25, 0.1)), ("thicker", (2, 3, 10))):
        for share in shares:
            result = run(f"thickness_{share:g}", steady(8, 80) | {"body.leaflets.thickness_mm": 0.386 * share, "cycle.duration_s": 0.045})
            note("leaflet thickness", series, f"{100 * share:g} %", result, None, closed(result, 0.035))


def closed(result, start):
    return (f"leak {-mean(result, 'q_mL_per_s', start):.1f} mL/s, orifice {last(result, 'orifice_cm2'):.3f} cm2 at the end; {going(result)}"
            if solved(result) else "")


def stiffness():
    """C10 and all other moduli of the leaflets; the valve opens under 20 mmHg, and closes under 80."""
    for way, pressures in (("opening", (100, 80)), ("closing", (8, 80))):
        for factor in (1e1, 1e3, 1e5):
            result = run(f"stiffness_{way}_{factor:g}", steady(*pressures) | {
                "body.leaflets.membrane_scale": factor, "body.leaflets.bending_scale": factor, "cycle.duration_s": 0.03}, timeout_s=300)
            note("stiffness C10", way, f"x {factor:g}", result, None, closed(result, 0.02))


def mesh():
    """The leaflets' edges in cells (h = 1.5 mm), closing under 80 mmHg."""
    length, height = 32 * 0.75, 15 * 0.75
    finest = None
    for ratio in (0.25, 0.5, 1, 2, 4):
        edge = 1.5 * ratio
        result = run(f"mesh_{ratio:g}", steady(8, 80) | {"cycle.duration_s": 0.045, "body.leaflets.divisions": [
            max(2, round(length / edge)), max(2, round(height / edge))]})
        if solved(result):
            orifice = mean(result, "orifice_cm2", 0.0)
            finest = finest or orifice
        note("structure mesh over grid", "0.25 to 4", f"{ratio:g}", result, abs(orifice / finest - 1) if solved(result) else None,
             f"mean orifice while closing against the finest; {closed(result, 0.035)}" if solved(result) else "")


def grid():
    """Cells from 2 mm to 0.39 mm, leaflet edges half of them: 4 ms of opening."""
    reference = None
    for h in (0.39, 0.5, 0.75, 1.0, 1.5, 2.0, 3.0):
        result = run(f"grid_{h:g}", steady(100, 80) | {"fluid.spacing_mm": h, "cycle.initialisation_s": 0.002, "cycle.duration_s": 0.006,
                     "body.leaflets.divisions": [round(48 / h), round(23 / h)]}, timeout_s=1800)
        if solved(result):
            flow = last(result, "q_mL_per_s")
            reference = reference or flow
        note("grid", "2 mm to 0.39 mm and beyond", f"{h:g} mm", result, abs(flow / reference - 1) if solved(result) else None,
             f"flow at 6 ms, {flow:.1f} mL/s, against 0.39 mm; {result['processor_s']:.0f} s; {going(result)}" if solved(result) else "")


def closed_pressure():
    """The shut valve under ever more pressure."""
    for pressure in (80, 120, 180, 250, 300):
        result = run(f"pressure_{pressure}", steady(8, pressure) | {"cycle.initialisation_s": 0.02, "cycle.duration_s": 0.05})
        note("aortic pressure, closed", "up", f"{pressure} mmHg", result, None, closed(result, 0.04))
    result = run("pressure_400", steady(8, 400))
    note("aortic pressure, closed", "up", "400 mmHg", result)


def reversal():
    """The valve between ends whose pressure difference swings: flow turns round at both ends in every period; and a vessel
    that forks, with a flow at one opening that reverses, and outlets at which the pressure does."""
    for amplitude in (20, 60, 120):
        knots = [80 + amplitude * math.sin(2 * math.pi * i / 16) for i in range(16)]
        result = run(f"reversal_valve_{amplitude}", {
            "circulation.upstream": "pressure", "circulation.downstream": "pressure", "circulation.aortic_pressure_mmHg": 80,
            "circulation.period_s": 0.2, "circulation.pressure_time_s": [round(0.04 * i / 16 + 0.04 * j, 6) for j in range(5) for i in range(16)],
            "circulation.pressure_mmHg": [round(x, 3) for x in knots * 5], "cycle.duration_s": 0.09,
            "body.leaflets.membrane_scale": 50, "body.leaflets.bending_scale": 50})
        remark = ""
        if solved(result):
            q, low = result["columns"]["q_mL_per_s"], result["columns"]["q_in_mL_per_s"]
            remark = f"{min(q):.0f} to {max(q):.0f} mL/s at the aorta, {min(low):.0f} to {max(low):.0f} at the ventricle; {going(result)}"
        note("flow reversal", "stiff valve, 25 Hz", f"+- {amplitude} mmHg", result, None, remark)
    base = {"fluid.grid_mm": 0.8, "fluid.end_s": 0.1, "fluid.history_rows": 100, "output.checkpoint_s": 1e5}
    sine = "sin(2*pi*t/0.05)"
    for factor in (1, 5, 25):
        for name, changes in {
                "flow at the inlet": {"opening.inlet.factor_of_t": sine, "opening.inlet.flow_mL_per_s": 6 * factor},
                "pressure at an outlet": {"opening.right.pressure_Pa": 1000 * factor, "opening.right.factor_of_t": sine},
                "pressure at every outlet": {"opening.right.pressure_Pa": 1000 * factor, "opening.right.factor_of_t": sine,
                                             "opening.left.pressure_Pa": 1000 * factor, "opening.left.factor_of_t": "-" + sine}}.items():
            result = run(f"reversal_fork_{name.replace(' ', '_')}_{factor}", changes, "fluid-bifurcation", base)
            error, remark = None, ""
            if solved(result):
                flows = {key.split("_mL")[0]: v for key, v in result["columns"].items() if key.split("_")[0] in ("in", "right", "left")}
                largest = max(abs(x) for v in flows.values() for x in v)
                error = max(abs(sum(x)) for x in zip(*flows.values())) / largest
                remark = "sum of all flows over the largest; " + ", ".join(f"{key} {min(v):.1f} to {max(v):.1f}" for key, v in flows.items())
            note("flow reversal", f"vessel that forks, {name}", f"x {factor}", result, error, remark)


def cfl():
    """The valve with steps limited by the flow alone as far as its tissue lets them, at Re 20,000; and Taylor-Green's vortices."""
    base = {"fluid.spacing_mm": 2, "body.leaflets.divisions": [24, 12], "test_section.z_mm": [-30, -6, -5.5, -1.5, -1, 41],
            "cycle.initialisation_s": 0.004, "cycle.duration_s": 0.064, "output.checkpoint_s": 1e5, "cycle.history_interval": 5,
            "circulation.upstream": "flow", "circulation.downstream": "pressure", "circulation.aortic_pressure_mmHg": 8,
            "circulation.flow_time_s": [0, 0.02, 0.8], "circulation.flow_mL_per_s": [0, 439.82, 439.82], "cycle.max_step_s": 1e-2}
    reference = None
    for limit in (0.2, 0.35, 0.5, 0.7, 1.0):
        result = run(f"cfl_valve_{limit}", {"cycle.max_cfl": limit}, "pulse-duplicator-2020", base)
        if solved(result):
            drop = mean(result, "p_lvot_mmHg", 0.044) - mean(result, "p_ao_mmHg", 0.044)
            reference = reference or drop
        note("CFL number", "valve at Re 20,000, weno5", f"{limit}", result, abs(drop / reference - 1) if solved(result) else None,
             f"pressure difference over the last 20 ms, {drop:.2f} mmHg, against 0.2; {going(result)}" if solved(result) else "")
    for scheme, limits in (("ab2", (0.1, 0.35, 0.5, 0.7, 1.0)), ("rk3", (0.1, 1.0, 1.5, 2.0))):
        reference = None
        for limit in limits:
            result = run(f"cfl_vortex_{scheme}_{limit}", {"fluid.cells": [24, 24, 24], "fluid.time_scheme": scheme, "fluid.order": 2,
                         "fluid.convection": "upwind3", "fluid.cfl": limit, "fluid.end_s": 5, "fluid.history_rows": 10,
                         "output.checkpoint_s": 1e5}, "fluid-taylor-green-re1600", {})
            if solved(result):
                energy = next(v[-1] for key, v in result["columns"].items() if key.startswith("kinetic"))
                reference = reference or energy
            note("CFL number", f"Taylor-Green 24^3, upwind3, {scheme}", f"{limit}", result,
                 abs(energy / reference - 1) if solved(result) else None, "kinetic energy at t = 5 against 0.1" if solved(result) else "")


PARTS = (reynolds, resistance, compliance, closed_pressure, stiffness, thickness, mesh, reversal, cfl, heart_rate, grid)


def main():
    global AGAIN, STORED_ONLY, NAMES
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("out", nargs="?", type=Path, default=RESULTS)
    parser.add_argument("--only", nargs="*", default=[])
    parser.add_argument("--again", action="store_true")
    parser.add_argument("--names", nargs="*", default=[], help="these runs alone (folders of runs/extremes/cycle); of the others what is there")
    options = parser.parse_args()
    unknown = [name for name in options.only if name not in [part.__name__ for part in PARTS]]
    if unknown:
        parser.error(f"--only: no part is called {unknown[0]}; expected {', '.join(part.__name__ for part in PARTS)}")
    AGAIN, NAMES = options.again, options.names
    source, start = runs.provenance(), time.monotonic()
    for part in PARTS:
        STORED_ONLY = bool(options.only) and part.__name__ not in options.only
        print(f"{part.__name__} ({time.monotonic() - start:.0f} s since the start)", flush=True)
        part()
    if options.only or options.names:
        STUDY.take_others(options.out / "cycle-extremes.csv", single_runs=bool(options.names))
    STUDY.write(options.out, source)
    print(f"all: {time.monotonic() - start:.0f} s")


if __name__ == "__main__":
    main()
