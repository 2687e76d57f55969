"""make tradeoff, beating valve: figures of the beat against time over grid, leaflet mesh, kernel, coupling, step, convection.

    python3 pipelines/tradeoff_cycle.py [--scenes NAME ...] [--knobs WORD ...] [--values TEXT ...] [--ranks 2] [--again]
                                        [--out docs/results] [--runs runs] [--list] [--tables]
                                        [--take FOLDER [--processor-s S]]

Every row is one beat of a scene with one knob moved from the base (draft: h = 1 mm, leaflet edges 0.5 mm, ib4, safety 0.85,
upwind3; the stenotic valve h = 1.5 mm). The stages before the beat run once for each leaflet mesh. OUT/cycle-tradeoff.csv is rewritten after every row and
is the study's memory: a row that it holds with the same parameters is not run again (--again: it is), so that the study can
be done in pieces, the cheap rows first; every row names its own commit, machine and load. --list: what is there and what is
missing; --tables: only the tables and the plot anew; --take: the one row that is asked for is read from a beat that was run
with the same parameters by other means. With OUT/structure-tradeoff.csv they make runs/tradeoff/tradeoff.csv.

difference_pct: the largest difference of mean gradient, orifice area and stroke volume from the base's. <figure>_error_pct:
from the value extrapolated to h = 0 (Richardson) with the order that the three finest grids of the scene show
(cycle-tradeoff-order.csv); where they show none, from the finest grid, whose own error is then its difference from the next;
error_pct is the largest of the first three. Pareto: no other row of the scene is both cheaper (processor time) and nearer. What `valsalva-cycle --estimate` and
the accuracy band of a run go by is the part of these rows in cycle/measured.csv, which is written along with OUT =
docs/results.
"""

import argparse
import json
import os
import subprocess
import sys
import time
from pathlib import Path

import pipeline
import stages
import structure_runs as runs
import tradeoff

START = time.monotonic()
SCENES = {"native-healthy": "healthy", "native-stenotic": "stenotic", "demo": "device"}
FIGURES = tradeoff.FIGURES
OTHERS = ["leaflet_max_principal_strain_p99", "diastolic_leak_mL_per_s", "volume_balance_error_pct", "max_cfl", "returns_after_alarm",
          "cells", "leaflet_nodes"]
COMPARED = FIGURES[:3]
BASE = {"fluid.spacing_mm": "1", "leaflet_edge_mm": "0.5"}
# Where a row of the base takes twenty minutes.
BASE_OF = {"native-stenotic": {"fluid.spacing_mm": "1.5"}}
# knob -> (value, what it changes)
KNOBS = {
    "grid": [("1.5 mm", {"fluid.spacing_mm": "1.5"}), ("1.25 mm", {"fluid.spacing_mm": "1.25"}),
             ("1 mm", {"fluid.spacing_mm": "1"}),
             ("0.75 mm", {"fluid.spacing_mm": "0.75", "leaflet_edge_mm": "0.37"}),
             ("0.5 mm", {"fluid.spacing_mm": "0.5", "leaflet_edge_mm": "0.25"}),
             ("0.39 mm", {"fluid.spacing_mm": "0.39", "leaflet_edge_mm": "0.195"})],
    "leaflet edge": [("1 mm", {"leaflet_edge_mm": "1"}), ("0.7 mm", {"leaflet_edge_mm": "0.7"}),
                     ("0.35 mm", {"leaflet_edge_mm": "0.35"})],
    "kernel": [(name, {"cycle.kernel": name}) for name in ("ib3", "bspline3", "bspline4", "cbs32", "cbs43")],
    "coupling": [("no standoff", {"cycle.standoff_cells": "0"}), ("no repulsion", {"cycle.repulsion_kPa": "0"})],
    "wall": [("interpolated", {"fluid.wall": "interpolated"}), ("upwind1", {"fluid.wall_convection": "upwind1"})],
    "step safety": [(value, {"cycle.step_safety": value}) for value in ("0.6", "0.3")],
    "largest step": [("30 us", {"cycle.max_step_s": "3e-5"})],
    "convection": [(name, {"fluid.convection": name}) for name in ("weno5", "centred4")],
}
# What a scene has otherwise: the device's crimp and deployment with leaflet edges of 0.25 mm take longer than the beat.
OTHERWISE = {("demo", "grid", value): {"leaflet_edge_mm": "0.37"} for value in ("0.5 mm", "0.39 mm")}
KEYS = ("scene", "knob", "value")
MEASURED = ["valve", "spacing_mm", "ranks", "cells", "leaflet_nodes", "steps", "simulated_s", "processor_s", "memory_MiB",
            *[f"{figure}_error_pct" for figure in FIGURES], "error_basis", "commit", "machine", "date"]


