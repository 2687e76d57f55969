"""make tradeoff, beating valve: figures of the beat against wall time over grid, leaflet mesh, kernel, step and convection.

    python3 pipelines/tradeoff_cycle.py [--scenes NAME ...] [--knobs WORD ...] [--ranks 2] [--out docs/results]

Every row is one beat of a scene with one knob moved from the base (draft: h = 1 mm, leaflet edges 0.5 mm, ib4, safety
0.85, upwind3). Segment and mesher run once for each leaflet mesh; a row whose beat is there already, of the same program
and parameters, is read back, so that a study that was stopped goes on. Written after every row: runs/tradeoff/cycle.csv
and, when it is done, OUT/cycle-tradeoff.csv and .png.

difference_pct: the largest of the differences of mean gradient, orifice area and stroke volume from the base's, over the
base's; error_pct: the same from the finest grid of the scene. Pareto: no other row of the scene is both faster and nearer to
the finest grid. Of the three finest grids comes the observed order and the extrapolated value of each figure (Richardson),
in cycle-tradeoff-order.csv; figures that do not come nearer with every halving have none.
"""

import argparse
import json
import math
import os
import subprocess
import sys
import time
from pathlib import Path

import structure_runs as runs

FOLDER = runs.ROOT / "runs" / "tradeoff" / "cycle"
START = time.monotonic()
FIGURES = ["mean_gradient_mmHg", "eoa_cm2", "stroke_volume_mL", "regurgitant_volume_mL", "leaflet_von_mises_p99_kPa",
           "leaflet_max_principal_strain_p99", "diastolic_leak_mL_per_s", "volume_balance_error_pct", "max_cfl"]
COMPARED = FIGURES[:3]
BASE = {"fluid.spacing_mm": "1", "leaflet_edge_mm": "0.5"}
# knob -> (value, what it changes)
KNOBS = {
    "base": [("draft", {})],
    "grid": [("1.5 mm", {"fluid.spacing_mm": "1.5", "leaflet_edge_mm": "0.75"}),
             ("1.25 mm", {"fluid.spacing_mm": "1.25", "leaflet_edge_mm": "0.62"}),
             ("0.75 mm", {"fluid.spacing_mm": "0.75", "leaflet_edge_mm": "0.37"})],
    "fine": [("0.5 mm", {"fluid.spacing_mm": "0.5", "leaflet_edge_mm": "0.25"})],
    "leaflet edge": [("1 mm", {"leaflet_edge_mm": "1"}), ("0.7 mm", {"leaflet_edge_mm": "0.7"}),
                     ("0.35 mm", {"leaflet_edge_mm": "0.35"})],
    "kernel": [(name, {"cycle.kernel": name}) for name in ("ib3", "bspline3", "bspline4", "cbs32", "cbs43")],
    "step safety": [(value, {"cycle.step_safety": value}) for value in ("0.6", "0.3")],
    "largest step": [("30 us", {"cycle.max_step_s": "3e-5"})],
    "convection": [(name, {"fluid.convection": name}) for name in ("weno5", "centred4")],
}


def program(words, log):
    with open(log, "w") as file:
        return subprocess.run([str(word) for word in words], cwd=runs.ROOT, stdout=file, stderr=subprocess.STDOUT,
                              env=dict(os.environ, OMP_NUM_THREADS="1", OMPI_ALLOW_RUN_AS_ROOT="1",
                                       OMPI_ALLOW_RUN_AS_ROOT_CONFIRM="1")).returncode


