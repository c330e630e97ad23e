"""Compares pictures."""

from __future__ import annotations

import math
import os
from dataclasses import dataclass
from os import PathLike
from pathlib import Path
from typing import Any, Union

import numpy as np
import numpy.typing as npt

from .._picture import Picture
from ..errors import Unsupported

Image = Union[Picture, npt.NDArray[Any], str, "PathLike[str]"]


@dataclass(frozen=True)
class Comparison:
    """How much two pictures of 8 bits differ."""

    psnr: float  # peak signal-to-noise ratio over all channels, decibels; infinite if they are equal
    largest: int  # difference of a channel, 0 to 255
    differing: float  # share of the pixels that are not equal

    def __str__(self) -> str:
        return f"{self.psnr:.2f} dB, largest difference {self.largest}, {100 * self.differing:.3g} % of the pixels"


def _pillow() -> Any:
    try:
        from PIL import Image as pillow
    except ImportError as error:
        raise Unsupported("comparing pictures needs the package Pillow") from error
    return pillow


def _array_of(image: Image) -> npt.NDArray[np.uint8]:
    if isinstance(image, Picture):
        values = image.array
    elif isinstance(image, np.ndarray):
        values = image
    else:
        with _pillow().open(image) as file:
            values = np.asarray(file.convert("RGB"))
    if values.dtype != np.uint8 or values.ndim != 3 or values.shape[2] != 3:
        raise ValueError(f"pictures of height x width x 3 bytes are compared, not {values.dtype} {values.shape}")
    return values


def compare(actual: Image, expected: Image) -> Comparison:
    """Compares two pictures of one size: pictures of the client, arrays, or files."""
    a, b = _array_of(actual), _array_of(expected)
    if a.shape != b.shape:
        raise ValueError(f"the pictures have different sizes: {a.shape[:2]} and {b.shape[:2]}")
    difference = np.abs(a.astype(np.int16) - b.astype(np.int16))
    error = float(np.mean(np.square(difference, dtype=np.float64)))
    psnr = math.inf if error == 0 else 10 * math.log10(255**2 / error)
    return Comparison(psnr, int(difference.max(initial=0)), float(difference.any(axis=-1).mean()))


def _updating(update: bool | None) -> bool:
    return os.environ.get("SURFCAST_UPDATE_GOLDEN", "") not in ("", "0") if update is None else update


def _save(array: npt.NDArray[np.uint8], path: Path) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    _pillow().fromarray(array).save(path, format="PNG")


def _keep(folder: Path, name: str, actual: npt.NDArray[np.uint8], expected: npt.NDArray[np.uint8] | None) -> str:
    """Saves what is needed to see why. The difference is four times as large as it is."""
    kept = {"actual": actual}
    if expected is not None:
        kept["expected"] = expected
        if expected.shape == actual.shape:
            difference = np.abs(actual.astype(np.int16) - expected.astype(np.int16))
            kept["difference"] = np.minimum(4 * difference, 255).astype(np.uint8)
    for what, array in kept.items():
        _save(array, folder / f"{name}.{what}.png")
    return ", ".join(str(folder / f"{name}.{what}.png") for what in kept)


def assert_image(
    picture: Image,
    golden: str | PathLike[str],
    *,
    psnr: float = 45.0,
    update: bool | None = None,
    folder: str | PathLike[str] | None = None,
) -> None:
    """Fails unless a picture is as near to a golden one as `psnr` decibels say.

    The actual, the expected and the difference picture are then in `folder`; by default the one that the variable
    SURFCAST_FAILURES names, or `surfcast-failures` beside the golden picture. With `update`, or the variable
    SURFCAST_UPDATE_GOLDEN, the picture becomes the golden one. A picture of the client must be converged.
    """
    __tracebackhide__ = True
    target = Path(golden)
    if isinstance(picture, Picture) and not picture.converged:
        raise AssertionError(f"{target.name}: the picture is not converged")
    actual = _array_of(picture)
    if _updating(update):
        _save(actual, target)
        return
    named = folder or os.environ.get("SURFCAST_FAILURES")
    kept_in = Path(named) if named else target.parent / "surfcast-failures"
    if not target.exists():
        kept = _keep(kept_in, target.stem, actual, None)
        raise AssertionError(f"there is no golden picture {target}; update it to make one. Kept: {kept}")
    expected = _array_of(target)
    if expected.shape != actual.shape:
        said = f"{actual.shape[1]} x {actual.shape[0]} pixels instead of {expected.shape[1]} x {expected.shape[0]}"
    else:
        comparison = compare(actual, expected)
        if comparison.psnr >= psnr:
            return
        said = f"{comparison}; expected at least {psnr:g} dB"
    raise AssertionError(f"{target.name}: {said}. Kept: {_keep(kept_in, target.stem, actual, expected)}")
