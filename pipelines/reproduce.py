"""Tables and pictures of the leaflets of a cohort of structural valves: what the pages docs/papers/*.md keep.

    make cohort COHORT=pipelines/cohorts/contact-fsi-2021.csv JOBS=2
    /usr/bin/python3 pipelines/reproduce.py pipelines/cohorts/contact-fsi-2021.csv --body leaflets --grid 20,10 \\
        [--time 0.0198] [--valve 3,12,0.3] [--columns post_deflection_mm] [--course free_edge_radius_mm,0.0198] [--pictures docs/pictures/x]

Reads the last view of each case (or the one nearest to --time). The regions are those of the leaflet's grid of elements
(--grid: its divisions; every leaflet of the body has the same): attached, the two (--rows) outer rows at the attachment; belly,
the middle third each way; commissure, the upper fifth of the sides; free edge, the two rows below it. Prints Markdown:
mean von Mises stress and stretch of each region, weighted by the elements' reference areas, and the 99th percentile.
--valve LEAFLETS,RADIUS,DISTANCE adds what the leaflets do together: the orifice, as common/metrics/orifice.hpp defines
it, in a tube of that radius about the z axis, with the bodies --beside in the way; the coaptation, the area of all
leaflets whose elements' middles are nearer to another leaflet than 1.2 times the distance at which they meet. --columns
adds columns of history.csv at that time; --course COLUMN,TIME the times that a column takes for nine tenths of its way
from the start to that time (opening) and from there to the end (closing).
"""

import argparse
import csv
import json
import subprocess
import sys
from pathlib import Path

import numpy as np
import vtk
from scipy import ndimage
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


