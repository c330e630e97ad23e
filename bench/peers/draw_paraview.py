"""Draws scenes with ParaView's representation "Point Gaussian" (pvpython). See scene_files.run for the command line."""

import numpy as np
from paraview import simple
from paraview.vtk.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkCommonCore import vtkUnsignedCharArray

import scene_files
from draw_vtk import SIGMA, point_data


def gaussians(scene):
    simple.ResetSession()
    source = simple.TrivialProducer()
    source.GetClientSideObject().SetOutput(point_data(scene))
    view = simple.CreateRenderView()
    view.ViewSize = [scene.width, scene.height]
    view.OrientationAxesVisibility = 0
    view.UseColorPaletteForBackground = 0
    view.Background = [0, 0, 0]
    display = simple.Show(source, view)
    display.SetRepresentationType("Point Gaussian")
    display.GaussianRadius = SIGMA
    display.ScaleByArray = 1
    display.SetScaleArray = ["POINTS", "radius"]
    display.UseScaleFunction = 0
    display.ShaderPreset = "Gaussian Blur"
    display.ColorArrayName = ["POINTS", "color"]
    display.MapScalars = 0
    display.Ambient, display.Diffuse = 1, 0
    view.CameraPosition = list(scene.position)
    view.CameraFocalPoint = list(scene.focal_point)
    view.CameraViewUp = list(scene.view_up)
    view.CameraViewAngle = scene.view_angle
    window = view.GetRenderWindow()

    def draw():
        simple.Render(view)
        pixels = vtkUnsignedCharArray()
        window.GetPixelData(0, 0, scene.width - 1, scene.height - 1, 0, pixels, 0)
        return np.flipud(vtk_to_numpy(pixels).reshape(scene.height, scene.width, 3))

    return draw


if __name__ == "__main__":
    scene_files.run({"paraview gaussians": gaussians})
