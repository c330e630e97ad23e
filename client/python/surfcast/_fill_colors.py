"""The colours with which holes in a warped frame are filled, as `client/warp/fill_colors.h` has them."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from ._depth import Depth, surface_step

_A = npt.NDArray[Any]

_REACH = 2  # texels


def fill_colors(pixels: _A, depth: Depth) -> _A:
    """For each texel the mean of the pixels up to two texels around that lie on the same surface: (n, 3)."""
    sums = _sums(pixels, depth)
    inverse = depth.inverse
    rows, columns = inverse.shape
    around = np.zeros_like(sums)
    for down in range(-_REACH, _REACH + 1):
        for across in range(-_REACH, _REACH + 1):
            own, other = _overlap(down, rows), _overlap(across, columns)
            here, there = inverse[own[0], other[0]], inverse[own[1], other[1]]
            close = np.abs(here - there) <= surface_step(here, there, depth.cell)
            same = close & ((here == 0) == (there == 0))
            around[own[0], other[0]] += np.where(same[..., None], sums[own[1], other[1]], 0)
    count = around[..., 3:]
    colors: _A = ((around[..., :3] + count // 2) // np.maximum(count, 1)).astype(np.uint8)
    return colors.reshape(-1, 3)


def _sums(pixels: _A, depth: Depth) -> _A:
    """Of each texel: its channels, and how many pixels it has."""
    counted = np.concatenate([pixels, np.ones((*pixels.shape[:2], 1), np.uint8)], axis=-1)
    rows = np.add.reduceat(counted, np.arange(depth.inverse.shape[0]) * depth.cell, axis=0, dtype=np.int64)
    sums: _A = np.add.reduceat(rows, np.arange(depth.inverse.shape[1]) * depth.cell, axis=1)
    return sums


def _overlap(offset: int, size: int) -> tuple[slice, slice]:
    """The places of an axis that have a neighbour at an offset, and those neighbours."""
    return slice(max(-offset, 0), size - max(offset, 0)), slice(max(offset, 0), size - max(-offset, 0))
