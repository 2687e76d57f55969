"""make extremes, structural part: values pushed until accuracy, then the solution, is lost.

    python3 pipelines/extremes_structure.py [OUT] [--only PART ...]     needs build/bin/valsalva-cycle (and -stent, -crimp)

For each value: the exit code (0 solved; 2 refused as input; 3 stopped with the last good state), how far the result is
from a closed form or from the same scene by other means, whether any output holds a NaN, whether a state was left, and
the program's last message: OUT/structure-extremes.csv (docs/results). From these rows, for every series of values: the
last one before the error exceeds 2 %, the last one before the run stops, and how it stops:
OUT/structure-extremes-limits.csv. With --only (names of the functions here) both go to runs/extremes instead.
"""

import json
import math
import subprocess
import sys
import time
from pathlib import Path

import structure_runs as runs
from extremes import FOLDER, Extremes
from tradeoff_structure import SOLID, TISSUE, strip, value

STUDY = Extremes("structure")
note = STUDY.note


def run(scene, name, **options):
    return runs.run(scene, FOLDER / name, **options)


def cube(law, stretch, steps, element="hex8"):
    """A cube pulled along x to a stretch, its other faces free."""
    faces = {"x0": (0, 0.0), "x1": (0, 1.0), "y0": (1, 0.0), "z0": (2, 0.0)}
    return {"body": [dict(law, name="cube", kind="solid", shape="box", size_mm=[1.0, 1.0, 1.0], divisions=[1, 1, 1],
                          element=element)],
            "nodes": [{"name": face, "body": "cube", "select": "plane", "direction": [float(d == axis) for d in range(3)],
                       "point_mm": [at, at, at]} for face, (axis, at) in faces.items()],
            "support": [{"name": "left", "nodes": "x0", "hold": ["x"]}, {"name": "front", "nodes": "y0", "hold": ["y"]},
                        {"name": "floor", "nodes": "z0", "hold": ["z"]},
                        {"name": "pull", "nodes": "x1", "hold": ["x"], "displacement_mm": [stretch - 1, 0.0, 0.0]}],
            "probe": [{"name": "force", "quantity": "reaction", "of": "pull", "component": "x"},
                      {"name": "end", "of": "x1", "component": "x"}],
            "dynamics": {"solver": "static", "load_steps": steps}}


def fibre_strain():
    """W = mu/2 (I1 - 3) + a/2b {exp[b (I4 - 1)^2] - 1}: P = mu (l - l^-2) + 2 a l (I4 - 1) exp[b (I4 - 1)^2]."""
    mu, a, b = 1e4, 1e3, 10.0
    law = {"law": "holzapfel", "law_parameters": [f"mu_Pa = {mu:g}", f"a1_Pa = {a:g}", f"b1 = {b:g}", "a2_Pa = 0",
                                                  "b2 = 1"],
           "volumetric": "quadratic", "bulk_modulus_kPa": 1e6, "fibres": "constant", "fibre_direction": [1.0, 0.0, 0.0],
           "fibre_angles_deg": [0.0, 90.0]}
    last = math.sqrt(1 + math.sqrt(math.log(1e12) / b))
    result = run(cube(law, last, 60), "fibre_strain")
    wanted = [1e1, 1e2, math.exp(6), 1e3, 1e6, 1e12]
    for row in result.get("rows", []):
        stretch = 1 + float(next(v for k, v in row.items() if k.startswith("end")))
        force = float(next(v for k, v in row.items() if k.startswith("force")))
        e = stretch ** 2 - 1
        q = b * e * e
        exact = 1e-6 * (mu * (stretch - stretch ** -2) + 2 * a * stretch * e * math.exp(q))
        if wanted and math.exp(q) >= 0.999 * wanted[0]:
            while wanted and math.exp(q) >= 0.999 * wanted[0]:
                wanted.pop(0)
            note("fibre strain", "fibres of a cube", f"stretch {stretch:.3f}, exp(Q) = {math.exp(q):.2g}", result, abs(force / exact - 1),
                 "force against the law without the cap at Q = 6")
    if result["exit"]:
        note("fibre strain", "fibres of a cube", f"towards {last:.3f}", result)