def parent(scene, edge):
    """The mesher's state of the scene with this leaflet mesh; of a scene with a device, deploy's."""
    name = f"{scene}-edge-{edge}"
    folder = FOLDER / "meshes"
    folder.mkdir(parents=True, exist_ok=True)
    stage = "deploy" if "[device]" in (runs.ROOT / "pipelines" / "cases" / f"{scene}.toml").read_text() else "mesher"
    words = [sys.executable, "pipelines/pipeline.py", "stage", stage, scene, "--fidelity", "draft", "--runs", folder, "--set",
             f"case.name={name}", "--set", f"mesh.leaflet_edge_mm={edge}"]
    if stage == "deploy":
        words += ["--set", f"device.leaflet_edge_mm={edge}"]
    code = program(words, folder / f"{name}.log")
    if code:
        sys.exit(f"error: {stage} of {scene} with leaflet edges of {edge} mm failed with exit code {code}, see {folder / name}.log")
    return sorted((folder / name / stage).glob("state_*.h5"))[-1], (stage == "deploy")


def beat(scene, label, changes, ranks):
    """The summary of one beat, run where it is not there already."""
    settings = BASE | changes
    edge = settings.pop("leaflet_edge_mm")
    state, device = parent(scene, edge)
    out = FOLDER / f"{scene}-{label.replace(' ', '_')}"
    sets = settings | {"mesh.leaflet_edge_mm": edge} | ({"device.leaflet_edge_mm": edge} if device else {})
    words = [runs.BIN / "valsalva-cycle", f"pipelines/cases/{scene}.toml", "--fidelity", "draft"]
    words += [word for key, value in sets.items() for word in ("--set", f'{key}={value}')]
    version = subprocess.run([runs.BIN / "valsalva-cycle", "--version"], stdout=subprocess.PIPE, text=True).stdout.split()[-1]
    digest = subprocess.run([str(w) for w in words] + ["--digest"], cwd=runs.ROOT, stdout=subprocess.PIPE, text=True).stdout.strip()
    key = {"version": version, "digest": digest, "ranks": ranks, "parent": state.name}
    stamp = out.with_suffix(".json")
    if stamp.exists() and json.loads(stamp.read_text()) == key and (out / "summary.json").exists():
        return json.loads((out / "summary.json").read_text())
    if ranks > 1:
        words = ["mpirun", "--oversubscribe", "--bind-to", "none", "-np", ranks] + words
    stamp.unlink(missing_ok=True)
    program(words + ["--from", state, "--out", out], out.with_suffix(".log"))
    summary = json.loads((out / "summary.json").read_text()) if (out / "summary.json").exists() else {"status": "failed"}
    if summary["status"] == "ok":
        runs.replace(stamp, json.dumps(key))
    return summary


def spacing(row):
    return float(row["spacing_mm"])


def compare(rows):
    """Differences and the Pareto front, within each scene."""
    for scene in dict.fromkeys(row["scene"] for row in rows):
        mine = [row for row in rows if row["scene"] == scene and row["status"] == "ok"]
        base = next((row for row in mine if row["knob"] == "base"), None)
        finest = min((row for row in mine if row["knob"] in ("base", "grid", "fine")), key=spacing, default=None)
        for row in mine:
            for column, other in (("difference_pct", base), ("error_pct", finest)):
                row[column] = round(100 * max(abs(row[f] / other[f] - 1) for f in COMPARED), 3) if other else ""
        for row in mine:
            row["pareto"] = "yes" if not any(
                other["wall_s"] < row["wall_s"] and other["error_pct"] <= row["error_pct"] for other in mine) else ""


def orders(rows):
    """Observed order and extrapolated value of each figure from the three finest grids of each scene."""
    found = []
    for scene in dict.fromkeys(row["scene"] for row in rows):
        grids = sorted((row for row in rows if row["scene"] == scene and row["status"] == "ok"
                        and row["knob"] in ("base", "grid", "fine")), key=spacing)[:3]
        if len(grids) < 3:
            continue
        h = [spacing(row) for row in grids]
        for figure in COMPARED:
            f = [row[figure] for row in grids]
            ratio = (f[2] - f[1]) / (f[1] - f[0]) if f[1] != f[0] else math.inf
            order = next((p / 100 for p in range(5, 400)
                          if (h[2] ** (p / 100) - h[1] ** (p / 100)) / (h[1] ** (p / 100) - h[0] ** (p / 100)) >= ratio), None)
            limit = f[0] - (f[1] - f[0]) / ((h[1] / h[0]) ** order - 1) if order and ratio > 0 else None
            found.append({"scene": scene, "figure": figure, **{f"h_{a:g}_mm": b for a, b in zip(h, f)},
                          "order": order if limit is not None else "", "extrapolated": "" if limit is None else round(limit, 5),
                          "finest_off_pct": "" if limit is None else round(100 * abs(f[0] / limit - 1), 2)})
    return found


