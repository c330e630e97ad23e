"""Draws scenes with Open3D's visualizer (python3-open3d) in a window of X. See scene_files.run for the command line."""

import numpy as np
import open3d

import scene_files


def extrinsic(scene):
    """World to camera: x right, y down, z forward."""
    forward = scene.focal_point - scene.position
    forward = forward / np.linalg.norm(forward)
    right = np.cross(forward, scene.view_up)
    right = right / np.linalg.norm(right)
    matrix = np.eye(4)
    matrix[:3, :3] = [right, np.cross(forward, right), forward]
    matrix[:3, 3] = -matrix[:3, :3] @ scene.position
    return matrix


def points(scene):
    cloud = open3d.geometry.PointCloud(open3d.utility.Vector3dVector(scene.positions))
    cloud.colors = open3d.utility.Vector3dVector(scene.colors / 255.0)
    window = open3d.visualization.Visualizer()
    window.create_window(width=scene.width, height=scene.height, visible=False)
    window.add_geometry(cloud)
    options = window.get_render_option()
    options.background_color = np.zeros(3)
    options.light_on = False
    options.point_size = max(1.0, 2 * scene.radius_in_pixels())
    eta = scene.height / (2 * np.tan(np.radians(scene.view_angle) / 2))
    parameters = open3d.camera.PinholeCameraParameters()
    parameters.intrinsic = open3d.camera.PinholeCameraIntrinsic(
        scene.width, scene.height, eta, eta, 0.5 * scene.width - 0.5, 0.5 * scene.height - 0.5)
    parameters.extrinsic = extrinsic(scene)
    window.get_view_control().convert_from_pinhole_camera_parameters(parameters, allow_arbitrary=True)

    def draw():
        window.poll_events()
        window.update_renderer()
        return np.round(255 * np.asarray(window.capture_screen_float_buffer(do_render=True)))

    return draw


if __name__ == "__main__":
    scene_files.run({"open3d points": points})