def stiffness():
    def tip(factor, load):
        scene = strip("hex27 mixed", 1)
        scene["body"][0] |= {"law_parameters": [f"mu_Pa = {3e5 * factor:g}"], "bulk_modulus_kPa": 6000.0 * factor}
        scene["load"] = [{"name": "end", "kind": "force", "nodes": "tip", "force_N": [0.0, 0.0, 1.4e-4 * load],
                          "share": "area"}]
        scene["dynamics"] = {"solver": "static", "load_steps": 2}
        return run(scene, f"stiffness_{factor:g}_{load:g}")

    soft = value(tip(1, 1), "tip")
    for factor in (1e3, 1e6, 1e9):
        result = tip(factor, factor)
        found = value(result, "tip")
        note("stiffness C10", "load too", f"x {factor:g}", result, None if found is None else abs(found / soft - 1),
             "tip against that of the soft strip" if not result["exit"] else "")
    slope = value(tip(1, 1e-3), "tip")
    result = tip(1e3, 1)
    found = value(result, "tip")
    note("stiffness C10", "same load", "x 1000", result, None if found is None else abs(found / slope - 1),
         "tip against the soft strip's at a thousandth of the load" if not result["exit"] else "")


def thickness():
    for share in (1, 0.25, 0.1, 3, 5, 10):
        tips = {}
        for kind in ("hex27 mixed", "shell kirchhoff", "shell hinge"):
            scene = strip(kind, 2)
            body, t = scene["body"][0], 0.4 * share
            if kind.startswith("shell"):
                body |= {"thickness_mm": t, "origin_mm": [0.0, 0.0, t / 2]}
            else:
                body["size_mm"] = [10.0, 2.0, t]
            scene["probe"] = scene["probe"][:1]
            scene["load"] = [{"name": "end", "kind": "force", "nodes": "tip", "force_N": [0.0, 0.0, 1.4e-4 * share ** 3],
                              "share": "length" if kind.startswith("shell") else "area"}]
            scene["dynamics"] = {"solver": "static", "load_steps": 2}
            result = run(scene, f"thickness_{share:g}_{kind.replace(' ', '_')}")
            tips[kind] = value(result, "tip") if result["exit"] == 0 else None
            solid = tips["hex27 mixed"]
            error = None if tips[kind] is None or solid is None or kind == "hex27 mixed" else abs(tips[kind] / solid - 1)
            note("thickness", f"{kind}, {'thinner' if share <= 1 else 'thicker'}", f"{100 * share:g} %", result, error,
                 "tip against hex27, load with the cube" if error is not None else "")


SLIVER_NODES = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)]


def sliver_mesh(path, height):
    """A cube of twelve tetrahedra round an inner node at this height above the floor: two of them are that flat."""
    faces = [(0, 3, 2, 1), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7)]
    cells = []
    for a, b, c, d in faces:
        cells += [(a, c, b, 8), (a, d, c, 8)]
    points = SLIVER_NODES + [(0.5, 0.45, height)]
    lines = ["# vtk DataFile Version 2.0", "slivers", "ASCII", "DATASET UNSTRUCTURED_GRID", f"POINTS {len(points)} double"]
    lines += [" ".join(repr(float(x)) for x in p) for p in points]
    lines += [f"CELLS {len(cells)} {5 * len(cells)}"] + ["4 " + " ".join(map(str, c)) for c in cells]
    lines += [f"CELL_TYPES {len(cells)}"] + ["10"] * len(cells)
    Path(path).parent.mkdir(parents=True, exist_ok=True)
    Path(path).write_text("\n".join(lines) + "\n")


def slivers():
    """Pulled to a stretch of 1.2: homogeneous, so the force is exact on any mesh that can be solved at all."""
    exact = None
    for height in (0.5, 1e-2, 1e-4, 1e-6, 1e-8, 1e-10, 0.0, -0.05):
        scene = cube(SOLID, 1.2, 2)
        name = f"sliver_{height:g}"
        sliver_mesh(FOLDER / name / "mesh.vtk", height)
        scene["body"][0] = dict(SOLID, name="cube", kind="solid", shape="file", file="mesh.vtk", formulation="displacement")
        result = run(scene, name)
        found = value(result, "force")
        exact = exact or found
        note("slivers", "down to reversed, statics", f"height {height:g} of 1", result,
             None if found is None or not exact or result["exit"] else abs(found / exact - 1),
             "force against the regular mesh" if not result["exit"] else "")
        if height >= 1e-6:
            sliver_mesh(FOLDER / (name + "_explicit") / "mesh.vtk", height)
            scene["dynamics"] = {"solver": "explicit", "end_s": 1e-5}
            result = run(scene, name + "_explicit", timeout_s=120)
            note("slivers", "explicit, 10 us", f"height {height:g} of 1", result, None, "" if result["exit"] else "runs")


