"""Draws bodies from their ParaView files: python3 pipelines/draw.py PICTURE.png [options] VIEW.hdf[:FIELD] ...

A view that is given with a field is coloured by it (cell or point data; one scale for all of them); the others are grey.
Options: --from x,y,z (where the eye is, default 0,0,1: from the aorta), --up x,y,z, --range LOW,HIGH, --opacity X (of
the grey ones), --size WIDTH,HEIGHT, --clip x,y,z (cuts the half away to which this points from the bodies' middle),
--title TEXT. Without a display: xvfb-run -a python3 pipelines/draw.py ...
"""

import argparse
from pathlib import Path

import vtk


def numbers(text):
    return [float(word) for word in text.split(",")]


def read(path):
    reader = vtk.vtkHDFReader()
    reader.SetFileName(str(path))
    reader.Update()
    surface = vtk.vtkGeometryFilter()
    surface.SetInputData(reader.GetOutput())
    surface.Update()
    return surface.GetOutput()


def colours(low, high, title):
    table = vtk.vtkColorTransferFunction()
    for share, rgb in ((0, (0.23, 0.30, 0.75)), (0.5, (0.87, 0.87, 0.87)), (1, (0.71, 0.02, 0.15))):
        table.AddRGBPoint(low + share * (high - low), *rgb)
    bar = vtk.vtkScalarBarActor()
    bar.SetLookupTable(table)
    bar.SetTitle(title)
    bar.SetNumberOfLabels(5)
    bar.SetLabelFormat("%.3g")
    bar.SetVerticalTitleSeparation(10)
    bar.UnconstrainedFontSizeOn()
    bar.SetPosition(0.84, 0.1)
    bar.SetWidth(0.1)
    bar.SetHeight(0.8)
    for text in (bar.GetTitleTextProperty(), bar.GetLabelTextProperty()):
        text.SetColor(0, 0, 0)
        text.SetFontSize(14)
        text.ItalicOff()
        text.BoldOff()
        text.ShadowOff()
    return table, bar


def data_of(mesh, field):
    for data, use in ((mesh.GetCellData(), "SetScalarModeToUseCellFieldData"), (mesh.GetPointData(), "SetScalarModeToUsePointFieldData")):
        if data.HasArray(field):
            return data.GetArray(field), use
    known = [mesh.GetCellData().GetArrayName(i) for i in range(mesh.GetCellData().GetNumberOfArrays())]
    known += [mesh.GetPointData().GetArrayName(i) for i in range(mesh.GetPointData().GetNumberOfArrays())]
    raise SystemExit(f"error: no field '{field}'; the view has {', '.join(known)}")


def main():
    parser = argparse.ArgumentParser(usage=__doc__)
    parser.add_argument("picture", type=Path)
    parser.add_argument("views", nargs="+")
    parser.add_argument("--from", dest="eye", type=numbers, default=[0, 0, 1])
    parser.add_argument("--up", type=numbers, default=None)
    parser.add_argument("--range", type=numbers)
    parser.add_argument("--opacity", type=float, default=0.3)
    parser.add_argument("--size", type=numbers, default=[900, 700])
    parser.add_argument("--clip", type=numbers)
    parser.add_argument("--title", default="")
    options = parser.parse_intermixed_args()

    bodies = []
    for view in options.views:
        path, _, field = view.partition(":")
        if not Path(path).is_file():
            raise SystemExit(f"error: {path}: no such file; expected a view_<body>_NNNNNN.hdf of a run")
        bodies.append((read(path), field))
    fields = [data_of(mesh, field)[0].GetRange() for mesh, field in bodies if field]
    low, high = options.range or (min((r[0] for r in fields), default=0), max((r[1] for r in fields), default=1))
    table, bar = colours(low, high, options.title or next((f for _, f in bodies if f), ""))

    renderer = vtk.vtkRenderer()
    renderer.SetBackground(1, 1, 1)
    bounds = vtk.vtkBoundingBox()
    for mesh, _ in bodies:
        bounds.AddBounds(mesh.GetBounds())
    middle = [0.0] * 3
    bounds.GetCenter(middle)
    for mesh, field in bodies:
        mapper = vtk.vtkPolyDataMapper()
        mapper.SetInputData(mesh)
        actor = vtk.vtkActor()
        actor.SetMapper(mapper)
        actor.GetProperty().SetAmbient(0.35)  # steep parts stay readable
        actor.GetProperty().SetDiffuse(0.65)
        if options.clip:
            plane = vtk.vtkPlane()
            plane.SetOrigin(middle)
            plane.SetNormal([-c for c in options.clip])
            mapper.AddClippingPlane(plane)
        if field:
            getattr(mapper, data_of(mesh, field)[1])()
            mapper.SelectColorArray(field)
            mapper.SetLookupTable(table)
        else:
            mapper.ScalarVisibilityOff()
            actor.GetProperty().SetColor(0.6, 0.6, 0.63)
            actor.GetProperty().SetOpacity(options.opacity)
        renderer.AddActor(actor)
    if fields:
        renderer.AddActor2D(bar)
    camera = renderer.GetActiveCamera()
    camera.ParallelProjectionOn()
    camera.SetFocalPoint(middle)
    camera.SetPosition([m + 100 * e for m, e in zip(middle, options.eye)])
    along_axis = abs(options.eye[2]) > 0.9 * sum(e * e for e in options.eye) ** 0.5
    camera.SetViewUp(options.up or ([0, 1, 0] if along_axis else [0, 0, 1]))
    renderer.ResetCamera()
    camera.Zoom(1.3)

    window = vtk.vtkRenderWindow()
    window.SetOffScreenRendering(1)
    window.SetMultiSamples(8)
    window.SetSize(*(int(s) for s in options.size))
    window.AddRenderer(renderer)
    window.Render()
    grab = vtk.vtkWindowToImageFilter()
    grab.SetInput(window)
    writer = vtk.vtkPNGWriter()
    options.picture.parent.mkdir(parents=True, exist_ok=True)
    writer.SetFileName(str(options.picture))
    writer.SetInputConnection(grab.GetOutputPort())
    writer.Write()


if __name__ == "__main__":
    main()
