"""make tradeoff, structural part: error against time over element, mesh, integrator and step.

    python3 pipelines/tradeoff_structure.py [OUT]      needs build/bin/valsalva-cycle; OUT: docs/results

Static: a strip of tissue (10 x 2 x 0.4 mm, neo-Hookean, K/mu = 20), clamped at one end, bent by a dead force at the other
to a third of its length. Errors of the tip's displacement and of the von Mises stress on the upper side a quarter of the
length from the clamp (the corner of the clamp itself is singular), against the finest hex27 mesh. Dynamic: the same strip
let go under a sudden weight, tip at 27 ms, one mesh for all integrators; error against the explicit run with a tenth of
the stable step. Time: that of the whole program (start, mesh, solution, output) on one thread. The plot is over wall time,
which means something on an idle machine only; the CSV has processor time too, which other work disturbs less.
"""

import os
import sys
import time
from pathlib import Path

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt

import structure_runs as runs
import tradeoff

FOLDER = runs.ROOT / "runs" / "tradeoff"
START = time.monotonic()
SHEAR = 3e5
TISSUE = {"law": "neo-hookean", "law_parameters": [f"mu_Pa = {SHEAR:g}"], "density_g_per_mm3": 1.1e-3}
SOLID = dict(TISSUE, volumetric="quadratic", bulk_modulus_kPa=20 * SHEAR / 1e3)
FIRST, SECOND = [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]