def inversion():
    """The far face pushed through the near one."""
    for steps in (1, 20):
        result = run(cube(SOLID, -0.5, steps), f"inversion_{steps}")
        reached = value(result, "end")
        note("inverted start", f"pushed through itself in {steps} steps", "to stretch -0.5", result, None,
             f"last state at stretch {1 + reached:.3g}: {result['message']}" if reached is not None else "")


def pressure():
    for law_name, law in {"neo-Hookean": TISSUE,
                          "contact-fsi-2021 fibres": {"material": "contact-fsi-2021/leaflet-fibre",
                                                      "fibres": "constant", "fibre_direction": [1.0, 0.0, 0.0],
                                                      "density_g_per_mm3": 1.1e-3}}.items():
        reached = {}
        for n in (8, 16):
            scene = {"body": [dict(law, name="sheet", kind="shell", shape="plate", size_mm=[5.0, 5.0], divisions=[n, n],
                                   thickness_mm=0.4)],
                     "nodes": [{"name": "rim1", "body": "sheet", "select": "group", "group": "start1"},
                               {"name": "rim2", "body": "sheet", "select": "group", "group": "start2"},
                               {"name": "middle1", "body": "sheet", "select": "group", "group": "end1"},
                               {"name": "middle2", "body": "sheet", "select": "group", "group": "end2"},
                               {"name": "centre", "body": "sheet", "select": "nearest", "point_mm": [5.0, 5.0, 0.0]}],
                     "support": [{"name": "rim1", "nodes": "rim1", "hold": ["x", "y", "z"]},
                                 {"name": "rim2", "nodes": "rim2", "hold": ["x", "y", "z"]},
                                 {"name": "middle1", "nodes": "middle1", "hold": ["symmetry"], "normal": [1.0, 0.0, 0.0]},
                                 {"name": "middle2", "nodes": "middle2", "hold": ["symmetry"], "normal": [0.0, 1.0, 0.0]}],
                     "load": [{"name": "blood", "kind": "pressure", "body": "sheet", "pressure_kPa": 100.0}],
                     "probe": [{"name": "rise", "of": "centre", "component": "z"}],
                     "dynamics": {"solver": "static", "load_steps": 40}}
            result = run(scene, f"pressure_{law_name.split()[0]}_{n}")
            rows = result.get("rows", [])
            reached[n] = {round(100 * float(row["time_s"]), 6): float(row["rise_mm"]) for row in rows
                          if float(row["time_s"]) > 0}
            if n == 8:
                coarse = result
                continue
            done = dict(result, exit=0, message="")  # of the loads that were solved
            for load, fine in reached[16].items():
                if load in (25.0, 37.5, 40.0, 42.5, 50.0, 75.0, 100.0) and load in reached[8]:
                    note("load 750 mmHg", law_name, f"{load:g} kPa", done, abs(reached[8][load] / fine - 1),
                         "rise of 8 x 8 against 16 x 16")
            for result in (coarse, result):
                if result["exit"]:
                    note("load 750 mmHg", law_name, "towards 100 kPa", result)


def struts():
    for gap in (1.0, 1e-3, 1e-6, 1e-9, 0.0):
        name = f"strut_{gap:g}"
        points = [(0.0, 0.0, 0.0), (5.0, 0.0, 0.0), (5.0 + gap, 0.0, 0.0), (10.0, 0.0, 0.0)]
        lines = ["# vtk DataFile Version 2.0", "struts", "ASCII", "DATASET UNSTRUCTURED_GRID", "POINTS 4 double"]
        lines += [" ".join(map(repr, p)) for p in points] + ["CELLS 3 9", "2 0 1", "2 1 2", "2 2 3", "CELL_TYPES 3"]
        path = FOLDER / name / "mesh.vtk"
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text("\n".join(lines + ["3", "3", "3"]) + "\n")
        scene = {"body": [{"name": "frame", "kind": "beams", "shape": "file", "file": "mesh.vtk", "width_mm": 0.4,
                           "depth_mm": 0.3, "young_kPa": 6e7, "poisson": 0.3, "density_g_per_mm3": 6.45e-3}],
                 "nodes": [{"name": "root", "body": "frame", "select": "numbers", "numbers": [0]},
                           {"name": "tip", "body": "frame", "select": "numbers", "numbers": [3]}],
                 "support": [{"name": "clamp", "nodes": "root", "hold": ["all"]}],
                 "load": [{"name": "end", "kind": "force", "nodes": "tip", "force_N": [0.0, 0.0, 1e-3]}],
                 "probe": [{"name": "tip", "of": "tip", "component": "z"}],
                 "dynamics": {"solver": "static", "load_steps": 1}}
        result = run(scene, name)
        found = value(result, "tip")
        exact = 1e3 * 1e3 / (3 * 6e10 * 0.4 * 0.3 ** 3 / 12)  # P L^3/3EI, uN, mm, Pa
        note("zero-length strut", "in a beam of 10 mm", f"{gap:g} mm", result, None if found is None else abs(found / exact - 1),
             "tip against P L^3/3EI" if not result["exit"] else "")


