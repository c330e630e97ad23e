"""What the tests serve: a scan of known points, and a volume."""

from __future__ import annotations

import os
import struct
import subprocess
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import numpy.typing as npt

SURFCASTD = os.environ["SURFCASTD"]
SURFCAST = os.environ["SURFCAST"]


@dataclass(frozen=True)
class Scan:
    """The points of a LAS file: coordinates, intensities, classes and colours of 16 bits."""

    xyz: npt.NDArray[np.float64]
    intensity: npt.NDArray[np.uint16]
    classification: npt.NDArray[np.uint8]
    rgb: npt.NDArray[np.uint16]


SCALE = np.array((0.001, 0.001, 0.001))
OFFSET = np.array((456000.0, 5428000.0, 100.0))


def make_scan(side: int = 120) -> Scan:
    """A hilly field of side x side points, 25 cm apart, with a wall across it."""
    random = np.random.default_rng(7)
    u, v = (axis.ravel() for axis in np.meshgrid(np.arange(side), np.arange(side)))
    x, y = 0.25 * u + random.uniform(-0.02, 0.02, u.size), 0.25 * v + random.uniform(-0.02, 0.02, u.size)
    z = np.sin(x / 4) + np.cos(y / 5) + np.where(abs(u - side // 2) < 3, 2.0, 0.0)
    steps = np.round(np.column_stack((x, y, z)) / SCALE).astype(np.int64)
    classes = np.where(abs(u - side // 2) < 3, 6, 2).astype(np.uint8)
    rgb = np.column_stack((u * 500, v * 500, np.full(u.size, 20000))).astype(np.uint16)
    return Scan(steps * SCALE + OFFSET, (u * 10 + v).astype(np.uint16), classes, rgb)


def write_las(scan: Scan, path: Path) -> None:
    """LAS 1.2, point format 2."""
    count = len(scan.xyz)
    steps = np.round((scan.xyz - OFFSET) / SCALE).astype("<i4")
    record = np.dtype("<i4, <i4, <i4, <u2, u1, u1, i1, u1, <u2, <u2, <u2, <u2")
    points = np.zeros(count, dtype=record)
    for axis in range(3):
        points[f"f{axis}"] = steps[:, axis]
        points[f"f{9 + axis}"] = scan.rgb[:, axis]
    points["f3"], points["f4"], points["f5"] = scan.intensity, 0x09, scan.classification
    header = bytearray(227)
    struct.pack_into("<4s", header, 0, b"LASF")
    struct.pack_into("<BB", header, 24, 1, 2)
    struct.pack_into("<HII BHI", header, 94, 227, 227, 0, 2, record.itemsize, count)
    struct.pack_into("<I", header, 111, count)
    struct.pack_into("<6d", header, 131, *SCALE, *OFFSET)
    low, high = scan.xyz.min(axis=0), scan.xyz.max(axis=0)
    struct.pack_into("<6d", header, 179, *(value for pair in zip(high, low) for value in pair))
    path.write_bytes(bytes(header) + points.tobytes())


def write_volume(path: Path, side: int = 24) -> None:
    """A ball that fades outwards, as NRRD."""
    axis = np.arange(side) - (side - 1) / 2
    x, y, z = np.meshgrid(axis, axis, axis)
    values = np.clip(1000 - 90 * np.sqrt(x * x + y * y + z * z), 0, None).astype("<i2")
    header = f"NRRD0004\ntype: short\ndimension: 3\nsizes: {side} {side} {side}\nendian: little\nencoding: raw\n"
    path.write_bytes(header.encode() + b"spacings: 1 1 1\n\n" + values.tobytes())


def write_tensors(path: Path, side: int = 6) -> None:
    """A square of tensors that turn and get rounder, as a table."""
    rows = ["x,y,z,xx,xy,xz,yy,yz,zz,weight"]
    for u in range(side):
        for v in range(side):
            turn, narrow = np.pi * u / side, 0.1 + 0.15 * v
            c, s = np.cos(turn), np.sin(turn)
            tensor = (c * c + narrow * s * s, (1 - narrow) * c * s, 0, s * s + narrow * c * c, 0, narrow)
            rows.append(",".join(map(repr, map(float, (2 * u, 2 * v, 0, *tensor, u + v)))))
    path.write_text("\n".join(rows) + "\n")


WEST, SOUTH, STEP = 9.1, 48.7, 1e-5  # degrees


def write_degrees(path: Path, side: int = 30) -> None:
    """A level square of points in degrees, as a table."""
    rows = [f"{WEST + u * STEP!r},{SOUTH + v * STEP!r},250" for v in range(side) for u in range(side)]
    path.write_text("\n".join(["x,y,z", *rows]) + "\n")


def build(source: Path, model: Path, *flags: str) -> None:
    subprocess.run([SURFCASTD, "build", source, "--output", model, *flags], check=True, capture_output=True)
