"""What the studies of error against time (tradeoff_structure.py, tradeoff_cycle.py) share: runs/tradeoff/tradeoff.csv and
.png, which hold the rows of all parts, each with the commit and machine it was made on."""

import csv
import os
from pathlib import Path

import structure_runs as runs

RESULTS = runs.ROOT / "docs" / "results"
FIGURES = ["mean_gradient_mmHg", "eoa_cm2", "stroke_volume_mL", "regurgitant_volume_mL", "leaflet_von_mises_p99_kPa"]
COLUMNS = ["part", "scene", "knob", "value", "status", "spacing_mm", "ranks", "steps", "wall_s", "processor_s", *FIGURES, "tip_mm",
           "stress_kPa", "error_pct", "pareto", "commit", "machine", "date"]


def read(path):
    """The rows of a table, and what its first line says about where they come from."""
    if not Path(path).exists():
        return [], {}
    lines = Path(path).read_text().splitlines()
    source = dict(pair.split(": ", 1) for pair in lines[0].lstrip("# ").split("; ") if ": " in pair)
    return list(csv.DictReader(line for line in lines if not line.startswith("#"))), source


def mark_pareto(rows, time="processor_s", error="error_pct"):
    """Within one scene: 'yes' where no other row is at most as dear and nearer to the right value, or cheaper and as near."""
    known = [row for row in rows if row[error] not in ("", None) and row[time] not in ("", None)]
    for row in rows:
        row["pareto"] = ""
    for row in known:
        at = lambda r: (float(r[time]), float(r[error]))
        mine = at(row)
        row["pareto"] = "" if any(at(o) != mine and at(o)[0] <= mine[0] and at(o)[1] <= mine[1] for o in known) else "yes"


def structure_rows(path):
    table, source = read(path)
    rows = [{"scene": f"strip, {row['part']}", "knob": row["kind"], "value": row["resolution"],
             "status": "ok" if row["exit"] == "0" else f"exit {row['exit']}", "ranks": 1, "wall_s": row["wall_s"],
             "processor_s": row["processor_s"], "tip_mm": row["tip_mm"], "stress_kPa": row["stress_kPa"],
             "error_pct": f"{100 * float(row['tip_error']):.4g}" if row["tip_error"] else ""} for row in table]
    for scene in dict.fromkeys(row["scene"] for row in rows):
        mark_pareto([row for row in rows if row["scene"] == scene])
    return [row | {key: source.get(key, "") for key in ("commit", "machine", "date")} for row in rows]


def gather(out=RESULTS, folder=runs.ROOT / "runs" / "tradeoff"):
    """tradeoff.csv and tradeoff.png in the folder, of the tables of both parts that `out` holds."""
    parts = {"structure": structure_rows(out / "structure-tradeoff.csv"), "cycle": read(out / "cycle-tradeoff.csv")[0]}
    rows = [{"part": part} | {key: row.get(key, "") for key in COLUMNS[1:]} for part, table in parts.items() for row in table]
    if not rows:
        return
    runs.write_csv(folder / "tradeoff.csv", rows, {"made by": "make tradeoff", **{
        part: f"{len(table)} rows" for part, table in parts.items()}})
    draw(rows, folder / "tradeoff.png")


def draw(rows, path):
    """Error over processor time, a panel a scene; the Pareto front dashed."""
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    dots = [row for row in rows if row["error_pct"] not in ("", None) and row["processor_s"] not in ("", None)]
    scenes = list(dict.fromkeys(row["scene"] for row in dots))
    if not scenes:
        return
    figure, axes = plt.subplots(1, len(scenes), figsize=(5.5 * len(scenes), 5), squeeze=False)
    for axis, scene in zip(axes[0], scenes):
        axis.set_prop_cycle(color=plt.cm.tab20.colors)
        mine = [row for row in dots if row["scene"] == scene]
        at = lambda row: (max(float(row["processor_s"]), 1e-3), max(float(row["error_pct"]), 1e-4))
        for knob in dict.fromkeys(row["knob"] for row in mine):
            axis.loglog(*zip(*[at(row) for row in mine if row["knob"] == knob]), "o", label=knob, markersize=4)
        for row in mine:
            axis.annotate(row["value"][:16], at(row), fontsize=5)
        if front := sorted(at(row) for row in mine if row["pareto"]):
            axis.loglog(*zip(*front), "k--", linewidth=0.8, label="Pareto front")
        axis.set(title=scene, xlabel="processor time, s", ylabel="error, %")
        axis.grid(True, which="both", alpha=0.3)
        axis.legend(fontsize=5)
    figure.tight_layout()
    partial = path.with_suffix(".partial.png")
    figure.savefig(partial, dpi=110)
    plt.close(figure)
    os.replace(partial, path)
