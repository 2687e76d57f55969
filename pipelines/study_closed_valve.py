"""What a closed valve leaks under 80 mmHg, by grid: leaflets on a device's stent and leaflets clamped to a tube
(pipelines/cases/closed-valve-*.toml). Mean flow over 0.10 to 0.15 s and 0.15 to 0.20 s, after the ringing.

    python3 pipelines/study_closed_valve.py --h 1 0.75
    python3 pipelines/study_closed_valve.py --h 0.5 --ranks 2
    python3 pipelines/study_closed_valve.py                 only writes the table anew from the runs there are

Leaflet edges are 0.46 of a cell. Runs lie in runs/study-closed-valve; docs/results/closed-valve.csv has a row each.
"""

import argparse
import json

import numpy as np

import flow_runs
from structure_runs import ROOT, provenance, write_csv

RUNS = ROOT / "runs" / "study-closed-valve"
WINDOWS = ((0.10, 0.15), (0.15, 0.20))


def values_of(h):
    """The cases' divisions, 50 by 24, are those of h = 1 mm."""
    return {"fluid.spacing_mm": f"{h:g}", "body.leaflets.divisions": f"[{round(50 / h)}, {round(24 / h)}]"}


def described(folder, note):
    history = flow_runs.columns(folder / "history.csv")
    t, leak = history["time_s"], -history["q_mL_per_s"]
    row = dict(note["study"])
    for i, (start, end) in enumerate(WINDOWS):
        inside = (t[1:] >= start) & (t[1:] < end)
        step = np.diff(t)[inside]
        row[f"leak_{'early' if i == 0 else 'late'}_mL_per_s"] = round(float(np.sum(leak[1:][inside] * step) / np.sum(step)), 3)
        row[f"swing_{'early' if i == 0 else 'late'}_mL_per_s"] = round(float(np.ptp(leak[1:][inside])), 3)
    closed = t >= WINDOWS[0][0]
    row |= {"fastest_mm_per_s": round(10 * float(history["max_speed_cm_per_s"][closed].max())),
            "strain_p99": round(float(history["max_principal_strain_p99"][-1]), 4),
            "dt_us": round(1e6 * float(history["dt_s"][closed].mean()), 2), **flow_runs.made(note)}
    return row


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--h", type=float, nargs="+", default=[], metavar="MM")
    parser.add_argument("--held", nargs="+", default=["device", "clamped"], choices=["device", "clamped"])
    parser.add_argument("--ranks", type=int, default=1)
    parser.add_argument("--again", action="store_true", help="repeat what is finished")
    asked = parser.parse_args()
    for h in asked.h:
        for held in asked.held:
            folder = RUNS / f"{held}-{h:g}"
            note = flow_runs.run(f"closed-valve-{held}", folder, values_of(h), asked.ranks, asked.again)
            note["study"] = {"leaflets": held, "h_mm": h}
            (folder / "study.json").write_text(json.dumps(note, indent=1))
    rows = [described(folder, note) for folder, note in flow_runs.finished(RUNS, lambda study: (study["leaflets"], -study["h_mm"]))]
    if not rows:
        parser.error("no run yet; give --h")
    for row in rows:
        print(", ".join(f"{key} {value}" for key, value in row.items() if key not in ("commit", "machine", "load_at_start")))
    write_csv(ROOT / "docs" / "results" / "closed-valve.csv", rows,
              {key: value for key, value in provenance().items() if key in ("command", "date")})


if __name__ == "__main__":
    main()
