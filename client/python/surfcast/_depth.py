"""The depth of frames."""

from __future__ import annotations

import zlib
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from ._wire import surfcast_pb2 as wire

_STEP_PER_PIXEL = 0.03  # of the larger one, for each pixel of a side of a texel


@dataclass(frozen=True, eq=False)
class Depth:
    """The nearest surface in each square of `cell` x `cell` pixels of a picture, from its upper left corner on.

    `inverse`: 1 / distance from the eye along the view axis, per world unit, the top row first; 0 is background.
    `seen_through`: pixels may show things at several depths.
    """

    cell: int
    inverse: npt.NDArray[np.float32]
    seen_through: bool = False


def surface_step(a: npt.NDArray[Any], b: npt.NDArray[Any], cell: int) -> npt.NDArray[Any]:
    """The most by which the inverse depths of texels beside each other may differ on one surface."""
    step: npt.NDArray[Any] = _STEP_PER_PIXEL * cell * np.maximum(a, b)
    return step


def depth_from(plane: wire.DepthPlane, resolution: tuple[int, int]) -> Depth | None:
    """None where the plane is damaged or does not fit the picture."""
    width, height = (-(-pixels // plane.cell) if plane.cell else 0 for pixels in resolution)
    if (plane.width, plane.height) != (width, height) or not 0 < plane.first < plane.last < np.inf:
        return None
    try:
        inflater = zlib.decompressobj()
        codes = inflater.decompress(plane.codes, width * height + 1)
    except zlib.error:
        return None
    if len(codes) != width * height or not inflater.eof:
        return None
    inverse = _values(plane.first, plane.last)[_without_prediction(codes, width, height)]
    return Depth(plane.cell, inverse, plane.seen_through)


def _values(first: float, last: float) -> npt.NDArray[np.float32]:
    """The inverse depths of the codes."""
    steps = (last / first) ** (np.arange(255) / 254)
    return np.concatenate([[0.0], first * steps]).astype(np.float32)


def _without_prediction(codes: bytes, width: int, height: int) -> npt.NDArray[np.uint8]:
    """Adds to each code the plane through its neighbours on the left, above and between them."""
    rows = np.frombuffer(codes, np.uint8).reshape(height, width)
    done = np.zeros((height + 1, width + 1), np.int64)
    for y in range(height):
        above, row = done[y].tolist(), done[y + 1]
        left = 0
        for x, residual in enumerate(rows[y].tolist()):
            left = (residual + min(max(left + above[x + 1] - above[x], 0), 255)) & 255
            row[x + 1] = left
    return done[1:, 1:].astype(np.uint8)
