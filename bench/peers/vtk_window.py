"""A window of VTK without a screen, which draws one scene."""

import numpy as np
import vtk
from vtk.util.numpy_support import vtk_to_numpy


def drawing(scene, prop):
    """A function that draws the prop with the camera of the scene and returns the picture, rows from top to bottom."""
    renderer = vtk.vtkRenderer()
    renderer.AddViewProp(prop)
    camera = renderer.GetActiveCamera()
    camera.SetPosition(*scene.position)
    camera.SetFocalPoint(*scene.focal_point)
    camera.SetViewUp(*scene.view_up)
    camera.SetViewAngle(scene.view_angle)
    renderer.ResetCameraClippingRange()
    window = vtk.vtkRenderWindow()
    window.SetOffScreenRendering(1)
    window.SetMultiSamples(0)
    window.SetSize(scene.width, scene.height)
    window.AddRenderer(renderer)

    def draw():
        window.Render()
        pixels = vtk.vtkUnsignedCharArray()
        window.GetPixelData(0, 0, scene.width - 1, scene.height - 1, 0, pixels, 0)
        return np.flipud(vtk_to_numpy(pixels).reshape(scene.height, scene.width, 3))

    return draw
