"""Draws tensors as spheres of 16 x 16 faces with VTK (python3-vtk9). See scene_files.run for the command line."""

import json
from pathlib import Path

import numpy as np
import vtk
from vtk.util.numpy_support import numpy_to_vtk

import scene_files
import vtk_window

FACES = 16


class GlyphScene(scene_files.View):
    """Centres, tensors whose eigenvalues are the semi-axes, and colours in linear light."""

    def __init__(self, description: Path):
        super().__init__(json.loads(description.read_text()))
        numbers = np.fromfile(description.with_suffix(".bin")).reshape(-1, 15)
        self.centres, self.tensors, self.colors = numbers[:, :3], numbers[:, 3:12], numbers[:, 12:]


def data_of(scene):
    points = vtk.vtkPoints()
    points.SetData(numpy_to_vtk(np.ascontiguousarray(scene.centres), deep=1))
    data = vtk.vtkPolyData()
    data.SetPoints(points)
    data.GetPointData().SetTensors(numpy_to_vtk(np.ascontiguousarray(scene.tensors), deep=1))
    data.GetPointData().SetScalars(numpy_to_vtk(np.arange(len(scene.centres), dtype=np.float32), deep=1))
    return data


def glyphs_of(scene):
    sphere = vtk.vtkSphereSource()
    sphere.SetRadius(1)
    sphere.SetThetaResolution(FACES)
    sphere.SetPhiResolution(FACES)
    glyphs = vtk.vtkTensorGlyph()
    glyphs.SetInputData(data_of(scene))
    glyphs.SetSourceConnection(sphere.GetOutputPort())
    glyphs.SetScaleFactor(1)
    glyphs.ClampScalingOff()
    glyphs.ColorGlyphsOn()
    glyphs.SetColorModeToScalars()
    return glyphs


def mapper_of(scene):
    table = vtk.vtkLookupTable()
    table.SetNumberOfTableValues(len(scene.colors))
    for i, color in enumerate(scene.colors):
        table.SetTableValue(i, *color)
    glyphs = glyphs_of(scene)  # a port alone does not keep it
    mapper = vtk.vtkPolyDataMapper()
    mapper.SetInputConnection(glyphs.GetOutputPort())
    mapper.SetLookupTable(table)
    mapper.SetScalarRange(0, len(scene.colors) - 1)
    return mapper


def tensor_glyphs(scene):
    actor = vtk.vtkActor()
    actor.SetMapper(mapper_of(scene))
    actor.GetProperty().SetAmbient(0.1)
    actor.GetProperty().SetDiffuse(0.9)
    render = vtk_window.drawing(scene, actor)

    def draw():
        light = render() / 255
        codes = np.where(light <= 0.0031308, 12.92 * light, 1.055 * np.power(light, 1 / 2.4) - 0.055)
        return np.round(255 * codes).astype(np.uint8)

    return draw


if __name__ == "__main__":
    scene_files.run({"vtk tensor glyphs": tensor_glyphs}, GlyphScene)
