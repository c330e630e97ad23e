"""Draws volumes with the ray casters of VTK (python3-vtk9). See scene_files.run for the command line."""

import numpy as np
import vtk

import scene_files
import vtk_window

READERS = {".nrrd": vtk.vtkNrrdReader, ".mhd": vtk.vtkMetaImageReader, ".vtk": vtk.vtkStructuredPointsReader,
           ".vti": vtk.vtkXMLImageDataReader}
SAMPLES = 2  # along a ray, for each spacing of the grid
PIECES = 32  # of the opacity between two points of a transfer function
LARGEST_DEPTH = 16  # optical depth of one spacing at opacity 1


def image_of(scene):
    reader = READERS[scene.grid.suffix]()
    reader.SetFileName(str(scene.grid))
    reader.Update()
    return reader.GetOutput()


def opacities_between(below, above):
    """Values and opacities from one point to the next. VTK's are linear in the opacity, ours in the extinction."""
    value = np.linspace(below["value"], above["value"], PIECES + 1)
    depths = [-np.log1p(-min(point["opacity"], 1 - np.exp(-LARGEST_DEPTH))) for point in (below, above)]
    return zip(value, -np.expm1(-np.linspace(*depths, PIECES + 1)))


def property_of(scene):
    colors, opacities = vtk.vtkColorTransferFunction(), vtk.vtkPiecewiseFunction()
    for point in scene.transfer:
        colors.AddRGBPoint(point["value"], *point["color"])
        opacities.AddPoint(point["value"], point["opacity"])
    for below, above in zip(scene.transfer, scene.transfer[1:]):
        for value, opacity in opacities_between(below, above):
            opacities.AddPoint(value, opacity)
    look = vtk.vtkVolumeProperty()
    look.SetColor(colors)
    look.SetScalarOpacity(opacities)
    look.SetScalarOpacityUnitDistance(scene.spacing)
    look.SetInterpolationTypeToLinear()
    look.ShadeOff()
    return look


def drawing(scene, mapper, samples):
    image = image_of(scene)
    mapper.SetInputData(image)
    mapper.SetBlendModeToComposite()
    mapper.SetAutoAdjustSampleDistances(0)
    mapper.SetSampleDistance(min(image.GetSpacing()) / samples)
    volume = vtk.vtkVolume()
    volume.SetMapper(mapper)
    volume.SetProperty(property_of(scene))
    return vtk_window.drawing(scene, volume)


def fixed_point(scene, samples=SAMPLES):
    mapper = vtk.vtkFixedPointVolumeRayCastMapper()
    mapper.SetImageSampleDistance(1)
    mapper.SetNumberOfThreads(2)
    return drawing(scene, mapper, samples)


def gpu(scene, samples=SAMPLES):
    mapper = vtk.vtkOpenGLGPUVolumeRayCastMapper()
    mapper.SetImageSampleDistance(1)
    return drawing(scene, mapper, samples)


if __name__ == "__main__":
    scene_files.run({"vtk fixed point": fixed_point, "vtk gpu": gpu}, scene_files.VolumeScene)
