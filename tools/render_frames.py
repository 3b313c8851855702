"""Runs inside pvpython for floe render: draws the frames of a job, a JSON file that it writes."""
import json
import math
import sys

from paraview import simple as pv

# Height above the water [m], red, green, blue: dark keels, pale sails.
ICE = [-3.0, 0.05, 0.16, 0.30, -0.5, 0.20, 0.45, 0.62, -0.05, 0.62, 0.78, 0.88, 0.05, 0.86, 0.92,
       0.96,
       0.6, 0.97, 0.98, 1.0, 3.0, 1.0, 0.97, 0.90]
GREY, BLUE = [0.45, 0.43, 0.41], [0.25, 0.5, 0.7]


def polygons(points, faces):
    """A source of flat polygons."""
    source = pv.ProgrammableSource(OutputDataSetType="vtkPolyData")
    source.Script = f"""
import vtk
points, cells = vtk.vtkPoints(), vtk.vtkCellArray()
for p in {points}: points.InsertNextPoint(p)
for face in {faces}:
    cells.InsertNextCell(len(face))
    for v in face: cells.InsertCellPoint(v)
self.GetOutput().SetPoints(points)
self.GetOutput().SetPolys(cells)
"""
    return source


def place_camera(view, job):
    """Parallel projection: lengths across the view are true."""
    azimuth, elevation = (math.radians(a) for a in job["view"])
    far = 10 * job["extent"]
    towards = (math.cos(elevation) * math.cos(azimuth), math.cos(elevation) * math.sin(azimuth),
               math.sin(elevation))
    view.CameraFocalPoint = job["centre"]
    view.CameraPosition = [c + far * t for c, t in zip(job["centre"], towards)]
    view.CameraViewUp = [0, 0, 1] if abs(elevation) < 1.5 else [0, 1, 0]
    view.CameraParallelProjection = 1
    view.CameraParallelScale = 0.5 * job["extent"] * job["size"][1] / job["size"][0]
    return towards


def colour(display, job):
    """Bodies by their height above the water, or by their displacement in z."""
    if job["colour"] == "height":
        pv.ColorBy(display, ("POINTS", "height"))
        table = pv.GetColorTransferFunction("height")
        table.RGBPoints = ICE
        if job["range"]:
            table.RescaleTransferFunction(*job["range"])
        return
    pv.ColorBy(display, ("CELLS", "face_displacement", "Z"))
    table = pv.GetColorTransferFunction("face_displacement")
    table.ApplyPreset("Cool to Warm (Extended)", True)
    if job["range"]:
        table.RescaleTransferFunction(*job["range"])


def show_bodies(job, view):
    """Shows the bodies; the filter that gives them their height above the water."""
    reader = pv.OpenDataFile(job["fields"])
    height = pv.Calculator(Input=pv.ExtractSurface(Input=bodies_of(reader)))
    height.AttributeType = "Point Data"
    height.ResultArrayName = "height"
    height.Function = "coordsZ"
    display = pv.Show(height, view)
    display.SetRepresentationType("Surface With Edges")
    display.EdgeColor = [0.25, 0.33, 0.4]
    display.LineWidth = 0.5
    colour(display, job)
    display.SetScalarBarVisibility(view, False)
    return height


def bodies_of(reader):
    """The blocks with a cell datum `body`: the reader forgets the grids' names."""
    reader.UpdatePipeline()
    bodies = pv.Threshold(Input=reader)
    bodies.Scalars = ["CELLS", "body"]
    bodies.ThresholdMethod = "Above Upper Threshold"
    bodies.UpperThreshold = -0.5
    return bodies


def show_surroundings(job, view, towards):
    """Water level and obstacles; the displays of obstacles that move, with their places."""
    moving = []
    for o in job["obstacles"]:
        display = pv.Show(polygons(o["points"], o["faces"]), view)
        display.SetRepresentationType("Surface")
        display.DiffuseColor = display.AmbientColor = GREY
        if o["plane"]:
            a, b, c = o["points"][:3]
            u, w = ([q - p for p, q in zip(a, end)] for end in (b, c))
            normal = (u[1] * w[2] - u[2] * w[1], u[2] * w[0] - u[0] * w[2],
                      u[0] * w[1] - u[1] * w[0])
            # It would hide the ice. (math.fsum: ParaView puts a sum of its own in the place of
            # Python's.)
            behind = math.fsum(n * t for n, t in zip(normal, towards)) < 0
            display.Opacity = 0.12 if behind else 0.6
        if o["placements"]:
            moving.append((display, o["placements"]))
    if job["water"]:
        low, high = job["low"], job["high"]
        level = [[low[0], low[1], 0], [high[0], low[1], 0], [high[0], high[1], 0],
                 [low[0], high[1], 0]]
        display = pv.Show(polygons(level, [[0, 1, 2, 3]]), view)
        display.SetRepresentationType("Surface")
        display.DiffuseColor = display.AmbientColor = BLUE
        display.Opacity = 0.3
        if job["levels"]:
            moving.append((display, [[[0, 0, z], [0, 0, 0]] for z in job["levels"]]))
    return moving


def main():
    with open(sys.argv[1]) as file:
        job = json.load(file)
    view = pv.CreateView("RenderView")
    view.ViewSize = job["size"]
    view.UseColorPaletteForBackground = 0
    view.Background = [1, 1, 1]
    view.OrientationAxesVisibility = 0
    view.UseLight = 1
    height = show_bodies(job, view)
    towards = place_camera(view, job)
    moving = show_surroundings(job, view, towards)
    for k, (time, file) in enumerate(zip(job["times"], job["files"])):
        view.ViewTime = time
        for display, placements in moving:
            display.Position, display.Orientation = placements[k]
        if job["levels"]:
            height.Function = f"coordsZ - ({job['levels'][k]})"
        pv.SaveScreenshot(file, view, ImageResolution=job["size"], OverrideColorPalette="",
                          CompressionLevel="9")


main()