def time_step():
    def let_go(dynamics, name):
        scene = strip("hex8 mixed", 1)
        scene["load"] = [{"name": "weight", "kind": "gravity", "acceleration_mm_per_s2": [0.0, 0.0, -1e4]}]
        scene["dynamics"] = dict(dynamics, end_s=0.027, history_rows=10)
        return run(scene, name)

    right = let_go({"solver": "explicit"}, "step_reference")
    tip = value(right, "tip")
    note("time step", None, "explicit, stable", right, 0.0, "reference")
    stable = 2.6e-6  # of this mesh, found by the first refusal's message if it differs
    for factor in (10, 100, 1000):
        for label, dynamics in {
                "explicit": {"solver": "explicit", "step_s": factor * stable},
                "explicit, masses scaled": {"solver": "explicit", "step_s": factor * stable, "mass_scaling": True},
                "implicit": {"solver": "implicit", "step_s": factor * stable}}.items():
            result = let_go(dynamics, f"step_{label.replace(', ', '_').replace(' ', '_')}_{factor}")
            found = value(result, "tip")
            note("time step", label, f"{factor} x stable", result,
                 None if found is None or result["exit"] else abs(found / tip - 1),
                 "tip at 27 ms against the stable explicit run" if not result["exit"] else "")


def crimp():
    """The smallest device of the tests, crimped to ever smaller diameters."""
    case = runs.ROOT / "tests" / "stages" / "chain" / "small.toml"
    build = runs.BIN
    subprocess.run([build / "valsalva-stent", case, "--out", FOLDER / "stent"], check=True, stdout=subprocess.DEVNULL)
    state = max((FOLDER / "stent").glob("state_*.h5"))
    for diameter in (8.0, 5.7, 4.0):
        out = FOLDER / f"crimp_{diameter:g}"
        start = time.monotonic()
        done = subprocess.run([build / "valsalva-crimp", case, "--from", state, "--out", out, "--set",
                               f"crimp.diameter_mm={diameter:g}"], stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                              text=True)
        summary = out / "summary.json"
        text = summary.read_text() if summary.exists() else "{}"
        checks = json.loads(text).get("checks", {})
        failed = "; ".join(f"{name} = {check['value']:.3g} (limit {check['limit']:.3g})" for name, check in checks.items()
                           if not check["pass"])
        result = {"exit": done.returncode, "nan": "nan" in text.lower(), "processor_s": time.monotonic() - start,
                  "state": any(out.glob("state_*.h5")), "message": done.stdout.strip()[-300:]}
        note("crimp", "smallest device of the tests", f"{diameter:g} mm", result, None,
             "" if done.returncode else f"failed checks: {failed}" if failed else "all checks hold")


def main():
    words = sys.argv[1:]
    only = words[words.index("--only") + 1:] if "--only" in words else []
    words = words[:words.index("--only")] if "--only" in words else words
    out = FOLDER if only else Path(words[0]) if words else runs.ROOT / "docs" / "results"
    source = runs.provenance()
    start = time.monotonic()
    parts = (fibre_strain, stiffness, thickness, slivers, inversion, pressure, struts, time_step, crimp)
    for part in parts:
        if only and part.__name__ not in only:
            continue
        print(f"{part.__name__} ({time.monotonic() - start:.0f} s since the start)", flush=True)
        part()
    if not STUDY.rows:
        sys.exit(f"error: no part is called {' or '.join(only)}; expected {', '.join(part.__name__ for part in parts)}")
    STUDY.write(out, source)
    print(f"all: {time.monotonic() - start:.0f} s")


if __name__ == "__main__":
    main()
