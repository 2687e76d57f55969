"""Tables and figures of a cohort of valves in a flow: what the pages docs/papers/*.md keep.

    make cohort COHORT=pipelines/cohorts/leaflet-flutter-2022.csv
    /usr/bin/python3 pipelines/reproduce_flow.py pipelines/cohorts/leaflet-flutter-2022.csv --window 0.1,0.3 \\
        [--start 0.03] [--until 0.255] [--planes -1,13] [--band 30,200] [--times 0.23,0.24,0.25,0.26] [--columns q_mL_per_s] [--flow] \\
        [--pictures docs/pictures/x]

Reads history.csv and the frames in the newest state of each case's cycle. Times are those of the beat, which begins at
--start (cycle.initialisation_s). Prints Markdown:

  flow      over the forward flow around its peak, as common/metrics/beat.hpp: mean and largest pressure difference (of
            history.csv: 3 mm inside both ends), EOA = Q_rms / (51.6 sqrt(mean difference / rho)), stroke volume, largest
            orifice; efficiency = energy out / energy in, over all of the beat that was run (said in the table), or
            of it until --until
  spectrum  within --window, of the pressure difference between the two --planes (on the line y = 0, from frames), of the
            orifice and of the radius of the leaflets' tips (the liveliest): quadratic trend removed, Hann window, as
            common/metrics/flutter.hpp. Root mean square within --band, its strongest line, and how much the second half
            of the window swings against the first (growth: above 1 it builds up)
  strain    largest principal Green-Lagrange strain of the middle surface beside the tip of leaflet 1, mean over the window

A case that was not run is said to be missing. --pictures PREFIX: PREFIX-course.png (courses and spectra),
PREFIX-edges.png (free edges from above at --times), with --columns a,b PREFIX-beat.png (these columns of history.csv),
with --flow PREFIX-flow.png (axial velocity in the plane y = 0 at --times, the leaflets' nodes near it).
"""

import argparse
import csv
import sys
from pathlib import Path

import h5py
import numpy as np

from reproduce import Table

MMHG_PER_RHO = 51.6  # mL/s, mmHg, g/cm3, cm2


