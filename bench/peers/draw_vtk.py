"""Draws scenes with VTK (python3-vtk9). See scene_files.run for the command line."""

import numpy as np
import vtk
from vtk.util.numpy_support import numpy_to_vtk

import scene_files
import vtk_window

# The standard deviation of a Gaussian in radii of the scan: half a spacing.
SIGMA = 0.46
# An opaque disc that faces the eye. The quad reaches three units to each side (vtkPointGaussianMapper).
DISC = """//VTK::Color::Impl
float distance2 = dot(offsetVCVSOutput.xy, offsetVCVSOutput.xy);
if (distance2 > 1.0) { discard; }
"""


def point_data(scene):
    points = vtk.vtkPoints()
    points.SetData(numpy_to_vtk(np.ascontiguousarray(scene.positions, np.float32), deep=True))
    data = vtk.vtkPolyData()
    data.SetPoints(points)
    count = len(scene.positions)
    cells = vtk.vtkCellArray()
    ids = np.arange(count, dtype=np.int64)
    cells.SetData(numpy_to_vtk(np.arange(count + 1, dtype=np.int64), deep=True), numpy_to_vtk(ids, deep=True))
    data.SetVerts(cells)
    colors = numpy_to_vtk(np.ascontiguousarray(scene.colors), deep=True)
    colors.SetName("color")
    data.GetPointData().SetScalars(colors)
    radii = numpy_to_vtk(np.ascontiguousarray(scene.radii), deep=True)
    radii.SetName("radius")
    data.GetPointData().AddArray(radii)
    return data


def drawing(scene, mapper, set_up=lambda actor: None):
    mapper.SetInputData(point_data(scene))
    actor = vtk.vtkActor()
    actor.SetMapper(mapper)
    actor.GetProperty().LightingOff()
    set_up(actor)
    return vtk_window.drawing(scene, actor)


def points(scene):
    width = max(1.0, 2 * scene.radius_in_pixels())
    return drawing(scene, vtk.vtkPolyDataMapper(), lambda actor: actor.GetProperty().SetPointSize(width))


def gaussian_mapper(scale):
    mapper = vtk.vtkPointGaussianMapper()
    mapper.SetScaleArray("radius")
    mapper.SetScaleFactor(scale)
    mapper.EmissiveOff()
    return mapper


def gaussians(scene):
    return drawing(scene, gaussian_mapper(SIGMA), lambda actor: actor.ForceTranslucentOn())


def discs(scene):
    mapper = gaussian_mapper(1.0)
    mapper.SetSplatShaderCode(DISC)
    return drawing(scene, mapper, lambda actor: actor.ForceOpaqueOn())


if __name__ == "__main__":
    scene_files.run({"vtk points": points, "vtk gaussians": gaussians, "vtk discs": discs})