def parent(scene, edge, folder):
    """The newest state of the stage before the beat, with this leaflet mesh."""
    overrides = [f"mesh.leaflet_edge_mm={edge}"]
    if "[device]" in stages.case_path(scene).read_text():
        overrides.append(f"device.leaflet_edge_mm={edge}")
    chain = stages.Chain(scene, "draft", overrides, 1, folder / f"edge-{edge}")
    before = [stage for stage in chain.stages() if stage not in ("cycle", "report")]
    for stage in before:
        if code := pipeline.run_stage(chain, stage, False, False):
            sys.exit(f"error: {stage} of {scene} with leaflet edges of {edge} mm failed with exit code {code}")
    return sorted((chain.folder / before[-1]).glob("state_*.h5"))[-1]


def settings_of(scene, changes):
    return BASE | BASE_OF.get(scene, {}) | changes


def words_of(scene, changes):
    settings = settings_of(scene, changes)
    edge = settings.pop("leaflet_edge_mm")
    device = "[device]" in stages.case_path(scene).read_text()
    settings |= {"mesh.leaflet_edge_mm": edge} | ({"device.leaflet_edge_mm": edge} if device else {})
    words = [runs.BIN / "valsalva-cycle", stages.case_path(scene), "--fidelity", "draft"]
    return words + [word for key, value in settings.items() for word in ("--set", f"{key}={value}")], edge


def digest_of(words, edge):
    """Of all parameters of the beat and of the leaflet mesh."""
    done = subprocess.run([str(w) for w in words] + ["--digest"], cwd=runs.ROOT, stdout=subprocess.PIPE, text=True)
    if done.returncode:
        sys.exit(done.returncode)
    return f"{done.stdout.strip()[:12]}-{edge}"


def beat(scene, knob, value, changes, options, digest):
    """One row: the beat is run."""
    words, edge = words_of(scene, changes)
    folder = options.runs / "tradeoff" / "cycle"
    state = parent(scene, edge, folder / "meshes")
    if options.ranks > 1:
        words = ["mpirun", "--oversubscribe", "--bind-to", "none", "-np", options.ranks] + words
    source = runs.provenance()
    result = runs.run_program(words + ["--from", state.resolve()], folder / f"{scene}-{knob}-{value}".replace(" ", "_"), 86400)
    status = "not finite" if result["nan"] else "ok" if result["exit"] == 0 else result["message"][:200]
    return row_of(scene, knob, value, changes, digest, result.get("summary", {}), status, result["wall_s"], result["processor_s"], source)


def row_of(scene, knob, value, changes, digest, summary, status, wall_s, processor_s, source):
    metrics = summary.get("metrics", {})
    settings = settings_of(scene, changes)
    return {"scene": scene, "knob": knob, "value": value, "status": status, "spacing_mm": settings["fluid.spacing_mm"],
            "leaflet_edge_mm": settings["leaflet_edge_mm"], "ranks": summary.get("ranks", ""), "steps": summary.get("steps", ""),
            "simulated_s": summary.get("simulated_s", ""), "wall_s": round(wall_s, 1), "processor_s": round(processor_s, 1),
            "memory_MiB": round(summary.get("peak_rss_MiB", 0)), **{name: metrics.get(name, "") for name in FIGURES + OTHERS},
            "parameters": digest, "commit": summary.get("version", source["commit"]), "machine": source["machine"],
            "load_at_start": source["load_at_start"], "date": source["date"]}