def regions(count, divisions, half, rows):
    """Element masks by name; two triangles a cell of the grid, copies one after another."""
    n1, n2 = divisions
    cell = np.arange(count) // 2 % (n1 * n2)
    u, v = (cell % n1 + 0.5) / n1, (cell // n1 + 0.5) / n2
    side = (1 - u) if half else np.minimum(u, 1 - u)  # distance from an attached side, in widths of the grid
    rim = np.minimum(side * n1, v * n2) < rows
    middle = u < 1 / 3 if half else np.abs(u - 0.5) < 1 / 6
    return {"belly": middle & (np.abs(v - 0.5) < 1 / 6), "attached": rim & (v < 0.8), "commissure": (side < 0.2) & (v > 0.8),
            "free edge": (v * n2 > n2 - 2) & (side > 0.2)}


def percentile(values, weights, share):
    order = np.argsort(values)
    total = np.cumsum(weights[order])
    return values[order][np.searchsorted(total, share * total[-1])]


def triangles_of(mesh):
    return vtk_to_numpy(mesh.GetPoints().GetData())[vtk_to_numpy(mesh.GetCells().GetConnectivityArray()).reshape(-1, 3)]


def orifice(triangles, radius, pixel=0.05):
    """Area that is seen through along z and is connected with the inner third of the tube, mm2."""
    count = int(np.ceil(radius / pixel))
    axis = (np.arange(-count, count) + 0.5) * pixel
    x, y = np.meshgrid(axis, axis, indexing="ij")
    free = x**2 + y**2 < radius**2
    for a, b, c in triangles[:, :, :2]:
        low, high = (np.searchsorted(axis, np.array(f(f(a, b), c))) for f in (np.minimum, np.maximum))
        part = (slice(low[0], high[0]), slice(low[1], high[1]))
        u, v, w = ((q[0] - p[0]) * (y[part] - p[1]) - (q[1] - p[1]) * (x[part] - p[0]) for p, q in ((a, b), (b, c), (c, a)))
        free[part] &= ~(((u >= 0) & (v >= 0) & (w >= 0)) | ((u <= 0) & (v <= 0) & (w <= 0)))
    pieces, _ = ndimage.label(free)
    seen = np.unique(pieces[free & (x**2 + y**2 < (radius / 3) ** 2)])
    return np.isin(pieces, seen[seen > 0]).sum() * pixel**2


def coaptation(triangles, leaflets, distance):
    """Area of all leaflets that is nearer to another one than the distance, mm2."""
    own = np.arange(len(triangles)) * leaflets // len(triangles)
    touching = 0.0
    for leaflet in range(leaflets):
        points, cells = vtk.vtkPoints(), vtk.vtkCellArray()
        for corners in triangles[own != leaflet]:
            cells.InsertNextCell(3, [points.InsertNextPoint(corner) for corner in corners])
        others = vtk.vtkPolyData()
        others.SetPoints(points)
        others.SetPolys(cells)
        locator = vtk.vtkCellLocator()
        locator.SetDataSet(others)
        locator.BuildLocator()
        nearest, cell, part, square = [0.0] * 3, vtk.reference(0), vtk.reference(0), vtk.reference(0.0)
        for a, b, c in triangles[own == leaflet]:
            locator.FindClosestPoint((a + b + c) / 3, nearest, cell, part, square)
            if float(square) < distance**2:
                touching += 0.5 * np.linalg.norm(np.cross(b - a, c - a))
    return touching


class Table:
    """A history.csv; time None is its end."""

    def __init__(self, path):
        with open(path, newline="") as file:
            rows = list(csv.DictReader(file))
        self.path = path
        self.columns = {name: np.array([float(row[name]) for row in rows]) for name in rows[0]}

    def column(self, name):
        if name not in self.columns:
            sys.exit(f"error: {self.path}: no column '{name}'; it has {', '.join(self.columns)}")
        return self.columns[name]

    def row_at(self, time_s):
        return -1 if time_s is None else int(np.argmin(np.abs(self.column("time_s") - time_s)))

    def way_s(self, name, begin, end, share=0.9):
        """How long a column takes for a share of its way between two rows."""
        values, time_s = self.column(name)[begin:end], self.column("time_s")[begin:end]
        done = (values - values[0]) / (values[-1] - values[0])
        return time_s[np.argmax(done >= share)] - time_s[0]


def together(names, options):
    """The table of what is not one element's: orifice, coaptation, columns and course of the history."""
    columns = options.columns.split(",") if options.columns else []
    heads = ["orifice, mm2", "coaptation, mm2"] + columns + ["opening, ms", "closing, ms"] * bool(options.course)
    print("\n| case | " + " | ".join(heads) + " |\n|" + "---|" * (1 + len(heads)))
    for name in names:
        folder = options.runs / name / "cycle"
        triangles = triangles_of(read(view_of(folder, options.body, options.time)))
        beside = [triangles_of(read(view_of(folder, other, options.time))) for other in options.beside.split(",") if other]
        leaflets, radius, distance = options.valve
        values = [orifice(np.concatenate([triangles, *beside]), radius), coaptation(triangles, int(leaflets), 1.2 * distance)]
        history = Table(folder / "history.csv")
        values += [history.column(column)[history.row_at(options.time)] for column in columns]
        if options.course:
            column, time_s = options.course.split(",")
            turn = history.row_at(float(time_s))
            values += [1e3 * history.way_s(column, 0, turn + 1), 1e3 * history.way_s(column, turn, None)]
        print(f"| {name} | " + " | ".join(f"{x:.4g}" for x in values) + " |")


def main():
    parser = argparse.ArgumentParser(usage=__doc__)
    parser.add_argument("cohort", type=Path)
    parser.add_argument("--body", required=True)
    parser.add_argument("--grid", required=True)
    parser.add_argument("--half", action="store_true", help="the grid is half of a leaflet, from its middle")
    parser.add_argument("--rows", type=int, default=2, help="of elements that count as attached")
    parser.add_argument("--time", type=float)
    parser.add_argument("--valve", type=lambda text: [float(word) for word in text.split(",")])
    parser.add_argument("--columns", default="")
    parser.add_argument("--course")
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
        masks = regions(len(weight), divisions, options.half, options.rows)
        for fields, label in (({"von_mises_kPa": 1, "von_mises_Pa": 1e-3}, "von Mises stress, kPa"),
                              ({"stretch": 1, "stretch_major": 1}, "largest stretch")):
            field = next(name for name in fields if mesh.GetCellData().HasArray(name))  # of a scene, or of a beat
            values = fields[field] * vtk_to_numpy(mesh.GetCellData().GetArray(field))
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
    if options.valve:
        together(names, options)


if __name__ == "__main__":
    main()
