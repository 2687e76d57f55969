"""FDA nozzle (pipelines/cases/fluid-fda-nozzle.toml) at Reynolds numbers and grids of choice, against the laboratories.

    python3 pipelines/study_fda.py --reynolds 500 --cells 8 12 --wall-convection upwind1
    python3 pipelines/study_fda.py --reynolds 3500 --cells 8 12 16 --convection weno5 --subgrid vreman --ranks 2
    python3 pipelines/study_fda.py --reynolds 3500 --cells 12 --convection weno5 --wall-convection upwind1 --span 0.15 0.9
    python3 pipelines/study_fda.py                       only writes tables and picture anew from the runs there are

Runs lie in runs/study-fda. Written to docs/results: fda-nozzle.csv (one row a run), fda-nozzle-stations.csv (one row a
station); to docs/pictures: fda-nozzle.png. A station is inside when the computed value differs from the laboratories' mean
by at most two of their (sample) standard deviations. Every laboratory's pressure has a zero of its own: all of them, and
the computed one, are taken from the last station, z = 32 mm, which is not counted. Without ../shared/reference/fluid the
runs are made and not compared.
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

RUNS = ROOT / "runs" / "study-fda"
THROAT_MM = 4.0
FLOW_MM3_PER_S = {500: 5206.24, 3500: 36443.7}
SPAN_S = {500: (0.8, 1.0), 3500: (0.15, 0.3)}  # averaged
JET_MM = {500: 120, 3500: 40}  # length of the jet at the start


def values_of(reynolds, cells, convection, wall, subgrid, wall_convection, span_s):
    """What a run sets besides what stands in the case file."""
    h = THROAT_MM / cells
    off = 1.25 * h
    a = f"(z < -62.685 ? 6 : z < -40 ? 2 - 4*(z+40)/22.685 : z < {JET_MM[reynolds]} ? 2 : 6)"
    along = f"2 * {FLOW_MM3_PER_S[reynolds]} / pi * max(0, {a}^2 - x^2 - y^2) / {a}^4"
    line = lambda from_z, to_z, from_r, to_r: f"[{from_r - off:.6g}, 0, {from_z}, {to_r - off:.6g}, 0, {to_z}]"
    return {"fluid.grid_mm": f"{h:.17g}", "fluid.convection": convection, "fluid.wall": wall, "fluid.subgrid": subgrid,
            "fluid.wall_convection": wall_convection,
            "fluid.average_from_s": str(span_s[0]), "fluid.end_s": str(span_s[1]),
            "fluid.history_rows": "500", "fluid.cfl": "0.45",
            "boundary.in.flow_mL_per_s": str(FLOW_MM3_PER_S[reynolds] / 1000),
            "fluid.velocity": json.dumps(["0", "0", along]),
            "flow_probe.wall_tube.line_mm": line(-91.5, -62.685, 6, 6),
            "flow_probe.wall_cone.line_mm": line(-62.685, -40, 6, 2),
            "flow_probe.wall_throat.line_mm": line(-40, 0, 2, 2), "flow_probe.wall_outlet.line_mm": line(0, 100, 6, 6)}


def curves(folder):
    """z in mm, axis velocity in m/s; z, wall pressure in Pa."""
    axis = flow_runs.columns(folder / "profile_axis.csv")
    wall = [flow_runs.columns(folder / f"profile_wall_{part}.csv") for part in ("tube", "cone", "throat", "outlet")]
    z = np.concatenate([part["z_mm"] for part in wall])
    p = np.concatenate([part["mean_p_Pa"] for part in wall])
    return axis["z_mm"], 1e-3 * axis["mean_w_mm_per_s"], z, p


def laboratories(reynolds, quantity):
    """z in mm and one column a laboratory, or None."""
    table = flow_runs.reference(f"SE_Re{reynolds}_{quantity}.csv")
    if table is None:
        return None
    z = 1000 * table.pop("z_m")
    values = np.stack(list(table.values()), axis=1)
    if quantity == "wall_pressure":
        return z[:-1], (values - values[-1])[:-1]
    return z, values


def compared(reynolds, quantity, z_run, value_run):
    """Rows of stations, nothing without published data."""
    found = laboratories(reynolds, quantity)
    if found is None:
        return []
    zero = np.interp(32.0, z_run, value_run) if quantity == "wall_pressure" else 0.0
    rows = []
    for z, row in zip(*found):
        row = row[~np.isnan(row)]
        value = np.interp(z, z_run, value_run) - zero
        off = value - row.mean()
        rows.append({"quantity": quantity, "z_mm": round(z, 3), "computed": round(value, 4), "laboratories": len(row),
                     "off_in_percent_of_mean": round(100 * off / abs(row.mean()), 1),
                     "off_in_standard_deviations": round(off / row.std(ddof=1), 2),
                     "inside": int(abs(off) <= 2 * row.std(ddof=1))})
    return rows


def breaks_at(z, w):
    """Where the velocity on the axis falls to three quarters of that in the expansion, mm."""
    limit = 0.75 * np.interp(0.0, z, w)
    behind = np.flatnonzero((z > 0) & (w < limit))
    if len(behind) == 0:
        return ""
    i = behind[0]
    return round(float(z[i - 1] + (w[i - 1] - limit) / (w[i - 1] - w[i]) * (z[i] - z[i - 1])), 1)


def described(folder, note):
    """A row of the table of runs, its stations, its curves."""
    study = note["study"]
    z, w, z_wall, p = curves(folder)
    stations = [dict(study, **row) for quantity, at, value in (("centreline_axial_velocity", z, w), ("wall_pressure", z_wall, p))
                for row in compared(study["reynolds"], quantity, at, value)]
    metrics, values = note["metrics"], note["values"]
    row = study | {"averaged_s": f"{values['fluid.average_from_s']} to {values['fluid.end_s']}"}
    for name in ("centreline_axial_velocity", "wall_pressure"):
        flags = [s["inside"] for s in stations if s["quantity"] == name]
        row[f"{name}_inside"] = f"{sum(flags)}/{len(flags)}"
        row[f"{name}_inside_percent"] = round(100 * sum(flags) / len(flags)) if flags else ""
    at = lambda place: round(float(np.interp(place, z, w)), 4)
    row |= {"w_0_m_per_s": at(0), "w_32_m_per_s": at(32), "w_80_m_per_s": at(80), "falls_to_three_quarters_at_mm": breaks_at(z, w),
            "pressure_drop_Pa": round(float(np.interp(-90.32, z_wall, p) - np.interp(32.0, z_wall, p)), 1),
            "swing_of_w_80_percent": round(100 * (metrics["w_80_mm_per_s_max"] - metrics["w_80_mm_per_s_min"])
                                           / abs(metrics["w_80_mm_per_s_mean"]), 2),
            "flow_lost_before_throat_percent": round(100 - 100 * metrics["through_throat_mL_per_s_mean"]
                                                     / float(values["boundary.in.flow_mL_per_s"]), 3),
            "grid_cells": int(metrics["cells"]), **flow_runs.made(note)}
    return row, stations, (z, w, z_wall, p - np.interp(32.0, z_wall, p))


def label(study):
    words = [f"{study['cells']} cells", study["convection"]] + ([study["wall"]] if study["wall"] != "interpolated" else [])
    if study["subgrid"] != "none":
        words.append(study["subgrid"])
    if study["wall_convection"] != "as_inside":
        words.append(f"{study['wall_convection']} beside walls")
    return ", ".join(words)


def picture(runs, path):
    figure, axes = plt.subplots(2, 2, figsize=(12, 7.5))
    for across, reynolds in enumerate(FLOW_MM3_PER_S):
        for down, (quantity, name) in enumerate((("centreline_axial_velocity", "velocity on the axis, m/s"),
                                                 ("wall_pressure", "wall pressure over that at z = 32 mm, Pa"))):
            axis = axes[down, across]
            found = laboratories(reynolds, quantity)
            if found is not None:
                z, values = found
                axis.plot(z, values, ".", color="0.7", markersize=4)
                axis.errorbar(z, np.nanmean(values, axis=1), 2 * np.nanstd(values, axis=1, ddof=1), fmt="ks", markersize=3,
                              linewidth=1, capsize=2, label="laboratories: mean, two standard deviations")
            for row, _, lines in runs:
                if row["reynolds"] == reynolds:
                    style = "--" if row["wall_convection"] == "as_inside" else "-"
                    axis.plot(*lines[2 * down:2 * down + 2], style, linewidth=1, label=label(row))
            axis.set(title=f"Re = {reynolds}" if down == 0 else None, xlabel="z, mm", ylabel=name, xlim=(-95, 102))
            axis.grid(alpha=0.3)
            if down == 1:  # where there is room
                axis.legend(fontsize=6.5, loc="upper right")
    figure.tight_layout()
    figure.savefig(path, dpi=80)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--reynolds", type=int, nargs="+", choices=FLOW_MM3_PER_S, default=[])
    parser.add_argument("--cells", type=int, nargs="+", default=[8], help="across the throat")
    parser.add_argument("--convection", default="upwind3")
    parser.add_argument("--wall", default="interpolated")
    parser.add_argument("--subgrid", default="none")
    parser.add_argument("--wall-convection", default="as_inside")
    parser.add_argument("--span", type=float, nargs=2, help="times between which to average, s; otherwise 0.8 1 and 0.15 0.3")
    parser.add_argument("--ranks", type=int, default=1)
    parser.add_argument("--again", action="store_true", help="repeat what is finished")
    parser.add_argument("--docs", type=Path, default=ROOT / "docs")
    asked = parser.parse_args()
    for reynolds in asked.reynolds:
        for cells in asked.cells:
            study = {"reynolds": reynolds, "cells": cells, "convection": asked.convection, "wall": asked.wall,
                     "subgrid": asked.subgrid, "wall_convection": asked.wall_convection}
            folder = RUNS / "-".join(str(v) for v in study.values())
            note = flow_runs.run("fluid-fda-nozzle", folder, values_of(**study, span_s=asked.span or SPAN_S[reynolds]),
                                 asked.ranks, asked.again)
            (folder / "study.json").write_text(json.dumps(note | {"study": study}, indent=1))
    runs = [described(folder, note) for folder, note in flow_runs.finished(
        RUNS, lambda study: (study["reynolds"], study["cells"], study["convection"], study["wall"], study["subgrid"],
                             study["wall_convection"]))]
    if not runs:
        parser.error("no run yet; give --reynolds and --cells")
    for row, _, _ in runs:
        print(f"Re {row['reynolds']}, {label(row)}: inside {row['centreline_axial_velocity_inside']} of velocity, "
              f"{row['wall_pressure_inside']} of pressure; {row['wall_s']:.0f} s")
    source = {key: value for key, value in provenance().items() if key in ("command", "date")}
    write_csv(asked.docs / "results" / "fda-nozzle.csv", [row for row, _, _ in runs], source)
    stations = [row for _, rows, _ in runs for row in rows]
    if stations:
        write_csv(asked.docs / "results" / "fda-nozzle-stations.csv", stations, source)
    picture(runs, asked.docs / "pictures" / "fda-nozzle.png")


if __name__ == "__main__":
    main()
