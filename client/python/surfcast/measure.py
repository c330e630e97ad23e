"""Measurements of points in world coordinates. Lengths are in units of the scan, angles in degrees."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Union

import numpy as np
import numpy.typing as npt

from ._values import Hit, Vector
from .errors import InvalidInput

Place = Union[Hit, Vector]


def _place(place: Place) -> npt.NDArray[np.float64]:
    position: Any = place.position if isinstance(place, Hit) else place
    point = np.asarray(position, dtype=np.float64)
    if point.shape != (3,):
        raise InvalidInput(f"expected three coordinates, got {position!r}")
    return point


def distance(a: Place, b: Place) -> float:
    """The length of the straight line between two places."""
    return float(np.linalg.norm(_place(b) - _place(a)))


def length(places: Sequence[Place]) -> float:
    """The length of a line through places."""
    return sum(distance(a, b) for a, b in zip(places, places[1:]))


def height(a: Place, b: Place, *, z_up: bool = True) -> float:
    """How much higher `b` is than `a`, along the vertical axis: z, or y."""
    axis = 2 if z_up else 1
    return float(_place(b)[axis] - _place(a)[axis])


def angle(a: Place, corner: Place, b: Place) -> float:
    """The angle at `corner` between the lines to `a` and to `b`, from 0 to 180 degrees."""
    u, v = _place(a) - _place(corner), _place(b) - _place(corner)
    if not u.any() or not v.any():
        raise InvalidInput("an angle needs three different places")
    # By the tangent: the cosine loses half of the digits near 0 and 180 degrees.
    return float(np.degrees(np.arctan2(np.linalg.norm(np.cross(u, v)), np.dot(u, v))))


def area(places: Sequence[Place]) -> float:
    """The area of a polygon. Of one that is not plane, that of its projection along its mean normal (Newell's)."""
    points = np.array([_place(place) for place in places])
    if len(points) < 3:
        raise InvalidInput("an area needs three places")
    # Relative to the first place, so that coordinates of a country do not cost digits.
    local = points - points[0]
    normal: npt.NDArray[np.float64] = np.cross(local, np.roll(local, -1, axis=0)).sum(axis=0)
    return float(np.linalg.norm(normal) / 2)
