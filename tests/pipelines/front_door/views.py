"""Every view of a state opens in VTK 9.1, the reader of ParaView 5.11, with the points, cells and fields of the state.

Usage: views.py BUILD_BIN
"""

import json
import os
import subprocess
import sys
import tempfile
from pathlib import Path

from inputs import stent_state

BIN = Path(sys.argv[1]).resolve()


def main():
    import h5py
    from vtkmodules.vtkIOHDF import vtkHDFReader

    failures = []
    with tempfile.TemporaryDirectory() as folder:
        state = stent_state(Path(folder), BIN)
        with h5py.File(state) as file:
            bodies = {name: (len(group["Points"]), len(group["Types"]), sorted(group["PointData"])) for name, group in file["meshes"].items()}
        for body, (points, cells, fields) in bodies.items():
            series = json.loads((state.parent / f"view_{body}.hdf.series").read_text())
            for name in [f"view_{body}.hdf"] + [entry["name"] for entry in series["files"]]:
                reader = vtkHDFReader()
                reader.SetFileName(str(state.parent / name))
                reader.Update()
                grid = reader.GetOutput()
                found = [grid.GetPointData().GetArrayName(i) for i in range(grid.GetPointData().GetNumberOfArrays())]
                if (grid.GetNumberOfPoints(), grid.GetNumberOfCells(), sorted(found)) != (points, cells, fields):
                    failures.append(f"{name}: {grid.GetNumberOfPoints()} points, {grid.GetNumberOfCells()} cells, {found}")
    print("\n".join(failures) or f"{len(bodies)} bodies read")
    return 1 if failures or not bodies else 0


if __name__ == "__main__":
    sys.exit(main())