def taken(scene, knob, value, changes, folder, digest, source, processor_s):
    """The row of a beat that was run with the same parameters by other means on this machine, of its stage's folder; without
    processor_s the ranks' processors count as busy all the time."""
    path = Path(folder) / "summary.json"
    summary = json.loads(path.read_text())
    if not summary["parameters_sha256"].startswith(digest.split("-")[0]) or summary["status"] != "ok":
        sys.exit(f"error: {path} is not a finished beat with the parameters of {scene}, {knob} {value}")
    when = time.strftime("%Y-%m-%d %H:%M:%S", time.localtime(path.stat().st_mtime))
    return row_of(scene, knob, value, changes, digest, summary, "ok", summary["wall_s"], processor_s or summary["wall_s"] * summary["ranks"],
                  source | {"load_at_start": "", "date": when})


def spacing(row):
    return float(row["spacing_mm"])


def number(row, name):
    return float(row[name]) if row.get(name) not in ("", None) else None


def whole(rows, scene):
    """The rows of the scene with all the figures of a beat."""
    return [row for row in rows if row["scene"] == scene and row["status"] == "ok" and number(row, COMPARED[0]) is not None]


def extrapolate(h, f):
    """Value at h = 0 and observed order from the three finest grids, h ascending; where they show none, or are fewer, the finest
    value and None. None, None for a single grid."""
    if len(h) < 2:
        return None, None
    if len(h) > 2 and f[1] != f[0]:
        ratio = (f[2] - f[1]) / (f[1] - f[0])
        order = next((p / 100 for p in range(30, 401)
                      if (h[2] ** (p / 100) - h[1] ** (p / 100)) / (h[1] ** (p / 100) - h[0] ** (p / 100)) >= ratio), None)
        smallest = (h[2] ** 0.3 - h[1] ** 0.3) / (h[1] ** 0.3 - h[0] ** 0.3)
        if order is not None and ratio >= smallest:
            return f[0] - (f[1] - f[0]) / ((h[1] / h[0]) ** order - 1), order
    return f[0], None


def compare(rows):
    """Fills in differences, errors and the Pareto front of each scene; the table of orders."""
    orders = []
    for row in rows:
        row |= {"difference_pct": "", **{f"{figure}_error_pct": "" for figure in FIGURES}, "error_basis": "", "error_pct": "", "pareto": ""}
    for scene in dict.fromkeys(row["scene"] for row in rows):
        mine = whole(rows, scene)
        grids = sorted((row for row in mine if row["knob"] == "grid"), key=spacing)
        base = next((row for row in grids if spacing(row) == float(settings_of(scene, {})["fluid.spacing_mm"])), None)
        if base:
            for row in mine:
                row["difference_pct"] = round(100 * max(abs(number(row, f) / number(base, f) - 1) for f in COMPARED), 3)
        if len(grids) < 2:
            continue
        finest = grids[:3]
        basis = []
        for figure in FIGURES:
            h, f = [spacing(row) for row in finest], [number(row, figure) for row in finest]
            limit, order = extrapolate(h, f)
            basis.append("none" if order is None else f"{order:g}")
            for row in mine:
                # Without an order the finest value is off by what the next one differs from it, as far as is known.
                value = f[1] if order is None and row is finest[0] else number(row, figure)
                # Of a figure that is nothing (a stiff valve does not leak) there is no relative error but zero.
                row[f"{figure}_error_pct"] = round(100 * abs(value / limit - 1), 3) if limit else 0 if value == limit else ""
            orders.append({"scene": scene, "figure": figure, **{key: value for i in range(3) for key, value in (
                (f"h{i + 1}_mm", h[i] if i < len(h) else ""), (f"value{i + 1}", f[i] if i < len(f) else ""))},
                           "observed_order": "" if order is None else order, "extrapolated": "" if order is None else round(limit, 5),
                           "finest_error_pct": finest[0][f"{figure}_error_pct"]})
        for row in mine:
            row["error_basis"] = f"grids {' '.join(row2['spacing_mm'] for row2 in finest)} mm, orders {' '.join(basis)}"
            row["error_pct"] = max(row[f"{figure}_error_pct"] for figure in COMPARED)
        tradeoff.mark_pareto(mine)
    return orders