class Run:
    """One case: rows of the beat, and frames (leaflets, pressure in the plane y = 0)."""

    def __init__(self, folder, start_s, until_s):
        self.table = Table(folder / "history.csv")
        time_s = self.table.column("time_s") - start_s
        self.beat = (time_s >= 0) & (time_s <= until_s)
        self.time_s = time_s[self.beat]
        self.frames = None
        states = sorted(folder.glob("state_*.h5"))
        if not states:
            return
        with h5py.File(states[-1]) as file:
            mesh = file["meshes/leaflets"]
            self.cells = mesh["Connectivity"][:].reshape(-1, 3)
            self.reference, self.attached = mesh["PointData/reference"][:], mesh["PointData/attached"][:]
            self.leaflet = mesh["CellData/leaflet"][:]
            if "frames" not in file["restart"]:
                return
            frames = file["restart/frames"]
            self.frames = frames["time_s"][:] - start_s
            self.points = frames["leaflet_points"][:]
            self.pressure = frames["slice_pressure_mmHg"][:]
            self.velocity = frames["slice_velocity_mm_per_s"][:]
            self.origin, self.spacing = frames["slice_origin_mm"][:], frames["slice_spacing_mm"][:]

    def column(self, name):
        return self.table.column(name)[self.beat]

    def difference(self):
        return self.column("p_lvot_mmHg") - self.column("p_ao_mmHg")

    def between(self, planes, radius=8.0):
        """Mean pressures on |x| < radius of two heights, upstream minus downstream, at each frame."""
        x = self.origin[0] + self.spacing[0] * np.arange(self.pressure.shape[2])
        rows = [int(round((z - self.origin[2]) / self.spacing[2])) for z in planes]
        upstream, downstream = (self.pressure[:, row, np.abs(x) < radius].mean(axis=1) for row in rows)
        return upstream - downstream

    def tips(self):
        return [np.hypot(self.column(f"tip{i}_x_mm"), self.column(f"tip{i}_y_mm")) for i in (1, 2, 3)]

    def free_edges(self, frame):
        """Segments of the border that are not attached, seen from above: pairs of points."""
        sides = np.sort(np.concatenate([self.cells[:, [0, 1]], self.cells[:, [1, 2]], self.cells[:, [2, 0]]]), axis=1)
        edges, count = np.unique(sides, axis=0, return_counts=True)
        free = edges[(count == 1) & ~(self.attached[edges].astype(bool).all(axis=1))]
        return self.points[frame][free][:, :, :2]

    def tip_strain(self, leaflet=0):
        """Largest principal Green-Lagrange strain in the plane, over the triangles round the middle of the free edge."""
        own = np.unique(self.cells[self.leaflet == leaflet])
        fixed = own[self.attached[own] == 1]
        border = np.unique(self.free_nodes())
        border = border[np.isin(border, own)]
        away = [np.linalg.norm(self.reference[fixed] - self.reference[a], axis=1).min() for a in border]
        near = self.cells[(self.cells == border[int(np.argmax(away))]).any(axis=1)]
        a, b, c = (self.reference[near[:, k]] for k in range(3))
        first = (b - a) / np.linalg.norm(b - a, axis=1)[:, None]
        normal = np.cross(b - a, c - a)
        second = np.cross(normal / np.linalg.norm(normal, axis=1)[:, None], first)
        local = np.stack([np.stack([((q - a) * e).sum(axis=1) for q in (b, c)], axis=1) for e in (first, second)], axis=1)
        inverse = np.linalg.inv(local)
        strains = []
        for x in self.points:
            edges = np.stack([x[near[:, 1]] - x[near[:, 0]], x[near[:, 2]] - x[near[:, 0]]], axis=2)
            gradient = edges @ inverse
            strain = 0.5 * (np.transpose(gradient, (0, 2, 1)) @ gradient - np.eye(2))
            strains.append(np.linalg.eigvalsh(strain)[:, 1].mean())
        return np.array(strains)

    def free_nodes(self):
        sides = np.sort(np.concatenate([self.cells[:, [0, 1]], self.cells[:, [1, 2]], self.cells[:, [2, 0]]]), axis=1)
        edges, count = np.unique(sides, axis=0, return_counts=True)
        nodes = np.unique(edges[count == 1])
        return nodes[self.attached[nodes] == 0]


def even(time_s, signal, window, samples=512):
    at = np.linspace(*window, samples, endpoint=False)
    values = np.interp(at, time_s, signal)
    s = np.linspace(-1, 1, samples, endpoint=False)
    return at, values - np.polyval(np.polyfit(s, values, 2), s)


def spectrum(time_s, signal, window):
    """Frequencies, amplitudes of the lines, and the window's power."""
    at, values = even(time_s, signal, window)
    hann = 0.5 - 0.5 * np.cos(2 * np.pi * np.arange(len(values)) / len(values))
    lines = np.fft.rfft(values * hann) / len(values)
    return np.arange(len(lines)) / (window[1] - window[0]), 2 * np.abs(lines), (hann**2).mean()


def swing(time_s, signal, window, band):
    """Root mean square in the band, the strongest line there, growth between the halves of the window."""
    if time_s[-1] < window[1] - 0.01:
        return None
    frequency, amplitude, power = spectrum(time_s, signal, window)
    inside = (frequency >= band[0]) & (frequency <= band[1])
    middle = 0.5 * (window[0] + window[1])
    halves = []
    for part in ((window[0], middle), (middle, window[1])):
        f, a, w = spectrum(time_s, signal, part)
        halves.append(np.sqrt((a[(f >= band[0]) & (f <= band[1])] ** 2).sum() / 2 / w))
    return np.sqrt((amplitude[inside] ** 2).sum() / 2 / power), frequency[inside][np.argmax(amplitude[inside])], halves[1] / halves[0]


