"""Reads OpenEXR files as the server writes them: scan lines, without compression or by ZIP, one part.

The layout is that of "OpenEXR File Layout" of the OpenEXR project.
"""

from __future__ import annotations

import struct
import zlib
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from .errors import Unsupported

_MAGIC = 20000630
_TYPES: dict[int, str] = {0: "<u4", 1: "<f2", 2: "<f4"}
_LINES_OF_BLOCK = {0: 1, 2: 1, 3: 16}  # none, ZIPS, ZIP


@dataclass(frozen=True)
class ExrFile:
    """The channels of a file, each an array of rows from the top, and the eye that positions are relative to."""

    channels: dict[str, npt.NDArray[Any]]
    origin: npt.NDArray[np.float64] | None


def _text(data: bytes, at: int) -> tuple[str, int]:
    end = data.index(b"\0", at)
    return data[at:end].decode(), end + 1


def _attributes(data: bytes) -> tuple[dict[str, tuple[str, bytes]], int]:
    """The header's attributes with their types, and where the table of offsets begins."""
    magic, version = struct.unpack_from("<II", data)
    if magic != _MAGIC or version & 0xFF != 2 or version & 0x1A00:
        raise Unsupported("not an EXR file of scan lines in one part")
    attributes: dict[str, tuple[str, bytes]] = {}
    at = 8
    while data[at]:
        name, at = _text(data, at)
        kind, at = _text(data, at)
        (size,) = struct.unpack_from("<I", data, at)
        attributes[name] = (kind, data[at + 4 : at + 4 + size])
        at += 4 + size
    return attributes, at + 1


def _channel_list(value: bytes) -> list[tuple[str, np.dtype[Any]]]:
    channels = []
    at = 0
    while value[at]:
        name, at = _text(value, at)
        kind, _, x_sampling, y_sampling = struct.unpack_from("<iIii", value, at)
        if kind not in _TYPES or (x_sampling, y_sampling) != (1, 1):
            raise Unsupported("an EXR file with subsampled channels")
        channels.append((name, np.dtype(_TYPES[kind])))
        at += 16
    return channels


def _unzip(packed: bytes, size: int) -> bytes:
    """Undoes ZIP: deflate, differences of successive bytes, and the halves of all bytes apart."""
    if len(packed) == size:  # stored as it is, because it would have grown
        return packed
    deltas = np.frombuffer(zlib.decompress(packed), dtype=np.uint8).astype(np.int64)
    deltas[1:] -= 128
    halves = (np.cumsum(deltas) & 0xFF).astype(np.uint8)
    whole = np.empty_like(halves)
    middle = (len(halves) + 1) // 2
    whole[0::2] = halves[:middle]
    whole[1::2] = halves[middle:]
    return whole.tobytes()


def read_exr(data: bytes) -> ExrFile:
    """Reads all channels. Raises Unsupported for layouts that the server does not write."""
    attributes, at = _attributes(data)
    channels = _channel_list(attributes["channels"][1])
    left, top, right, bottom = struct.unpack("<4i", attributes["dataWindow"][1])
    width, height = right - left + 1, bottom - top + 1
    compression = attributes["compression"][1][0]
    if compression not in _LINES_OF_BLOCK:
        raise Unsupported("an EXR file with a compression that the server does not write")
    lines = _LINES_OF_BLOCK[compression]
    row_bytes = width * sum(kind.itemsize for _, kind in channels)
    arrays = {name: np.empty((height, width), dtype=kind) for name, kind in channels}
    for (offset,) in struct.iter_unpack("<Q", data[at : at + 8 * -(-height // lines)]):
        y, size = struct.unpack_from("<ii", data, offset)
        rows = min(lines, bottom + 1 - y)
        packed = data[offset + 8 : offset + 8 + size]
        block = _unzip(packed, rows * row_bytes) if compression else packed
        _fill(arrays, channels, block, y - top, rows)
    origin = attributes.get("surfcast:origin")
    return ExrFile(arrays, _doubles(origin))


def _doubles(attribute: tuple[str, bytes] | None) -> npt.NDArray[np.float64] | None:
    if attribute is None:
        return None
    kind = "<f8" if attribute[0] in ("v3d", "double") else "<f4"
    return np.frombuffer(attribute[1], dtype=kind).astype(np.float64)


def _fill(
    arrays: dict[str, npt.NDArray[Any]], channels: list[tuple[str, np.dtype[Any]]], block: bytes, y: int, rows: int
) -> None:
    """Puts a block of lines into the arrays: in each line the channels follow one another."""
    at = 0
    for row in range(y, y + rows):
        for name, kind in channels:
            width = arrays[name].shape[1]
            arrays[name][row] = np.frombuffer(block, dtype=kind, count=width, offset=at)
            at += width * kind.itemsize
