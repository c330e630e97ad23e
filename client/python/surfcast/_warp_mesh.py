"""The triangles of a frame with depth. The rules are those of `client/warp/warp_mesh.h`, for all triangles at once."""

from __future__ import annotations

from dataclasses import dataclass, replace
from enum import IntEnum
from typing import Any

import numpy as np
import numpy.typing as npt

from ._depth import Depth, surface_step

_A = npt.NDArray[Any]

_SURROUNDINGS = 0.25  # width of what is continued beyond the border, heights of the frame


class Sheet(IntEnum):
    """Beside an outline a frame is two sheets: the surface in front, and what is behind it."""

    SURFACE = 0  # away from outlines
    NEAR = 1
    FAR = 2
    FILL = 3  # what opens between the two
    SURROUNDINGS = 4  # beyond the border of the frame


@dataclass(frozen=True, eq=False)
class WarpMesh:
    """n triangles of three corners."""

    pixel: _A  # (n, 3, 2), from the upper left corner of the frame
    inverse: _A  # (n, 3), 1 / depth; 0: infinitely far
    # (n, 3), of NEAR and FAR: 1 where a corner is the surface in front, 0 where it is what is behind;
    # of SURROUNDINGS: 1 at the border of the frame, 0 farthest out
    front: _A
    fill_texel: _A  # (n, 3), of FAR, FILL and SURROUNDINGS: the texel whose fill colour is used
    sheet: _A  # (n,)
    background: _A  # (n,), of SURFACE: infinitely far
    far: _A  # (n, 2), of NEAR and FAR: where the frame shows what is behind, pixels

    def only(self, chosen: _A) -> WarpMesh:
        return WarpMesh(*(values[chosen] for values in vars(self).values()))


def make_warp_mesh(depth: Depth, resolution: tuple[int, int]) -> WarpMesh:
    grid = _Grid(depth, resolution)
    parts = [*_sheets(grid), _surroundings(grid, _SURROUNDINGS * resolution[1])]
    return WarpMesh(*(np.concatenate(values) for values in zip(*(vars(part).values() for part in parts))))


def _places(texels: int, cell: int, pixels: int) -> _A:
    """Centres of the cells along one side, with both ends of the side."""
    first = np.arange(texels) * cell
    return np.concatenate([[0], (first + np.minimum(first + cell, pixels)) / 2, [pixels]])


def _cuts(inverse: _A, cell: int) -> _A:
    """Whether the surface is broken between each value of a row and the next."""
    a, b = inverse[:, :-1], inverse[:, 1:]
    tolerance = surface_step(a, b, cell)
    step = b - a
    there = (a != 0) & (b != 0)
    explained = np.zeros(step.shape, bool)
    explained[:, 1:] |= there[:, :-1] & (np.abs(step[:, :-1] - step[:, 1:]) <= tolerance[:, 1:])
    explained[:, :-1] |= there[:, 1:] & (np.abs(step[:, 1:] - step[:, :-1]) <= tolerance[:, :-1])
    cuts: _A = np.where(there, (np.abs(step) > tolerance) & ~explained, a != b)
    return cuts