def flow_figures(run, density=1.0):
    q, dp, t = run.column("q_mL_per_s"), run.difference(), run.time_s
    peak = int(np.argmax(q))
    backward = np.nonzero(q <= 0)[0]
    first = backward[backward < peak].max() + 1 if (backward < peak).any() else 0
    last = backward[backward > peak].min() if (backward > peak).any() else len(q)
    part = slice(first, last)
    q, dp, s = q[part], dp[part], t[part]
    positive = (dp > 0).astype(float)
    length = np.trapz(positive, s)
    mean = np.trapz(positive * dp, s) / length
    rms = np.sqrt(np.trapz(positive * q**2, s) / length)
    entered, left = (np.trapz(run.column(f"power_{way}_mW"), t) for way in ("in", "out"))
    return {"mean difference, mmHg": mean, "largest, mmHg": dp.max(), "peak flow, mL/s": q.max(),
            "stroke volume, mL": np.trapz(q, s), "EOA, cm2": rms / (MMHG_PER_RHO * np.sqrt(mean / density)),
            "largest orifice, cm2": run.column("orifice_cm2").max(), "opens, s": s[0], "closes, s": s[-1],
            "efficiency, %": 100 * left / entered, "run to, s": t[-1]}


def text(values):
    return " | ".join("-" if x is None else f"{x:.4g}" for x in values)


def signals(run, options):
    tips = run.tips()
    tip_swings = [swing(run.time_s, tip, options.window, options.band) for tip in tips]
    liveliest = 0 if tip_swings[0] is None else int(np.argmax([s[0] for s in tip_swings]))
    chosen = {"orifice, cm2": (run.time_s, run.column("orifice_cm2")), "tip radius, mm": (run.time_s, tips[liveliest])}
    if run.frames is not None:
        chosen = {"pressure difference, mmHg": (run.frames, run.between(options.planes)), **chosen}
    return chosen


def draw(runs, options):
    import matplotlib

    matplotlib.use("Agg")
    from matplotlib import pyplot
    from matplotlib.collections import LineCollection

    names = list(signals(next(iter(runs.values())), options))
    figure, axes = pyplot.subplots(len(names), 2, figsize=(11, 2.8 * len(names)), squeeze=False)
    for number, (case, run) in enumerate(runs.items()):
        colour = f"C{number}"
        for row, (name, (t, values)) in enumerate(signals(run, options).items()):
            axes[row][0].plot(t, values, lw=0.9, color=colour, label=case)
            axes[row][0].set_ylabel(name)
            if t[-1] >= options.window[1] - 0.01:
                f, a, _ = spectrum(t, values, options.window)
                axes[row][1].plot(f, a, lw=0.9, color=colour, label=case)
            axes[row][1].set_xlim(0, options.band[1])
    axes[0][0].legend(fontsize=7)
    axes[-1][0].set_xlabel("time in the beat, s")
    axes[-1][1].set_xlabel(f"frequency, Hz, of {options.window[0]} to {options.window[1]} s")
    figure.tight_layout()
    figure.savefig(f"{options.pictures}-course.png", dpi=110)

    columns = [name for name in options.columns.split(",") if name]
    if columns:
        figure, axes = pyplot.subplots(len(columns), 1, figsize=(7, 2 * len(columns)), sharex=True, squeeze=False)
        for case, run in runs.items():
            for (axis,), name in zip(axes, columns):
                axis.plot(run.time_s, run.column(name), lw=0.9, label=case)
                axis.set_ylabel(name, fontsize=8)
        axes[0][0].legend(fontsize=7)
        axes[-1][0].set_xlabel("time in the beat, s")
        figure.tight_layout()
        figure.savefig(f"{options.pictures}-beat.png", dpi=110)

    drawn = {case: run for case, run in runs.items() if run.frames is not None}
    if not drawn or not options.times:
        return
    figure, axes = pyplot.subplots(len(drawn), len(options.times), figsize=(2.2 * len(options.times), 2.3 * len(drawn)), squeeze=False)
    for row, (case, run) in zip(axes, drawn.items()):
        rim = np.hypot(*run.reference[run.attached == 1][:, :2].T).max()
        for axis, time_s in zip(row, options.times):
            axis.set_aspect("equal")
            axis.set_axis_off()
            axis.set_xlim(-1.05 * rim, 1.05 * rim)
            axis.set_ylim(-1.05 * rim, 1.05 * rim)
            axis.add_patch(pyplot.Circle((0, 0), rim, fill=False, lw=0.5, color="0.6"))
            axis.set_title(f"{case}, {time_s:g} s", fontsize=7)
            if run.frames[-1] < time_s - 0.01:
                continue
            frame = int(np.argmin(np.abs(run.frames - time_s)))
            axis.add_collection(LineCollection(run.free_edges(frame), lw=1.2, colors="tab:red"))
    figure.tight_layout()
    figure.savefig(f"{options.pictures}-edges.png", dpi=110)
    if not options.flow:
        return
    fastest = max(np.abs(run.velocity[..., 2]).max() for run in drawn.values()) / 1000
    figure, axes = pyplot.subplots(len(drawn), len(options.times), figsize=(1.5 * len(options.times), 4 * len(drawn)), squeeze=False)
    for row, (case, run) in zip(axes, drawn.items()):
        x, z = (run.origin[d] + run.spacing[d] * np.array([-0.5, n - 0.5]) for d, n in ((0, run.velocity.shape[2]), (2, run.velocity.shape[1])))
        for axis, time_s in zip(row, options.times):
            axis.set_axis_off()
            axis.set_title(f"{case}, {time_s:g} s", fontsize=7)
            if run.frames[-1] < time_s - 0.01:
                continue
            frame = int(np.argmin(np.abs(run.frames - time_s)))
            axis.imshow(run.velocity[frame, :, :, 2] / 1000, origin="lower", extent=(*x, *z), cmap="RdBu_r", vmin=-fastest, vmax=fastest)
            near = np.abs(run.points[frame][:, 1]) < 0.6
            axis.plot(*run.points[frame][near][:, [0, 2]].T, ".", ms=1.2, color="k")
    figure.suptitle(f"axial velocity in the plane y = 0, red forward, to {fastest:.1f} m/s", fontsize=8)
    figure.tight_layout()
    figure.savefig(f"{options.pictures}-flow.png", dpi=110)


