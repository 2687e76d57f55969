#!/usr/bin/python3
"""Draws docs/pictures/materials.png: stress against stretch of all published sets, each curve up to the stretch where an
exponent reaches 6 (beyond it the laws are continued by a parabola), and prints the table of docs/materials.md.

  python3 pipelines/materials/figure.py [--out docs/pictures/materials.png] [--program build/bin/valsalva-material]
"""

import argparse
import csv
import subprocess
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent.parent
PANELS = (("uniaxial1", "cauchy1_Pa", "pulled along direction 1 (fibres)"),
          ("uniaxial2", "cauchy2_Pa", "pulled along direction 2 (across)"),
          ("equibiaxial", "cauchy1_Pa", "equibiaxial, stress along direction 1"),
          ("equibiaxial", "cauchy2_Pa", "equibiaxial, stress along direction 2"))
LARGEST_EXPONENT = 6.0


def curve(program, name, test, to, points):
    words = [program, "--set", name, "--test", test, "--to", str(to), "--points", str(points)]
    done = subprocess.run(words, capture_output=True, text=True, check=True)
    return list(csv.DictReader(done.stdout.splitlines()))


def set_names(program):
    lines = subprocess.run([program, "--sets"], capture_output=True, text=True, check=True).stdout.splitlines()
    return [line for line in lines if line and not line.startswith(" ")]


def draw(program, names, out):
    import matplotlib
    matplotlib.use("Agg")
    import matplotlib.pyplot as plt
    papers = sorted({name.split("/")[0] for name in names})
    colours = dict(zip(papers, ("tab:blue", "tab:red", "tab:green", "tab:purple", "tab:orange")))
    strokes = ("-", "--", "-.", ":", (0, (1, 3)))
    figure, axes = plt.subplots(2, 2, figsize=(13, 8), sharex=True, sharey=True)
    for (test, column, title), panel in zip(PANELS, axes.flat):
        used = dict.fromkeys(papers, 0)
        for name in names:
            paper = name.split("/")[0]
            stretch = "stretch2" if test == "uniaxial2" else "stretch1"
            rows = [r for r in curve(program, name, test, 1.25, 126) if float(r["exponent"]) <= LARGEST_EXPONENT][1:]
            panel.plot([float(r[stretch]) for r in rows], [float(r[column]) / 1e3 for r in rows], color=colours[paper],
                       linestyle=strokes[used[paper] % len(strokes)], label=name)
            used[paper] += 1
        panel.set_title(title, fontsize=10)
        panel.set_yscale("log")
        panel.set_ylim(0.1, 2e4)
        panel.grid(alpha=0.3)
    for panel in axes[1]:
        panel.set_xlabel("stretch")
    for panel in axes[:, 0]:
        panel.set_ylabel("Cauchy stress, kPa")
    handles, labels = axes[0, 0].get_legend_handles_labels()
    figure.tight_layout(rect=(0, 0, 0.74, 1))
    figure.legend(handles, labels, loc="center right", fontsize=8)
    figure.savefig(out, dpi=100, metadata={"Software": None})


def print_table(program, names):
    """Small-strain moduli, and Cauchy stress at a stretch of 1.1."""
    print("| set | E1 kPa | E2 kPa | uniaxial 1 kPa | uniaxial 2 kPa | equibiaxial kPa |")
    print("|---|---|---|---|---|---|")
    for name in names:
        small = 1e-5
        e1 = float(curve(program, name, "uniaxial1", 1 + small, 2)[1]["cauchy1_Pa"]) / small / 1e3
        e2 = float(curve(program, name, "uniaxial2", 1 + small, 2)[1]["cauchy2_Pa"]) / small / 1e3
        one, two, both = (curve(program, name, test, 1.1, 2)[1] for test in ("uniaxial1", "uniaxial2", "equibiaxial"))
        mark = lambda row, column: f"{float(row[column]) / 1e3:.3g}" + ("*" if float(row["exponent"]) > LARGEST_EXPONENT else "")
        print(f"| `{name}` | {e1:.3g} | {e2:.3g} | {mark(one, 'cauchy1_Pa')} | {mark(two, 'cauchy2_Pa')} | "
              f"{mark(both, 'cauchy1_Pa')} / {mark(both, 'cauchy2_Pa')} |")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--out", default=str(ROOT / "docs/pictures/materials.png"))
    parser.add_argument("--program", default=str(ROOT / "build/bin/valsalva-material"))
    options = parser.parse_args()
    names = set_names(options.program)
    draw(options.program, names, options.out)
    print_table(options.program, names)


if __name__ == "__main__":
    main()