def write(rows, options, source):
    """All tables; what the program goes by only along with the committed ones."""
    if not rows:
        return
    wanted = [(scene, knob, value) for scene in SCENES for knob in KNOBS for value, _ in KNOBS[knob]]
    place = {key: n for n, key in enumerate(wanted)}
    rows.sort(key=lambda row: place.get(tuple(row[key] for key in KEYS), len(place)))
    orders = compare(rows)
    runs.write_csv(options.out / "cycle-tradeoff.csv", rows, source)
    if orders:
        runs.write_csv(options.out / "cycle-tradeoff-order.csv", orders, source)
    measured = [{key: {"valve": SCENES[row["scene"]]}.get(key, row.get(key, "")) for key in MEASURED}
                for row in sorted(rows, key=lambda row: (row["scene"], -spacing(row)))
                if row["scene"] in SCENES and row["knob"] == "grid" and row["status"] == "ok"]
    if measured and options.out.resolve() == tradeoff.RESULTS.resolve():
        runs.write_csv(runs.ROOT / "cycle" / "measured.csv", measured, source)
    tradeoff.gather(options.out, options.runs / "tradeoff")


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--scenes", nargs="*", default=list(SCENES))
    parser.add_argument("--knobs", nargs="*", default=list(KNOBS))
    parser.add_argument("--values", nargs="*", default=[])
    parser.add_argument("--ranks", type=int, default=min(2, os.cpu_count() or 1))
    parser.add_argument("--out", type=Path, default=tradeoff.RESULTS)
    parser.add_argument("--runs", type=Path, default=runs.ROOT / "runs")
    parser.add_argument("--again", action="store_true")
    parser.add_argument("--list", action="store_true")
    parser.add_argument("--tables", action="store_true")
    parser.add_argument("--take", type=Path, help="folder of the beat that is the one row asked for")
    parser.add_argument("--processor-s", type=float, help="--take: processor time of that beat, where it was measured")
    options = parser.parse_args()
    if unknown := [knob for knob in options.knobs if knob not in KNOBS]:
        parser.error(f"--knobs: '{unknown[0]}' is none of {', '.join(KNOBS)}")
    known = [value for knob in options.knobs for value, _ in KNOBS[knob]]
    if unknown := [value for value in options.values if value not in known]:
        parser.error(f"--values: '{unknown[0]}' is none of {', '.join(known)}")
    stages.BIN = runs.BIN
    source = runs.provenance()
    rows, before = tradeoff.read(options.out / "cycle-tradeoff.csv")
    if options.tables:
        write(rows, options, before or source)
        return
    asked = [(knob, scene, value, changes | OTHERWISE.get((scene, knob, value), {}))
             for knob in options.knobs for value, changes in KNOBS[knob] for scene in options.scenes
             if not options.values or value in options.values]
    for knob, scene, value, changes in asked:
        digest = digest_of(*words_of(scene, changes))
        same = [row for row in rows if tuple(row[key] for key in KEYS) == (scene, knob, value)]
        done = [row for row in same if row["parameters"] == digest and row["status"] == "ok"]
        if options.list or (done and not options.again):
            print(f"{scene}, {knob} {value}: {'done, ' + done[0]['commit'] if done else 'missing'}")
            continue
        if options.take and len(asked) != 1:
            parser.error("--take: name one scene, knob and value")
        row = (taken(scene, knob, value, changes, options.take, digest, source, options.processor_s) if options.take
               else beat(scene, knob, value, changes, options, digest))
        rows = [other for other in rows if other not in same] + [row]
        write(rows, options, source)
        print(f"{time.monotonic() - START:6.0f} s  {scene}, {knob} {value}: {row['status']}, {row['steps']} steps, "
              f"{row['processor_s']} s of processor, {row['difference_pct'] or '?'} % from the base", flush=True)
    if not options.list:
        write(rows, options, source)
        print(f"written: {options.out / 'cycle-tradeoff.csv'}, {options.runs / 'tradeoff' / 'tradeoff.csv'} after "
              f"{time.monotonic() - START:.0f} s")


if __name__ == "__main__":
    main()