def numbers(words):
    return tuple(float(word) for word in words.split(","))


def main():
    parser = argparse.ArgumentParser(usage=__doc__)
    parser.add_argument("cohort", type=Path)
    parser.add_argument("--runs", type=Path, default=Path("runs"))
    parser.add_argument("--start", type=float, default=0.03)
    parser.add_argument("--until", type=float, default=np.inf)
    parser.add_argument("--window", type=numbers, default=(0.1, 0.3))
    parser.add_argument("--planes", type=numbers, default=(-1.0, 13.0))
    parser.add_argument("--band", type=numbers, default=(30.0, 200.0))
    parser.add_argument("--times", type=numbers, default=())
    parser.add_argument("--columns", default="")
    parser.add_argument("--flow", action="store_true")
    parser.add_argument("--pictures")
    options = parser.parse_args()
    with open(options.cohort, newline="") as file:
        names = [row["name"] for row in csv.DictReader(line for line in file if not line.startswith("#"))]
    runs = {}
    for name in names:
        folder = options.runs / name / "cycle"
        if (folder / "history.csv").is_file():
            runs[name] = Run(folder, options.start, options.until)
        else:
            print(f"{name}: not run ({folder} has no history.csv)\n")
    if not runs:
        print(f"error: nothing to read; run make cohort COHORT={options.cohort} first", file=sys.stderr)
        sys.exit(2)
    figures = {name: flow_figures(run) for name, run in runs.items()}
    heads = list(next(iter(figures.values())))
    print("| case | " + " | ".join(heads) + " |\n|" + "---|" * (1 + len(heads)))
    for name, values in figures.items():
        print(f"| {name} | {text(values.values())} |")
    print("\n| case | signal | swing, rms | strongest, Hz | growth |\n|---|---|---|---|---|")
    for name, run in runs.items():
        for signal, (t, values) in signals(run, options).items():
            print(f"| {name} | {signal} | {text(swing(t, values, options.window, options.band) or (None,) * 3)} |")
    print("\n| case | strain beside the tip |\n|---|---|")
    for name, run in runs.items():
        if run.frames is not None and run.frames[-1] >= options.window[1] - 0.01:
            inside = (run.frames >= options.window[0]) & (run.frames <= options.window[1])
            print(f"| {name} | {text([run.tip_strain()[inside].mean()])} |")
    if options.pictures:
        draw(runs, options)


if __name__ == "__main__":
    main()
