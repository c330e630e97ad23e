"""Frames with depth as another camera sees them. The rules are those of `client/warp/warp.h`, as are the figures."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import numpy.typing as npt

from ._values import Camera
from ._view import Frame
from ._fill_colors import fill_colors
from ._warp_mesh import Sheet, WarpMesh, make_warp_mesh
from .errors import InvalidInput

_A = npt.NDArray[Any]

_AGREEMENT = 0.05  # of inverse depths: the frame at rest is shown where both frames show the same
# What continues a surface lies behind what the frame shows of it, and what fills holes lies behind its slopes, too.
_CONTINUED = 0.999
_FILLED = 0.9
# Squared differences, summed over the channels: pixels beside an outline belong to what is behind it up to the first.
# Where things are seen through, the frame at rest is shown up to the second.
_SAME_COLOR = 48
_SAME_LOOK = 6000
_ON_EDGE = 1e-9  # barycentric
_MOST_FRAGMENTS = 1 << 18  # worked on at a time


def warp(
    frame: Frame,
    camera: Camera,
    *,
    rest: Frame | None = None,
    resolution: tuple[int, int] | None = None,
    background: tuple[int, int, int] = (0, 0, 0),
) -> npt.NDArray[np.uint8]:
    """What `camera` sees, by a frame with depth: height x width x 3, sRGB.

    `rest`: a former frame at rest, which is shown where both agree. `background`: where there is nothing. The default
    resolution is that of the view. Of the frame's own camera the result is the frame.
    """
    target = _Lens.of(camera, resolution or frame.resolution)
    picture = np.empty((target.width * target.height, 3), np.uint8)
    picture[:] = background
    newest = _seen(_Source.of(frame), target, made_up=True)
    picture[newest.at] = newest.color
    if rest is not None:
        source = _Source.of(rest)
        _add_rest(_seen(source.without_fill(), target, made_up=False), newest, source.most_off, picture)
    return picture.reshape(target.height, target.width, 3)


@dataclass(frozen=True, eq=False)
class _Lens:
    """A camera with its axes. A pixel (x, y) sees along ((x - width / 2) / eta, (height / 2 - y) / eta, 1)."""

    eye: _A
    axes: _A  # rows: right, up, forward
    eta: float
    width: int
    height: int

    @staticmethod
    def of(camera: Camera, resolution: tuple[int, int]) -> _Lens:
        if camera.view_up is None or camera.view_angle is None:
            raise InvalidInput("camera: view_up and view_angle must be set, as those of the camera of a frame are")
        eye = np.asarray(camera.position, np.float64)
        view = np.asarray(camera.focal_point, np.float64) - eye
        if not view.any():
            raise InvalidInput("camera: the focal point must differ from the position")
        forward = view / np.linalg.norm(view)
        least = np.eye(3)[np.abs(forward).argmin()]  # the axis least aligned with the view
        up = np.asarray(camera.view_up, np.float64)
        right = np.cross(forward, up / (np.linalg.norm(up) or 1))
        if np.linalg.norm(right) < 1e-9:
            right = np.cross(forward, least)
        right /= np.linalg.norm(right)
        width, height = resolution
        eta = height / (2 * math.tan(math.radians(camera.view_angle) / 2))
        return _Lens(eye, np.stack([right, np.cross(right, forward), forward]), eta, width, height)

    def rays(self, pixel: _A) -> _A:
        """In world coordinates, with a depth of 1."""
        x, y = (pixel[..., 0] - self.width / 2) / self.eta, (self.height / 2 - pixel[..., 1]) / self.eta
        rays: _A = np.stack([x, y, np.ones_like(x)], axis=-1) @ self.axes
        return rays


@dataclass(frozen=True, eq=False)
class _Source:
    """A frame that can be warped."""

    pixels: _A
    lens: _Lens
    mesh: WarpMesh
    fill_colors: _A  # of the texels of its depth
    most_off: float  # squared difference of colours up to which it is shown above another frame

    @staticmethod
    def of(frame: Frame) -> _Source:
        if frame.depth is None:
            raise InvalidInput("the frame has no depth: ask for a view with depth=True")
        resolution = frame.picture.resolution
        lens = _Lens.of(frame.picture.camera, resolution)
        mesh = make_warp_mesh(frame.depth, resolution)
        pixels, most_off = frame.picture.array, _SAME_LOOK if frame.depth.seen_through else math.inf
        return _Source(pixels, lens, mesh, fill_colors(pixels, frame.depth), most_off)

    def without_fill(self) -> _Source:
        mesh = self.mesh
        return replace(self, mesh=mesh.only((mesh.sheet < Sheet.FILL) & ~mesh.background))


@dataclass(frozen=True, eq=False)
class _Seen:
    """Pixels of the target, each once: what is nearest there."""

    at: _A  # row after row
    inverse: _A  # 1 / depth
    density: _A  # pixels of the frame in a pixel, along one direction; -1: made up
    color: _A

    def only(self, chosen: _A) -> _Seen:
        return _Seen(*(values[chosen] for values in vars(self).values()))


def _seen(source: _Source, target: _Lens, *, made_up: bool) -> _Seen:
    """What the target sees of a frame, with what continues and fills it, or without."""
    triangles = _Triangles(source, target)
    nothing = _Seen(np.empty(0, int), np.empty(0), np.empty(0), np.empty((0, 3), np.uint8))
    parts = [nothing, *(_fragments(source, triangles, chunk, target) for chunk in triangles.chunks())]
    every = _Seen(*(np.concatenate(values) for values in zip(*(vars(part).values() for part in parts))))
    if not made_up:
        every = every.only(every.density >= 0)
    order = np.lexsort((-every.inverse, every.at))
    return every.only(order[np.diff(every.at[order], prepend=-1) != 0])


class _Triangles:
    """Triangles in the target. Values that are affine on the surface are affine on the screen, divided by w."""

    def __init__(self, source: _Source, target: _Lens) -> None:
        mesh, lens = source.mesh, source.lens
        seen = (lens.rays(mesh.pixel) + mesh.inverse[..., None] * (lens.eye - target.eye)) @ target.axes.T
        ahead = (seen[..., 2] > 0).all(axis=1)
        mesh, seen = mesh.only(ahead), seen[ahead]
        w = seen[..., 2]
        screen = np.stack(
            [target.width / 2 + target.eta * seen[..., 0] / w, target.height / 2 - target.eta * seen[..., 1] / w], axis=-1
        )
        area = _area(screen)
        first = np.clip(np.ceil(screen.min(axis=1) - 0.5), 0, (target.width, target.height)).astype(int)
        end = np.clip(np.ceil(screen.max(axis=1) - 0.5), 0, (target.width, target.height)).astype(int)
        shown = (first < end).all(axis=1) & (area != 0) & np.isfinite(area)
        mesh, w, screen, area = mesh.only(shown), w[shown], screen[shown], area[shown]
        self.mesh, self.first, self.end = mesh, first[shown], end[shown]
        self.parts = _barycentric(screen, area)
        fill = np.moveaxis(source.fill_colors[mesh.fill_texel], -1, 0)
        own = [np.ones_like(w), mesh.inverse, mesh.pixel[..., 0], mesh.pixel[..., 1], mesh.front]
        values = np.stack([*own, *fill], axis=1)
        # 1 / w, inverse depth, pixel of the frame, front and fill colour: constant, along x, along y.
        self.planes = np.einsum("tvc,tcp->tvp", values / w[:, None], self.parts)
        self.farthest = (mesh.inverse / w).min(axis=1)
        self.density = np.sqrt(np.abs(_area(mesh.pixel) / area))
        self.far = _sample(source.pixels, mesh.far[:, 0], mesh.far[:, 1])

    def chunks(self) -> list[_A]:
        """Numbers of triangles, few enough to work on at a time."""
        size = (self.end - self.first).prod(axis=1)
        chunk = np.cumsum(size) // _MOST_FRAGMENTS
        return np.split(np.arange(len(size)), np.flatnonzero(np.diff(chunk)) + 1) if len(size) else []

    def places(self, chunk: _A) -> tuple[_A, _A, _A]:
        """The pixels inside: triangle, column and row of each. One on an edge belongs to both triangles."""
        top, bottom = self.first[chunk, 1], self.end[chunk, 1]
        triangle, row = _ranges(chunk, top, bottom)
        x = [self.first[triangle, 0] + 0.5, self.end[triangle, 0] - 0.5]
        for part in range(3):
            constant, along_x, along_y = self.parts[triangle, part].T
            there = constant + along_y * (row + 0.5) + _ON_EDGE
            with np.errstate(divide="ignore", invalid="ignore"):
                meets = -there / along_x
            x[0] = np.where(along_x > 0, np.maximum(x[0], meets), x[0])
            x[1] = np.where(along_x < 0, np.minimum(x[1], meets), x[1])
            x[1] = np.where((along_x == 0) & (there < 0), -1, x[1])
        first = np.ceil(np.minimum(x[0], self.end[triangle, 0] + 0.5) - 0.5).astype(int)
        end = np.floor(np.maximum(x[1], self.first[triangle, 0] - 1.0) - 0.5).astype(int) + 1
        line, column = _ranges(np.arange(len(row)), first, np.maximum(end, first))
        return triangle[line], column, row[line]


def _area(corners: _A) -> _A:
    """Twice the signed area of each triangle."""
    a, b = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    area: _A = a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]
    return area


def _barycentric(screen: _A, area: _A) -> _A:
    """Of each corner: constant, along x, along y."""
    one, other = np.roll(screen, -1, axis=1), np.roll(screen, -2, axis=1)
    along = other - one
    parts = [along[..., 1] * one[..., 0] - along[..., 0] * one[..., 1], -along[..., 1], along[..., 0]]
    planes: _A = np.stack(parts, axis=-1) / area[:, None, None]
    return planes


def _ranges(owners: _A, first: _A, end: _A) -> tuple[_A, _A]:
    """Each number of each range, with its owner."""
    size = end - first
    before = np.cumsum(size) - size
    return np.repeat(owners, size), np.arange(size.sum()) - np.repeat(before - first, size)


def _fragments(source: _Source, triangles: _Triangles, chunk: _A, target: _Lens) -> _Seen:
    """What each triangle shows in each pixel."""
    triangle, column, row = triangles.places(chunk)
    place = np.stack([np.ones(len(row)), column + 0.5, row + 0.5], axis=1)
    w, inverse, x, y, front, *channels = np.einsum("tvp,tp->vt", triangles.planes[triangle], place)
    x, y, front = x / w, y / w, front / w
    fill = (np.clip(np.stack(channels, axis=-1) / w[:, None], 0, 255) + 0.5).astype(np.uint8)
    sheet, far = triangles.mesh.sheet[triangle], triangles.far[triangle]
    around = sheet == Sheet.SURROUNDINGS
    height, width = source.pixels.shape[:2]
    x, y = np.where(around, _reflected(x, width), x), np.where(around, _reflected(y, height), y)
    color = _sample(source.pixels, x, y)
    # Beyond the border the reflection of the frame fades to the fill colour of the border.
    fill = np.where(around[:, None], _mixed(fill, color, 256 * np.clip(front, 0, 1) ** 2), fill)
    in_front = (front >= 0.5) & (_distance(color, far) >= _SAME_COLOR)
    own = (sheet == Sheet.SURFACE) | ((sheet == Sheet.NEAR) & in_front) | ((sheet == Sheet.FAR) & ~in_front)
    inverse = np.where(sheet >= Sheet.FILL, triangles.farthest[triangle] * _FILLED, inverse)
    inverse = np.where((sheet == Sheet.FAR) & ~own, inverse * _CONTINUED, inverse)
    drawn = (own | (sheet != Sheet.NEAR)) & (inverse > -1)
    color = np.where(own[:, None], color, fill)
    density = np.where(own, triangles.density[triangle], -1)
    return _Seen(row * target.width + column, inverse, density, color).only(drawn)


def _add_rest(rest: _Seen, newest: _Seen, most_off: float, picture: _A) -> None:
    """Shows what a former frame shows, where the newest one shows nothing, or the same not as sharp."""
    there = np.full(len(picture), -1.0)
    density = np.full(len(picture), -1.0)
    there[newest.at], density[newest.at] = newest.inverse, newest.density
    there, density = there[rest.at], density[rest.at]
    nothing = (there < 0) | (density < 0)
    agrees = np.abs(rest.inverse - there) <= _AGREEMENT * np.maximum(rest.inverse, there)
    alike = _distance(rest.color, picture[rest.at]) <= most_off
    shown = nothing | (agrees & alike & (rest.density >= density))
    picture[rest.at[shown]] = rest.color[shown]


def _distance(a: _A, b: _A) -> _A:
    """Squared, of three channels."""
    distance: _A = ((a.astype(np.int32) - b) ** 2).sum(axis=-1)
    return distance


def _sample(pixels: _A, x: _A, y: _A) -> _A:
    """The colours at places of a picture, by the four nearest pixels with parts of 256ths."""
    height, width = pixels.shape[:2]
    column, row = (np.clip(v - 0.5, 0, size - 1) + 1 / 512 for v, size in ((x, width), (y, height)))
    left, top = column.astype(int), row.astype(int)
    right, below = np.minimum(left + 1, width - 1), np.minimum(top + 1, height - 1)
    part_x, part_y = ((v - first) * 256 for v, first in ((column, left), (row, top)))

    upper = _mixed(pixels[top, left], pixels[top, right], part_x)
    lower = _mixed(pixels[below, left], pixels[below, right], part_x)
    return _mixed(upper, lower, part_y).astype(np.uint8)


def _mixed(a: _A, b: _A, part: _A) -> _A:
    """Between two colours, by 256ths."""
    share = part.astype(np.int32)[:, None]
    values: _A = (a.astype(np.int32) * (256 - share) + b.astype(np.int32) * share + 128) >> 8
    return values


def _reflected(at: _A, size: int) -> _A:
    reflected: _A = np.where(at < 0, -at, np.minimum(at, 2 * size - at))
    return reflected
