"""Pictures as the server encoded them, and as arrays."""

from __future__ import annotations

import io
import os
import tempfile
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from ._exr import ExrFile, read_exr
from ._values import Camera
from ._wire import surfcast_pb2 as wire
from .errors import InvalidInput, Unsupported

FORMATS = {"png": wire.FILE_FORMAT_PNG, "jpg": wire.FILE_FORMAT_JPEG, "webp": wire.FILE_FORMAT_WEBP}
FORMATS["exr"] = wire.FILE_FORMAT_EXR
_NAMES = {value: name for name, value in FORMATS.items()}


@dataclass(frozen=True)
class LevelCount:
    """Blocks of one level of detail: those that the picture should show, and those that it shows. 0 is the finest."""

    level: int
    selected: int
    drawn: int


@dataclass(frozen=True, eq=False)
class Picture:
    """A picture, with what the server says of it. Times are in milliseconds."""

    data: bytes
    format: str
    camera: Camera
    resolution: tuple[int, int]
    converged: bool
    preview: bool
    spacing: float
    render_scale: float
    surfels_drawn: int
    blocks_drawn: int
    blocks_selected: int
    stages: Mapping[str, float]
    levels: tuple[LevelCount, ...]
    gl_renderer: str
    expected_error: float  # with `error` or `time`: the PSNR expected, dB; inf: as with every point; 0: not known
    expected_ms: float  # likewise: the time of drawing and encoding

    @cached_property
    def array(self) -> npt.NDArray[Any]:
        """Height x width x 3, the top row first: uint8 in sRGB, or of EXR float32 in linear light."""
        if self.format == "exr":
            channels = self._exr.channels
            return np.stack([channels[name] for name in "RGB"], axis=-1)
        try:
            from PIL import Image
        except ImportError as error:
            raise Unsupported("arrays of PNG, JPEG and WebP need the package Pillow") from error
        with Image.open(io.BytesIO(self.data)) as image:
            return np.array(image.convert("RGB"))

    @property
    def channels(self) -> Mapping[str, npt.NDArray[Any]]:
        """The channels of an EXR picture by their names: "R", "Z", "N.X", "id" and so on, height x width each."""
        return self._exr.channels

    @property
    def origin(self) -> npt.NDArray[np.float64] | None:
        """The eye in world coordinates, which the channels "P.X", "P.Y" and "P.Z" are relative to."""
        return self._exr.origin

    def save(self, path: str | PathLike[str]) -> None:
        """Writes the encoded picture. The file has its name only when it is whole."""
        target = Path(path)
        extension = target.suffix.lower().lstrip(".").replace("jpeg", "jpg")
        if extension != self.format:
            raise InvalidInput(f"{target}: the picture is {self.format}; ask for another format when it is drawn")
        handle, scratch = tempfile.mkstemp(dir=target.parent, prefix=f".{target.name}.")
        try:
            with os.fdopen(handle, "wb") as file:
                file.write(self.data)
                file.flush()
                os.fsync(file.fileno())
            os.chmod(scratch, 0o666 & ~_umask())
            os.replace(scratch, target)
        except BaseException:
            os.unlink(scratch)
            raise

    @cached_property
    def _exr(self) -> ExrFile:
        if self.format != "exr":
            raise InvalidInput("only pictures in the format exr have channels")
        return read_exr(self.data)

    def _repr_png_(self) -> bytes | None:
        return self.data if self.format == "png" else None

    def _repr_jpeg_(self) -> bytes | None:
        return self.data if self.format == "jpg" else None

    def __repr__(self) -> str:
        width, height = self.resolution
        state = "converged" if self.converged else "not converged"
        return f"<surfcast.Picture {width} x {height} {self.format}, {len(self.data)} bytes, {state}>"


def _umask() -> int:
    mask = os.umask(0)
    os.umask(mask)
    return mask


def picture_from(picture: wire.Picture) -> Picture:
    return Picture(
        data=picture.data,
        format=_NAMES.get(picture.format, "png"),
        camera=Camera.from_wire(picture.camera),
        resolution=(picture.resolution.width, picture.resolution.height),
        converged=picture.converged,
        preview=picture.preview,
        spacing=picture.spacing,
        render_scale=picture.render_scale,
        surfels_drawn=picture.surfels_drawn,
        blocks_drawn=picture.blocks_drawn,
        blocks_selected=picture.blocks_selected,
        stages={stage.name: stage.milliseconds for stage in picture.stages},
        levels=tuple(LevelCount(l.level, l.blocks_selected, l.blocks_drawn) for l in picture.levels),
        gl_renderer=picture.gl_renderer,
        expected_error=picture.expected_error,
        expected_ms=picture.expected_ms,
    )