def draw(rows, path):
    import matplotlib
    matplotlib.use("Agg")
    import matplotlib.pyplot as plt
    scenes = list(dict.fromkeys(row["scene"] for row in rows))
    figure, axes = plt.subplots(1, len(scenes), figsize=(7 * len(scenes), 6), squeeze=False)
    for axis, scene in zip(axes[0], scenes):
        mine = [row for row in rows if row["scene"] == scene and row["status"] == "ok"]
        for knob in dict.fromkeys(row["knob"] for row in mine):
            line = [(row["wall_s"], max(row["error_pct"], 0.01)) for row in mine if row["knob"] == knob]
            axis.loglog(*zip(*line), "o", label=knob)
        for row in mine:
            axis.annotate(row["value"], (row["wall_s"], max(row["error_pct"], 0.01)), fontsize=7)
        front = sorted((row["wall_s"], max(row["error_pct"], 0.01)) for row in mine if row["pareto"])
        axis.loglog(*zip(*front), "k--", linewidth=0.8, label="Pareto front")
        axis.set(title=scene, xlabel="wall time of a beat, s", ylabel="largest difference from the finest grid, %")
        axis.grid(True, which="both", alpha=0.3)
        axis.legend(fontsize=7)
    figure.tight_layout()
    partial = path.with_suffix(".partial.png")
    figure.savefig(partial, dpi=100)
    os.replace(partial, path)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--scenes", nargs="*", default=["native-healthy", "native-stenotic", "demo"])
    parser.add_argument("--knobs", nargs="*", default=list(KNOBS))
    parser.add_argument("--ranks", type=int, default=2)
    parser.add_argument("--out", type=Path, default=runs.ROOT / "docs" / "results")
    options = parser.parse_args()
    unknown = [knob for knob in options.knobs if knob not in KNOBS]
    if unknown:
        parser.error(f"--knobs: '{unknown[0]}' is none of {', '.join(KNOBS)}")
    source = runs.provenance()
    rows = []
    for scene in options.scenes:
        for knob in ["base"] + [k for k in options.knobs if k != "base"]:
            for value, changes in KNOBS[knob]:
                summary = beat(scene, f"{knob}-{value}", changes, options.ranks)
                metrics = summary.get("metrics", {})
                rows.append({"scene": scene, "knob": knob, "value": value, "status": summary["status"],
                             "spacing_mm": (BASE | changes)["fluid.spacing_mm"], "ranks": options.ranks,
                             "steps": summary.get("steps", ""), "wall_s": round(summary.get("wall_s", 0), 1),
                             **{f: metrics.get(f, "") for f in FIGURES}, "difference_pct": "", "error_pct": "", "pareto": ""})
                compare(rows)
                runs.write_csv(FOLDER.with_suffix(".csv"), rows, source)
                print(f"{time.monotonic() - START:6.0f} s  {scene}, {knob} {value}: {rows[-1]['status']}, {rows[-1]['steps']} steps, "
                      f"{rows[-1]['wall_s']} s, {rows[-1]['difference_pct']} % from the base", flush=True)
    runs.write_csv(options.out / "cycle-tradeoff.csv", rows, source)
    found = orders(rows)
    if found:
        runs.write_csv(options.out / "cycle-tradeoff-order.csv", found, source)
    draw(rows, options.out / "cycle-tradeoff.png")
    print(f"written: {options.out / 'cycle-tradeoff.csv'} after {time.monotonic() - START:.0f} s")


if __name__ == "__main__":
    main()
