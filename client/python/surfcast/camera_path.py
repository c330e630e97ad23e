"""Camera paths: the cameras of the frames of a film, as `surfcast render --path` computes them."""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass
from os import PathLike
from pathlib import Path
from typing import Any

from ._values import Camera, SavedView
from .errors import InvalidInput

_V = tuple[float, ...]

SECONDS_PER_VIEW = 4.0  # the default of `--view-seconds`


def _sum(a: float, u: _V, b: float, v: _V) -> _V:
    return tuple(a * x + b * y for x, y in zip(u, v))


def _dot(u: _V, v: _V) -> float:
    return u[0] * v[0] + u[1] * v[1] + u[2] * v[2]


def _length(v: _V) -> float:
    return math.sqrt(_dot(v, v))


def _unit(v: _V) -> _V:
    size = _length(v)
    return _sum(1 / size, v, 0, v) if size > 0 else v


def _velocity(before: _V, time_before: float, after: _V, time_after: float) -> _V:
    """The velocity at the middle of three values: the slope of the parabola through them.

    It is at most three times the lower one of the mean speeds on either side, so that nothing overshoots.
    """
    share = time_before / (time_before + time_after)
    mean = _sum(1 - share, before, share, after)
    most = 3 * min(_length(before), _length(after))
    size = _length(mean)
    return _sum(most / size, mean, 0, mean) if size > most else mean


def _turn(a: _V, b: _V, t: float) -> _V:
    """Spherical interpolation of unit vectors. The axis between opposite ones is arbitrary."""
    angle = math.acos(min(max(_dot(a, b), -1.0), 1.0))
    if angle < 1e-6:
        return a
    if math.sin(angle) < 1e-6:
        aside = (1.0, 0.0, 0.0) if abs(a[0]) < 0.7 else (0.0, 1.0, 0.0)
        across = _unit(_sum(1, aside, -_dot(aside, a), a))
        return _sum(math.cos(angle * t), a, math.sin(angle * t), across)
    return _sum(math.sin((1 - t) * angle) / math.sin(angle), a, math.sin(t * angle) / math.sin(angle), b)


def _upright(up: _V, view: _V) -> _V:
    """The part of `up` across the view direction; `up` itself if they are parallel."""
    along = _unit(view)
    part = _sum(1, up, -_dot(up, along), along)
    return _unit(part) if _length(part) > 1e-9 else up


def _camera_of(view: SavedView) -> Camera:
    """The camera of a view; 30 degrees where it has no view angle, as in a link."""
    try:
        fields: dict[str, Any] = {"view_angle": float(view.parameters.get("view_angle", 30))}
        for name in ("position", "focal_point", "view_up"):
            if name in view.parameters:
                fields[name] = [float(number) for number in view.parameters[name].split(",")]
    except ValueError as error:
        raise InvalidInput(f"view {view.name}: {error}") from error
    return Camera.from_dict(fields)


@dataclass(frozen=True)
class Keyframe:
    """A camera at a time, in seconds."""

    time: float
    camera: Camera


class CameraPath:
    """A smooth motion through keyframes. The camera rests at both ends and between equal keyframes."""

    def __init__(self, keyframes: Iterable[Keyframe]) -> None:
        self.keyframes = tuple(keyframes)
        if len(self.keyframes) < 2:
            raise InvalidInput("a path needs two keyframes or views")
        first = self.keyframes[0].camera
        for before, key in zip(self.keyframes, self.keyframes[1:]):
            if not before.time < key.time:
                raise InvalidInput("times of keyframes must ascend")
            fields = ((first.view_up, key.camera.view_up), (first.view_angle, key.camera.view_angle))
            if any((a is None) != (b is None) for a, b in fields):
                raise InvalidInput("view_up and view_angle must be in all keyframes or views, or in none")

    @classmethod
    def through(cls, views: Iterable[SavedView], seconds_per_view: float = SECONDS_PER_VIEW) -> CameraPath:
        """A flight through saved views in their order, one every `seconds_per_view`."""
        return cls(Keyframe(number * seconds_per_view, _camera_of(view)) for number, view in enumerate(views))

    @classmethod
    def from_dict(cls, document: Mapping[str, Any], seconds_per_view: float = SECONDS_PER_VIEW) -> CameraPath:
        """A path from the content of a path file: {"keyframes": [{"time": 0, "position": ...}, ...]}.

        Or from one of saved views: {"views": [{"name": ..., "parameters": {"position": "x,y,z", ...}}, ...]}.
        """
        if "views" in document:
            views = (SavedView(view["name"], view["parameters"]) for view in document["views"])
            return cls.through(views, seconds_per_view)
        keyframes = []
        for entry in document["keyframes"]:
            fields = dict(entry)
            keyframes.append(Keyframe(float(fields.pop("time")), Camera.from_dict(fields)))
        return cls(keyframes)

    @classmethod
    def read(cls, path: str | PathLike[str], seconds_per_view: float = SECONDS_PER_VIEW) -> CameraPath:
        """Reads a path file, or one of saved views."""
        return cls.from_dict(json.loads(Path(path).read_text()), seconds_per_view)

    def cameras(self, fps: float = 30.0) -> Iterator[Camera]:
        """The cameras of all frames."""
        start = self.keyframes[0].time
        # The margin keeps the last frame of a path that lasts a whole number of frames, despite rounding.
        count = int((self.keyframes[-1].time - start) * fps + 1e-6) + 1
        return (self.camera_at(start + number / fps) for number in range(count))

    def camera_at(self, time: float) -> Camera:
        """The camera at a time; beyond the ends that of the end."""
        first = 0
        while first + 2 < len(self.keyframes) and time >= self.keyframes[first + 1].time:
            first += 1
        position = self._at(first, time, lambda camera: tuple(camera.position))
        focal_point = self._at(first, time, lambda camera: tuple(camera.focal_point))
        camera = self.keyframes[first].camera
        up = None
        if camera.view_up is not None:
            up = _upright(self._up(first, time), _sum(1, focal_point, -1, position))
        angle = None
        if camera.view_angle is not None:
            angle = self._at(first, time, lambda c: (c.view_angle or 0.0, 0.0, 0.0))[0]
        return Camera(position, focal_point, up, angle)

    def _up(self, first: int, time: float) -> _V:
        a, b = self.keyframes[first], self.keyframes[first + 1]
        t = min(max((time - a.time) / (b.time - a.time), 0.0), 1.0)
        return _turn(_unit(tuple(a.camera.view_up or ())), _unit(tuple(b.camera.view_up or ())), t)

    def _at(self, first: int, time: float, value: Callable[[Camera], _V]) -> _V:
        """A value of the cameras, on the cubic between keyframes `first` and `first` + 1."""
        keys = self.keyframes
        values = [value(key.camera) for key in keys]

        def step(i: int) -> float:
            return keys[i + 1].time - keys[i].time

        def slope(i: int) -> _V:
            return _sum(1 / step(i), values[i + 1], -1 / step(i), values[i])

        def velocity_at(i: int) -> _V:
            if i in (0, len(keys) - 1):
                return (0.0, 0.0, 0.0)
            return _velocity(slope(i - 1), step(i - 1), slope(i), step(i))

        h = step(first)
        t = min(max((time - keys[first].time) / h, 0.0), 1.0)
        s = 1 - t
        # Cubic Hermite polynomials.
        places = _sum(s * s * (1 + 2 * t), values[first], t * t * (1 + 2 * s), values[first + 1])
        pulls = _sum(h * s * s * t, velocity_at(first), -h * t * t * s, velocity_at(first + 1))
        return _sum(1, places, 1, pulls)