class _Grid:
    """The texels with a ring around them, whose vertices lie on the border of the frame."""

    def __init__(self, depth: Depth, resolution: tuple[int, int]) -> None:
        rows, columns = depth.inverse.shape
        self.cell = depth.cell
        self.x = _places(columns, depth.cell, resolution[0])
        self.y = _places(rows, depth.cell, resolution[1])
        self.inverse = np.pad(depth.inverse.astype(np.float64), 1, mode="edge")
        self._move_to_centres()
        self._extend(self.inverse[1:-1])
        self._extend(self.inverse.T)
        self.cut_right = _cuts(self.inverse, self.cell)
        self.cut_down = _cuts(self.inverse.T, self.cell).T

    def _half_steps(self, inverse: _A) -> _A:
        """The change across half a cell of each row, where the surface is not broken on either side."""
        cuts = _cuts(inverse, self.cell)
        steps: _A = np.where(cuts[:, :-1] | cuts[:, 1:], 0, np.abs(inverse[:, 2:] - inverse[:, :-2]) / 4)
        return steps

    def _move_to_centres(self) -> None:
        """A texel is the nearest point of its cell, which on a slanted surface is a corner of it."""
        nearest = self.inverse[1:-1, 1:-1]
        steps = self._half_steps(self.inverse[1:-1]) + self._half_steps(self.inverse[:, 1:-1].T).T
        nearest[...] = np.maximum(nearest - steps, nearest / 2)

    def _extend(self, inverse: _A) -> None:
        """Continues the slopes of each row to both ends, half a cell beyond the last centres."""
        if inverse.shape[1] <= 3:
            return
        for row in (inverse, inverse[:, ::-1]):
            last, before = row[:, 1], row[:, 2]
            beyond = np.maximum(last + (last - before) / 2, last / 2)
            row[:, 0] = np.where(_cuts(row[:, :4], self.cell)[:, 1], last, beyond)

    def texels(self, at: _A) -> _A:
        """Those of vertices by their numbers; of vertices on the border, the nearest."""
        columns, rows = len(self.x) - 2, len(self.y) - 2
        column = np.clip(at % len(self.x) - 1, 0, columns - 1)
        texels: _A = np.clip(at // len(self.x) - 1, 0, rows - 1) * columns + column
        return texels

    def pixels(self, at: _A) -> _A:
        """The places of vertices by their numbers, row after row."""
        return np.stack([self.x[at % len(self.x)], self.y[at // len(self.x)]], axis=-1)


class _Outlines:
    """What outlines beside each vertex separate. Away from them, both sheets are its own depth."""

    def __init__(self, grid: _Grid) -> None:
        numbers = np.arange(grid.inverse.size).reshape(grid.inverse.shape)
        self.near, self.far, self.far_at = grid.inverse.copy(), grid.inverse.copy(), numbers.copy()
        self.beside = np.zeros(grid.inverse.shape, bool)
        left, right = (..., np.s_[:-1]), (..., np.s_[1:])
        upper, lower = (np.s_[:-1], ...), (np.s_[1:], ...)
        neighbours: tuple[tuple[Any, Any, _A], ...] = (
            (right, left, grid.cut_right),
            (left, right, grid.cut_right),
            (lower, upper, grid.cut_down),
            (upper, lower, grid.cut_down),
        )
        for own, other, cuts in neighbours:
            there = grid.inverse[other]
            self.beside[own] |= cuts
            self.near[own] = np.where(cuts, np.maximum(self.near[own], there), self.near[own])
            farther = cuts & (there < self.far[own])
            self.far[own] = np.where(farther, there, self.far[own])
            self.far_at[own] = np.where(farther, numbers[other], self.far_at[own])


def _triangles(grid: _Grid) -> tuple[_A, _A]:
    """Two triangles for each square: the numbers of their corners, and whether one of their edges is cut."""
    numbers = np.arange(grid.inverse.size).reshape(grid.inverse.shape)
    a, b, c, d = (numbers[y : y - 1 or None, x : x - 1 or None] for y in (0, 1) for x in (0, 1))
    top, bottom = grid.cut_right[:-1], grid.cut_right[1:]
    left, right = grid.cut_down[:, :-1], grid.cut_down[:, 1:]
    # Divided between the ends of the diagonal that are nearer to each other.
    inverse = grid.inverse.ravel()
    falling = np.abs(inverse[a] - inverse[d]) <= np.abs(inverse[b] - inverse[c])
    first = np.where(falling, [a, b, d], [a, b, c])
    second = np.where(falling, [a, d, c], [b, d, c])
    cut = [top | np.where(falling, right, left), bottom | np.where(falling, left, right)]
    corners = np.concatenate([first.reshape(3, -1), second.reshape(3, -1)], axis=1).T
    return corners, np.concatenate([part.ravel() for part in cut])


def _sheets(grid: _Grid) -> list[WarpMesh]:
    corners, cut = _triangles(grid)
    outlines = _Outlines(grid)
    beside = outlines.beside.ravel()[corners]
    inverse = grid.inverse.ravel()[corners]
    across = corners[np.arange(len(corners)), beside.argmax(axis=1)]  # the first corner beside an outline
    none = np.zeros_like(inverse)
    plain = WarpMesh(
        pixel=grid.pixels(corners),
        inverse=inverse,
        front=none,
        fill_texel=np.zeros(corners.shape, int),
        sheet=np.full(len(corners), Sheet.SURFACE),
        background=(inverse == 0).all(axis=1),
        far=grid.pixels(outlines.far_at.ravel()[across]),
    )
    outlined = beside.any(axis=1)
    split = replace(plain, background=np.zeros(len(corners), bool))
    near, far, far_at = (values.ravel()[corners] for values in (outlines.near, outlines.far, outlines.far_at))
    nearest = np.where(beside, near, 0).max(axis=1, keepdims=True)
    farthest = np.where(beside, far, np.inf).min(axis=1, keepdims=True)
    in_front = nearest - inverse <= inverse - farthest
    in_near = np.where(beside, near, np.where(in_front, inverse, nearest))
    # A triangle from a surface to background would become a needle as the eye moves.
    beyond = farthest == 0
    in_far = np.where(beyond, 0, np.where(beside, far, np.where(in_front, farthest, inverse)))
    # Behind corners in front that are not beside an outline lies what is farthest behind the others.
    last = np.where(beside, far, np.inf).argmin(axis=1)[:, None]
    farthest_at = np.take_along_axis(far_at, last, axis=1)
    behind = np.where(beyond | (in_front & ~beside), farthest_at, np.where(beside, far_at, corners))

    def sheet(kind: Sheet, inverse: _A, front: _A, filled_as: _A, chosen: _A) -> WarpMesh:
        kinds = np.full(len(corners), kind)
        texels = grid.texels(filled_as)
        return replace(split, inverse=inverse, front=front, fill_texel=texels, sheet=kinds).only(chosen)

    return [
        plain.only(~outlined),
        sheet(Sheet.FILL, inverse, none, _filling(corners, inverse), outlined & cut),
        sheet(Sheet.FAR, in_far, in_front.astype(float), behind, outlined),
        sheet(Sheet.NEAR, in_near, in_front.astype(float), corners, outlined),
    ]


def _filling(corners: _A, inverse: _A) -> _A:
    """Whose fill colour corners take: in front the farthest one's, else their own; beside background its colour."""
    nearest, farthest = inverse.max(axis=1, keepdims=True), inverse.min(axis=1, keepdims=True)
    far = np.take_along_axis(corners, inverse.argmin(axis=1)[:, None], axis=1)
    filling: _A = np.where((nearest - inverse <= inverse - farthest) | (farthest == 0), far, corners)
    return filling


def _surroundings(grid: _Grid, margin: float) -> WarpMesh:
    """Strips beyond the border, for what a turning eye sees there."""
    numbers = np.arange(grid.inverse.size).reshape(grid.inverse.shape)
    sides = (
        (numbers[0], (0, -margin)),
        (numbers[-1], (0, margin)),
        (numbers[:, 0], (-margin, 0)),
        (numbers[:, -1], (margin, 0)),
    )
    pixel: list[_A] = []
    inverse: list[_A] = []
    front: list[_A] = []
    fill_texel: list[_A] = []
    for along, outwards in sides:
        ends = np.stack([along[:-1], along[1:]], axis=1)
        inner, depth = grid.pixels(ends), grid.inverse.ravel()[ends]
        quad = np.concatenate([inner, inner + np.asarray(outwards)], axis=1)  # from, to, both of them outside
        for corners in ([0, 1, 3], [0, 3, 2]):
            pixel.append(quad[:, corners])
            own = [corner % 2 for corner in corners]
            inverse.append(depth[:, own])
            fill_texel.append(grid.texels(ends)[:, own])
            front.append(np.tile([float(corner < 2) for corner in corners], (len(quad), 1)))
    count = sum(map(len, pixel))
    return WarpMesh(
        pixel=np.concatenate(pixel),
        inverse=np.concatenate(inverse),
        front=np.concatenate(front),
        fill_texel=np.concatenate(fill_texel),
        sheet=np.full(count, Sheet.SURROUNDINGS),
        background=np.zeros(count, bool),
        far=np.zeros((count, 2)),
    )
