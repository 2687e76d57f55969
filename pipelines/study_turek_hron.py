"""Turek and Hron's FSI1, FSI2 and FSI3 (pipelines/cases/fsi-turek-hron-fsi*.toml) on grids of choice, against the published
figures.

    python3 pipelines/study_turek_hron.py --cases fsi1 fsi2 --cells 82
    python3 pipelines/study_turek_hron.py                  only writes table and picture anew from the runs there are

--cells: across the channel; the bar is a twentieth of it thick, and has elements three cells long. The channel is cut at 1 m
(FSI1) and 1.2 m. Runs lie in runs/study-turek-hron. Written to docs/results: turek-hron.csv, half the sum and difference of the
largest and smallest values of point A and of drag and lift in the last second or two, frequencies from upward crossings of the
mean (FSI1: the last values); to docs/pictures: turek-hron.png. Published: ../shared/reference/fsi (FSI1, FSI2); without it the
runs are made and not compared.
"""

import argparse
import csv
import json
from pathlib import Path

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np

import flow_runs
from structure_runs import ROOT, provenance, write_csv

RUNS = ROOT / "runs" / "study-turek-hron"
PUBLISHED = flow_runs.REFERENCE.parent / "fsi" / "turek_hron.csv"
ENDS_S = {"fsi1": 9, "fsi2": 13, "fsi3": 10}
FROM_S = {"fsi1": 0, "fsi2": 11, "fsi3": 8}
LENGTH_MM = {"fsi1": 1000, "fsi2": 1200, "fsi3": 1200}
BAR_MM = 351.01020514433643
# What the published table calls a quantity and its mean; amplitude and frequency end in _amp and _Hz.
QUANTITIES = {"A_x_mm": ("ux", "ux_A_mm_mean"), "A_y_mm": ("uy", "uy_A_mm_mean"),
              "drag_N_per_m": ("drag", "drag_N_m_mean"), "lift_N_per_m": ("lift", "lift_N_m_mean")}


def values_of(case, cells):
    h = 410 / cells
    return {"fluid.grid_mm": f"{h:.17g}", "fluid.box_mm": f"[0, 0, 0, {LENGTH_MM[case]}, 410, {h:.17g}]",
            "fluid.end_s": str(ENDS_S[case]), "coupling.probe_interval": "50",
            "body.bar.divisions": f"[{round(12 * cells / 41)}, 1, 1]", "body.bar.size_mm": f"[{BAR_MM}, 20, {h:.17g}]"}


def courses(folder, note):
    history = flow_runs.columns(folder / "history.csv")
    per_m = 1000 / (410 / note["study"]["cells"])
    return history["time_s"], {"A_x_mm": history["A_x_mm"], "A_y_mm": history["A_y_mm"],
                               "drag_N_per_m": history["force_x_N"] * per_m, "lift_N_per_m": history["force_y_N"] * per_m}


def frequency(t, y):
    """Of the upward crossings of the mean; nothing with fewer than two."""
    off = y - y.mean()
    up = np.flatnonzero((off[:-1] < 0) & (off[1:] >= 0))
    at = t[up] - off[up] * (t[up + 1] - t[up]) / (off[up + 1] - off[up])
    return round(float((len(at) - 1) / (at[-1] - at[0])), 3) if len(at) > 1 else ""


def published(case):
    """Row of the published table, or nothing."""
    if not PUBLISHED.exists():
        return {}
    with open(PUBLISHED, newline="") as file:
        rows = csv.DictReader(line for line in file if not line.startswith("#"))
        return next((row for row in rows if row["test"] == case.upper()), {})


def figure_of(row, quantity, what):
    """A published figure, or None; what: mean, amp or Hz."""
    short, mean = QUANTITIES[quantity]
    text = row.get(mean if what == "mean" else f"{short}_{what}")
    return float(text) if text else None


def described(folder, note):
    case = note["study"]["case"]
    t, all_y = courses(folder, note)
    row = {"case": case, "cells": note["study"]["cells"]}
    table = published(case)
    for name in QUANTITIES:
        if case == "fsi1":
            found = {"mean": round(float(all_y[name][-1]), 5)}
        else:
            late = t >= FROM_S[case]
            y = all_y[name][late]
            found = {"mean": round(float(y.max() + y.min()) / 2, 3), "amp": round(float(y.max() - y.min()) / 2, 3),
                     "Hz": frequency(t[late], y) if name.startswith("A_") else ""}
        for what in ("mean", "amp", "Hz"):
            row[f"{name}_{what}"] = found.get(what, "")
            given = figure_of(table, name, what)
            row[f"{name}_{what}_published"] = given if given is not None and found.get(what, "") != "" else ""
    return row | flow_runs.made(note)


def picture(runs, path):
    figure, axes = plt.subplots(1, 3, figsize=(12, 3.8))
    for axis, case in zip(axes, ENDS_S):
        mine = [(folder, note) for folder, note in runs if note["study"]["case"] == case]
        for folder, note in mine:
            t, y = courses(folder, note)
            late = t >= FROM_S[case]
            axis.plot(t[late], y["A_y_mm"][late], linewidth=1, label=f"{note['study']['cells']} cells across the channel")
        table = published(case)
        mean, amplitude = figure_of(table, "A_y_mm", "mean"), figure_of(table, "A_y_mm", "amp")
        for value in {mean} if amplitude is None else {mean - amplitude, mean + amplitude}:
            if value is not None:
                axis.axhline(value, color="k", linestyle="--", linewidth=0.8)
        axis.set(title=case.upper() + (": dashed, published" if table else ""), xlabel="t, s", ylabel="A across, mm")
        axis.grid(alpha=0.3)
        if mine:
            axis.legend(fontsize=7)
    figure.tight_layout()
    figure.savefig(path, dpi=80)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--cases", nargs="+", choices=ENDS_S, default=[])
    parser.add_argument("--cells", type=int, nargs="+", default=[82], help="across the channel")
    parser.add_argument("--ranks", type=int, default=1)
    parser.add_argument("--again", action="store_true", help="repeat what is finished")
    parser.add_argument("--docs", type=Path, default=ROOT / "docs")
    asked = parser.parse_args()
    for case in asked.cases:
        for cells in asked.cells:
            folder = RUNS / f"{case}-{cells}"
            note = flow_runs.run(f"fsi-turek-hron-{case}", folder, values_of(case, cells), asked.ranks, asked.again)
            (folder / "study.json").write_text(json.dumps(note | {"study": {"case": case, "cells": cells}}, indent=1))
    runs = flow_runs.finished(RUNS, lambda study: (study["case"], study["cells"]))
    if not runs:
        parser.error("no run yet; give --cases")
    rows = [described(folder, note) for folder, note in runs]
    for row in rows:
        print(", ".join(f"{key} {value}" for key, value in row.items() if value != "" and not key.startswith(("machine", "load"))))
    source = {key: value for key, value in provenance().items() if key in ("command", "date")}
    write_csv(asked.docs / "results" / "turek-hron.csv", rows, source)
    picture(runs, asked.docs / "pictures" / "turek-hron.png")


if __name__ == "__main__":
    main()
