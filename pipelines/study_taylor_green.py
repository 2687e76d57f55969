"""Taylor-Green vortex at Re = 1600 (pipelines/cases/fluid-taylor-green-re1600.toml) on grids and with schemes of choice,
against the spectral solution.

    python3 pipelines/study_taylor_green.py --cells 32 64 --schemes conserving4 upwind3
    python3 pipelines/study_taylor_green.py --cells 128 --schemes conserving4 --ranks 2
    python3 pipelines/study_taylor_green.py                only writes tables and picture anew from the runs there are

Schemes: conserving4, and centred4-4 (both of order 4), centred2, centred4, upwind3, weno5; +vreman adds the subgrid model.
All with Runge-Kutta 3. Runs lie in runs/study-taylor-green. Written to docs/results: taylor-green-3d.csv (one row a run),
taylor-green-3d-curves.csv; to docs/pictures: taylor-green-3d.png. Dissipation is -dE/dt of the mean kinetic energy, by
central differences over rows 0.1 apart; the part of it that viscosity takes comes from the velocity gradients on the grid,
the rest is the scheme's. Without ../shared/reference/fluid the runs are made and not compared.
"""

import argparse
import json
from pathlib import Path

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np

import flow_runs
from structure_runs import ROOT, provenance, write_csv

RUNS = ROOT / "runs" / "study-taylor-green"
VOLUME = (2 * np.pi) ** 3


def values_of(cells, scheme):
    convection, _, subgrid = scheme.partition("+")
    name, _, order = convection.partition("-")
    fourth = name == "conserving4" or order == "4"
    values = {"fluid.cells": f"[{cells}, {cells}, {cells}]", "fluid.order": "4" if fourth else "2",
              "fluid.subgrid": subgrid or "none"}
    return values | ({} if name == "conserving4" else {"fluid.convection": name})


def integral(t, y):
    return float(np.sum(0.5 * (y[1:] + y[:-1]) * np.diff(t)))


def peak(t, y):
    """Of the parabola through the largest value and its neighbours: value, time."""
    i = int(np.clip(np.argmax(y), 1, len(y) - 2))
    a, b, c = np.polyfit(t[i - 1:i + 2] - t[i], y[i - 1:i + 2], 2)
    return float(c - b * b / (4 * a)), float(t[i] - b / (2 * a))


def described(folder, note):
    history = flow_runs.columns(folder / "history.csv")
    t, energy = history["time_s"], history["kinetic_nJ"] / VOLUME
    rate, viscous = -np.gradient(energy, t), history["viscous_nJ_per_s"] / VOLUME
    largest, at = peak(t, rate)
    row = dict(note["study"])
    row |= {"peak": round(largest, 6), "peak_time": round(at, 3), "largest_by_viscosity": round(peak(t, viscous)[0], 6),
            "share_of_scheme_percent": round(100 * (1 - integral(t, viscous) / (energy[0] - energy[-1])), 2),
            "enstrophy_peak": round(float(history["enstrophy_mm3_per_s2"].max() / VOLUME), 3)}
    published = flow_runs.reference("tgv_re1600_dissipation_wang2013.csv")
    if published is not None:
        at_t, right = published["t"], published["minus_dEk_dt"]
        off = np.interp(at_t, t, rate) - right
        over = lambda upto: round(100 * np.sqrt(integral(at_t[at_t < upto], (off ** 2)[at_t < upto])
                                                / integral(at_t[at_t < upto], (right ** 2)[at_t < upto])), 2)
        row |= {"peak_error_percent": round(100 * (largest / right.max() - 1), 2),
                "peak_time_error": round(at - float(at_t[right.argmax()]), 3), "l2_error_percent": over(1e9),
                "l2_error_to_t_5_percent": over(5)}
    return row | flow_runs.made(note), (t, rate, viscous)


def picture(runs, path):
    figure, axes = plt.subplots(1, 2, figsize=(12, 4.6))
    published = flow_runs.reference("tgv_re1600_dissipation_wang2013.csv")
    for axis, which, title in ((axes[0], 1, "-dE/dt"), (axes[1], 2, "of it by viscosity, on the grid")):
        if published is not None:
            axis.plot(published["t"], published["minus_dEk_dt"], "k.", markersize=4, label="Wang et al. 2013, spectral")
        for row, lines in runs:
            axis.plot(lines[0], lines[which], linewidth=1, label=f"{row['scheme']}, {row['cells']}^3")
        axis.set(title=title, xlabel="t", xlim=(0, 20), ylim=(0, 0.0155))
        axis.grid(alpha=0.3)
    axes[0].legend(fontsize=7)
    figure.tight_layout()
    figure.savefig(path, dpi=80)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--cells", type=int, nargs="+", default=[])
    parser.add_argument("--schemes", nargs="+", default=["conserving4"])
    parser.add_argument("--ranks", type=int, default=1)
    parser.add_argument("--again", action="store_true", help="repeat what is finished")
    parser.add_argument("--docs", type=Path, default=ROOT / "docs")
    asked = parser.parse_args()
    for cells in asked.cells:
        for scheme in asked.schemes:
            folder = RUNS / f"{cells}-{scheme}"
            note = flow_runs.run("fluid-taylor-green-re1600", folder, values_of(cells, scheme), asked.ranks, asked.again)
            note["study"] = {"scheme": scheme, "cells": cells}
            (folder / "study.json").write_text(json.dumps(note, indent=1))
    runs = [described(folder, note) for folder, note in flow_runs.finished(RUNS, lambda study: (study["scheme"], study["cells"]))]
    if not runs:
        parser.error("no run yet; give --cells")
    for row, _ in runs:
        print(", ".join(f"{key} {value}" for key, value in row.items() if key not in ("commit", "machine", "load_at_start")))
    source = {key: value for key, value in provenance().items() if key in ("command", "date")}
    write_csv(asked.docs / "results" / "taylor-green-3d.csv", [row for row, _ in runs], source)
    table = [{"scheme": row["scheme"], "cells": row["cells"], "t": round(float(t), 3), "minus_dE_dt": f"{rate:.6f}",
              "by_viscosity": f"{viscous:.6f}"} for row, lines in runs for t, rate, viscous in list(zip(*lines))[::2]]
    write_csv(asked.docs / "results" / "taylor-green-3d-curves.csv", table, source)
    picture(runs, asked.docs / "pictures" / "taylor-green-3d.png")


if __name__ == "__main__":
    main()
