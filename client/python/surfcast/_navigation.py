"""Cameras that turn, move and approach. Lengths of gestures are in pixels of the view."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import numpy.typing as npt

from ._values import Camera, Vector

_V = npt.NDArray[np.float64]
# The view stays upright: no nearer to the vertical axis than this, radians.
_STEEPEST = math.radians(0.5)
_TURN_OF_HEIGHT = math.pi  # a drag over the height of the view turns by this angle
_VIEW_ANGLE = 30.0


def _unit(v: _V) -> _V:
    unit: _V = v / np.linalg.norm(v)
    return unit


def _frame(camera: Camera, vertical: Vector) -> tuple[_V, _V, _V, _V]:
    """The arm from the focal point to the eye, the vertical axis, and right and up in the picture."""
    arm = np.asarray(camera.position, dtype=np.float64) - np.asarray(camera.focal_point)
    axis = _unit(np.asarray(vertical, dtype=np.float64))
    across: _V = np.cross(axis, arm)
    if not across.any():
        across = np.cross(axis, (axis[1], axis[2], axis[0]))
    right = _unit(across)
    return arm, axis, right, np.cross(_unit(arm), right)


def _with(camera: Camera, focal_point: _V, arm: _V) -> Camera:
    return Camera(focal_point + arm, focal_point, camera.view_up, camera.view_angle)


def _turned(v: _V, axis: _V, angle: float) -> _V:
    """Rodrigues' rotation of `v` around a unit axis."""
    along: Any = axis * np.dot(axis, v)
    turned: _V = along + math.cos(angle) * (v - along) + math.sin(angle) * np.cross(axis, v)
    return turned


def orbit(camera: Camera, vertical: Vector, dx: float, dy: float, height: float) -> Camera:
    """Turns around the focal point: the model follows a drag by (dx, dy)."""
    arm, axis, right, _ = _frame(camera, vertical)
    steepness = math.acos(float(np.clip(np.dot(_unit(arm), axis), -1, 1)))  # from the vertical axis
    wanted = float(np.clip(steepness - dy / height * _TURN_OF_HEIGHT, _STEEPEST, math.pi - _STEEPEST))
    arm = _turned(arm, right, wanted - steepness)
    arm = _turned(arm, axis, -dx / height * _TURN_OF_HEIGHT)
    return _with(camera, np.asarray(camera.focal_point, dtype=np.float64), arm)


def pan(camera: Camera, vertical: Vector, dx: float, dy: float, height: float) -> Camera:
    """Moves eye and focal point, so that the focal point follows a drag by (dx, dy)."""
    arm, _, right, up = _frame(camera, vertical)
    angle = math.radians(camera.view_angle or _VIEW_ANGLE)
    pixel = 2 * float(np.linalg.norm(arm)) * math.tan(angle / 2) / height
    return _with(camera, np.asarray(camera.focal_point) + pixel * (dy * up - dx * right), arm)


def zoom(camera: Camera, factor: float) -> Camera:
    """Brings the focal point nearer by a factor."""
    focal_point = np.asarray(camera.focal_point, dtype=np.float64)
    return _with(camera, focal_point, (np.asarray(camera.position) - focal_point) / factor)


def focus(camera: Camera, place: Vector) -> Camera:
    """Looks at another place, from the same side and distance."""
    arm = np.asarray(camera.position, dtype=np.float64) - np.asarray(camera.focal_point)
    return _with(camera, np.asarray(place, dtype=np.float64), arm)
