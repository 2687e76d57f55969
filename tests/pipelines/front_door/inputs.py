"""Makes the damaged files that bad_inputs.py feeds to the programs, in a folder; returns name -> path."""

import math
import os
import struct
import subprocess

STENT_CASE = """[device]
frame = "cylinder"
size_mm = 10
tissue = false
"""


def nrrd(values, spacing):
    size = round(len(values) ** (1 / 3))
    vectors = " ".join(f"({spacing if d == 0 else 0},{spacing if d == 1 else 0},{spacing if d == 2 else 0})" for d in range(3))
    header = (f"NRRD0004\ntype: float\ndimension: 3\nspace: left-posterior-superior\nsizes: {size} {size} {size}\n"
              f"space directions: {vectors}\nkinds: domain domain domain\nendian: little\nencoding: raw\n"
              f"space origin: (0,0,0)\n\n")
    return header.encode() + struct.pack(f"<{len(values)}f", *values)


def stent_state(folder, binaries):
    """A real state of the stent stage, small."""
    (folder / "stent.toml").write_text(STENT_CASE)
    environment = dict(os.environ, OMPI_ALLOW_RUN_AS_ROOT="1", OMPI_ALLOW_RUN_AS_ROOT_CONFIRM="1")
    subprocess.run([str(binaries / "valsalva-stent"), "stent.toml", "--out", "stent", "--quiet"], cwd=folder, env=environment, check=True)
    return sorted((folder / "stent").glob("state_*.h5"))[-1]


def make_inputs(folder, binaries):
    # h5py of Debian; the programs' own test machine has it through python3-vtk9's packages or python3-h5py.
    import h5py
    import numpy

    paths = {"folder": folder}

    def file(key, name, content):
        path = folder / name
        path.write_bytes(content if isinstance(content, bytes) else content.encode())
        paths[key] = path

    size = 16
    blank = [0.0] * size**3
    file("blank_nrrd", "blank.nrrd", nrrd(blank, 1.0))
    file("cut_nrrd", "cut.nrrd", nrrd(blank, 1.0)[:-6000])
    file("zero_spacing_nrrd", "zero.nrrd", nrrd(blank, 0.0))
    file("nan_nrrd", "nan.nrrd", nrrd([math.nan] * size**3, 1.0))
    file("text_nrrd", "text.nrrd", "this is no image\n")
    file("text_json", "text.json", "this is no graph\n")
    file("text_h5", "text.h5", "this is no state\n")
    file("empty_stl", "empty.stl", "solid nothing\nendsolid nothing\n")
    with h5py.File(folder / "other.h5", "w") as other:
        other["numbers"] = [1.0, 2.0]
    paths["other_h5"] = folder / "other.h5"

    good = stent_state(folder, binaries).read_bytes()
    file("stent_state", "stent_state.h5", good)
    file("cut_state", "cut_state.h5", good[: len(good) // 2])

    def changed(key, change):
        file(key, f"{key}.h5", good)
        with h5py.File(paths[key], "r+") as state:
            change(state)

    def set_attribute(name, value):
        return lambda state: state.attrs.modify(name, value)

    def rename_stage(state):
        state.attrs["stage"] = numpy.bytes_("segment")

    def remove_frame(state):
        del state["meshes/frame"]

    def spoil_frame(state):
        state["meshes/frame/Points"][0, 0] = math.nan

    changed("segment_state", rename_stage)
    changed("unfinished_stent_state", set_attribute("final", 0))
    changed("stent_state_without_frame", remove_frame)
    changed("stent_state_with_nan", spoil_frame)
    return paths
