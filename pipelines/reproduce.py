"""Tables and pictures of the leaflets of a cohort of structural valves: what the pages docs/papers/*.md keep.

    make cohort COHORT=pipelines/cohorts/contact-fsi-2021.csv JOBS=2
    /usr/bin/python3 pipelines/reproduce.py pipelines/cohorts/contact-fsi-2021.csv --body leaflets --grid 32,16 \\
        [--time 0.06] [--pictures docs/pictures/contact-fsi-2021]

Reads the last view of each case (or the one nearest to --time). The regions are those of the leaflet's grid of elements
(--grid: its divisions; every leaflet of the body has the same): attached, the two outer rows at the attachment; belly,
the middle third each way; commissure, the upper fifth of the sides; free edge, the two rows below it. Prints Markdown:
mean von Mises stress and stretch of each region, weighted by the elements' reference areas, and the 99th percentile.
"""

import argparse
import csv
import json
import subprocess
import sys
from pathlib import Path

import numpy as np
import vtk
from vtk.util.numpy_support import vtk_to_numpy


def view_of(folder, body, time_s):
    """The view of a body nearest to a time, or the last."""
    series = json.loads((folder / f"view_{body}.hdf.series").read_text())["files"]
    chosen = series[-1] if time_s is None else min(series, key=lambda entry: abs(entry["time"] - time_s))
    return folder / chosen["name"]


def read(path):
    reader = vtk.vtkHDFReader()
    reader.SetFileName(str(path))
    reader.Update()
    return reader.GetOutput()


def areas(mesh):
    points = vtk_to_numpy(mesh.GetPointData().GetArray("reference"))
    cells = vtk_to_numpy(mesh.GetCells().GetConnectivityArray()).reshape(-1, 3)
    a, b, c = (points[cells[:, k]] for k in range(3))
    return 0.5 * np.linalg.norm(np.cross(b - a, c - a), axis=1)


def regions(count, divisions, half):
    """Element masks by name; two triangles a cell of the grid, copies one after another."""
    n1, n2 = divisions
    cell = np.arange(count) // 2 % (n1 * n2)
    u, v = (cell % n1 + 0.5) / n1, (cell // n1 + 0.5) / n2
    side = (1 - u) if half else np.minimum(u, 1 - u)  # distance from an attached side, in widths of the grid
    rim = np.minimum(side * n1, v * n2) < 2
    middle = u < 1 / 3 if half else np.abs(u - 0.5) < 1 / 6
    return {"belly": middle & (np.abs(v - 0.5) < 1 / 6), "attached": rim & (v < 0.8), "commissure": (side < 0.2) & (v > 0.8),
            "free edge": (v * n2 > n2 - 2) & (side > 0.2)}


def percentile(values, weights, share):
    order = np.argsort(values)
    total = np.cumsum(weights[order])
    return values[order][np.searchsorted(total, share * total[-1])]


def main():
    parser = argparse.ArgumentParser(usage=__doc__)
    parser.add_argument("cohort", type=Path)
    parser.add_argument("--body", required=True)
    parser.add_argument("--grid", required=True)
    parser.add_argument("--half", action="store_true", help="the grid is half of a leaflet, from its middle")
    parser.add_argument("--time", type=float)
    parser.add_argument("--runs", type=Path, default=Path("runs"))
    parser.add_argument("--pictures")
    parser.add_argument("--range")
    parser.add_argument("--beside", default="", help="bodies drawn in grey, with commas")
    options = parser.parse_args()
    divisions = tuple(int(word) for word in options.grid.split(","))
    with open(options.cohort, newline="") as file:
        names = [row["name"] for row in csv.DictReader(line for line in file if not line.startswith("#"))]

    print("| case | quantity | belly | attached | commissure | free edge | 99th percentile | largest |\n|---|---|---|---|---|---|---|---|")
    for name in names:
        folder = options.runs / name / "cycle"
        if not (folder / "summary.json").is_file():
            print(f"error: {folder}: no summary.json; run make cohort COHORT={options.cohort} first", file=sys.stderr)
            sys.exit(2)
        path = view_of(folder, options.body, options.time)
        mesh = read(path)
        weight = areas(mesh)
        masks = regions(len(weight), divisions, options.half)
        for field, label in (("von_mises_kPa", "von Mises stress, kPa"), ("stretch", "largest stretch")):
            values = vtk_to_numpy(mesh.GetCellData().GetArray(field))
            means = [np.average(values[m], weights=weight[m]) for m in masks.values()]
            cells = [f"{x:.4g}" for x in means + [percentile(values, weight, 0.99), values.max()]]
            print(f"| {name} | {label} | " + " | ".join(cells) + " |")
        if options.pictures:
            beside = [str(path).replace(f"view_{options.body}", f"view_{other}") for other in options.beside.split(",") if other]
            words = [f"{options.pictures}-{name}.png", f"{path}:von_mises_kPa", *beside, "--opacity", "1", "--size", "760,560",
                     "--title", "von Mises, kPa"] + (["--range", options.range] if options.range else [])
            for suffix, eye in (("", "0,0,1"), ("-side", "0.4,-1,0.5")):
                words[0] = f"{options.pictures}-{name}{suffix}.png"
                subprocess.run([sys.executable, str(Path(__file__).with_name("draw.py")), *words, "--from", eye], check=True)


if __name__ == "__main__":
    main()