def strip(kind, n):
    body = {"name": "strip", "size_mm": [10.0, 2.0]}
    if kind.startswith("shell"):
        body |= dict(TISSUE, kind="shell", shape="plate", divisions=[10 * n, 2 * n], thickness_mm=0.4,
                     origin_mm=[0.0, 0.0, 0.2], shell_element=kind.split()[1])
    elif kind == "beams":
        body |= {"kind": "beams", "shape": "line", "size_mm": [10.0], "divisions": [10 * n], "width_mm": 2.0,
                 "depth_mm": 0.4, "depth_direction": [0.0, 0.0, 1.0], "origin_mm": [0.0, 1.0, 0.2],
                 "young_kPa": 3 * SHEAR / 1e3, "poisson": 0.5, "density_g_per_mm3": 1.1e-3}
    else:
        element, formulation = kind.split()
        quadratic = element in ("tet10", "hex27")
        per = n if quadratic else 2 * n
        body |= dict(SOLID, kind="solid", shape="box", size_mm=[10.0, 2.0, 0.4], element=element,
                     formulation=formulation, divisions=[5 * per, per, max(1, per // 2)])
    scene = {"body": [body],
             "nodes": [{"name": "root", "body": "strip", "select": "group", "group": "start1"},
                       {"name": "tip", "body": "strip", "select": "group", "group": "end1"}],
             "support": [{"name": "clamp", "nodes": "root", "hold": ["all"]}],
             "probe": [{"name": "tip", "of": "tip", "component": "z"}]}
    if kind != "beams":
        scene["probe"].append({"name": "stress", "quantity": "von_mises", "of": "strip", "point_mm": [2.5, 1.0, 0.4]})
    return scene


def static(kind, n):
    scene = strip(kind, n)
    scene["load"] = [{"name": "end", "kind": "force", "nodes": "tip", "force_N": [0.0, 0.0, 1.4e-4],
                      "share": "total" if kind == "beams" else "length" if kind.startswith("shell") else "area"}]
    scene["dynamics"] = {"solver": "static", "load_steps": 2}
    return runs.run(scene, FOLDER / f"static_{kind.replace(' ', '_')}_{n}")


def dynamic(solver, step_s, safety=0.8, radius=0.8):
    scene = strip("hex8 mixed", 1)
    scene["load"] = [{"name": "weight", "kind": "gravity", "acceleration_mm_per_s2": [0.0, 0.0, -1e4]}]
    scene["dynamics"] = {"solver": solver, "end_s": 0.027, "step_s": step_s, "safety": safety, "spectral_radius": radius,
                         "history_rows": 10}
    return runs.run(scene, FOLDER / f"dynamic_{solver}_{step_s:g}_{safety:g}_{radius:g}")


def value(result, name):
    return next((v for key, v in result["last"].items() if key.startswith(name)), None)


SIZES = {"tet4 displacement": (1, 2, 4), "tet4 mixed": (1, 2, 4), "tet10 displacement": (1, 2), "tet10 mixed": (1, 2),
         "hex8 displacement": (1, 2, 4), "hex8 mixed": (1, 2, 4), "hex27 displacement": (1, 2), "hex27 mixed": (1, 2),
         "shell kirchhoff": (1, 2, 4), "shell hinge": (1, 2, 4), "beams": (1, 2, 4)}


def row_of(part, kind, what, result, reference):
    row = {"part": part, "kind": kind, "resolution": what, "exit": result["exit"], "wall_s": round(result["wall_s"], 3),
           "processor_s": round(result["processor_s"], 3), "tip_mm": value(result, "tip"),
           "stress_kPa": value(result, "stress")}
    for key, name in (("tip_mm", "tip_error"), ("stress_kPa", "stress_error")):
        right, found = reference.get(key), row[key]
        row[name] = "" if right is None or found is None else abs(found / right - 1)
    percent = lambda e: f"{100 * e:.2g} %" if e != "" else "-"
    print(f"{time.monotonic() - START:5.0f} s  {part}, {kind}, {what}: exit {row['exit']}, {row['wall_s']:.2f} s, tip "
          f"{percent(row['tip_error'])} off, stress {percent(row['stress_error'])} off", flush=True)
    return row


def static_study(reference=None, kinds=SIZES):
    rows = []
    if reference is None:
        rows.append(row_of("static", "hex27 mixed", "n = 4, reference", static("hex27 mixed", 4), {}))
        reference = rows[0]
    for kind in kinds:
        rows += [row_of("static", kind, f"n = {n}", static(kind, n), reference) for n in SIZES[kind]]
    return rows


def dynamic_study():
    rows = [row_of("dynamic", "explicit", "safety 0.08, reference", dynamic("explicit", 0.0, 0.08), {})]
    for safety in (0.9, 0.4, 0.2):
        rows.append(row_of("dynamic", "explicit", f"safety {safety}", dynamic("explicit", 0.0, safety), rows[0]))
    for radius in (0.8, 1.0):
        for count in (10, 20, 40, 80, 160):
            rows.append(row_of("dynamic", f"implicit, radius {radius}", f"{count} steps",
                               dynamic("implicit", 0.027 / count, radius=radius), rows[0]))
    return rows


def write(rows, out, source):
    runs.write_csv(out / "structure-tradeoff.csv", rows, source)
    figure, axes = plt.subplots(2, 2, figsize=(13, 10))
    for axis, part, error, title in ((axes[0, 0], "static", "tip_error", "static: tip displacement"),
                                     (axes[0, 1], "static", "stress_error", "static: stress at a quarter length"),
                                     (axes[1, 0], "dynamic", "tip_error", "dynamic: tip at 27 ms"),
                                     (axes[1, 1], "dynamic", "stress_error", "dynamic: stress at 27 ms")):
        axis.set_prop_cycle(color=plt.cm.tab20.colors)
        for kind in dict.fromkeys(row["kind"] for row in rows if row["part"] == part):
            line = [(row["wall_s"], row[error]) for row in rows
                    if row["part"] == part and row["kind"] == kind and row[error] not in ("", 0)]
            if line:
                axis.loglog(*zip(*line), "o-", label=kind, markersize=4, linewidth=1)
        axis.set(title=title, xlabel="wall time, s", ylabel="relative error")
        axis.grid(True, which="both", alpha=0.3)
        axis.legend(fontsize=7)
    figure.tight_layout()
    partial = out / "structure-tradeoff.partial.png"
    figure.savefig(partial, dpi=110)
    os.replace(partial, out / "structure-tradeoff.png")
    tradeoff.gather(out)
    print(f"written: {out / 'structure-tradeoff.csv'}, {out / 'structure-tradeoff.png'} after {time.monotonic() - START:.0f} s")


def main():
    source = runs.provenance()
    rows = static_study() + dynamic_study()
    write(rows, Path(sys.argv[1]) if len(sys.argv) > 1 else runs.ROOT / "docs" / "results",
          source)


if __name__ == "__main__":
    main()
