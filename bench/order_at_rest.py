#!/usr/bin/env python3
"""order_at_rest.py SHARP COARSE...: in which order a picture at rest is best sent.

Each pair is a picture at rest and what is shown before it, which is scaled to its size. For parts of the bytes of a
JPEG file of the whole picture (quality 90), prints the PSNR in dB of what a client shows that has got so much of it:

- squares: the squares of the picture, each as a file of its own, those first that change most for their bytes;
- scans: one progressive file, cut after a complete scan.
"""

import io
import sys

import numpy as np
from PIL import Image

PARTS = (0.25, 0.5, 0.75, 1.0)
SIDES = (64, 128, 256)  # of squares, pixels


def encode(pixels: np.ndarray, progressive: bool = False) -> bytes:
    file = io.BytesIO()
    Image.fromarray(pixels).save(file, "JPEG", quality=90, progressive=progressive)
    return file.getvalue()


def decode(file: bytes) -> np.ndarray:
    return np.asarray(Image.open(io.BytesIO(file)).convert("RGB"))


def squared(a: np.ndarray, b: np.ndarray) -> float:
    return float(np.sum((a.astype(float) - b) ** 2))


def psnr(error: float, pixels: np.ndarray) -> float:
    return 10 * np.log10(255**2 * pixels.size / max(error, 1e-9))


def shown(steps: list[tuple[int, float]], bytes_there: float, before: float) -> float:
    """The error after the last step that has arrived. Steps: the bytes up to it, and the error then."""
    return next((error for size, error in reversed(steps) if size <= bytes_there), before)


def squares(sharp: np.ndarray, coarse: np.ndarray, side: int) -> list[tuple[int, float]]:
    parts = []
    for y in range(0, sharp.shape[0], side):
        for x in range(0, sharp.shape[1], side):
            at = np.s_[y : y + side, x : x + side]
            file = encode(np.ascontiguousarray(sharp[at]))
            parts.append((squared(sharp[at], coarse[at]) - squared(sharp[at], decode(file)), len(file)))
    parts.sort(key=lambda part: -part[0] / part[1])
    sizes = np.cumsum([size for _, size in parts])
    errors = squared(sharp, coarse) - np.cumsum([gain for gain, _ in parts])
    return list(zip(sizes.tolist(), errors.tolist()))


def ends_of_scans(file: bytes) -> list[int]:
    """Where the scans of a file end (ITU-T T.81, annex B)."""
    ends = []
    at = 2
    while file[at + 1] != 0xD9:
        scan = file[at + 1] == 0xDA
        at += 2 + int.from_bytes(file[at + 2 : at + 4], "big")
        if scan:
            while file[at] != 0xFF or file[at + 1] == 0:
                at += 1
            ends.append(at)
    return ends


def scans(sharp: np.ndarray) -> list[tuple[int, float]]:
    file = encode(sharp, progressive=True)
    return [(end, squared(sharp, decode(file[:end] + b"\xff\xd9"))) for end in ends_of_scans(file)]


def main(names: list[str]) -> None:
    print("| picture | order | bytes |" + "".join(f" {part:.0%} |" for part in PARTS))
    for sharp_name, coarse_name in zip(names[::2], names[1::2]):
        picture = Image.open(sharp_name).convert("RGB")
        sharp = np.asarray(picture)
        coarse = np.asarray(Image.open(coarse_name).convert("RGB").resize(picture.size, Image.BILINEAR))
        whole = len(encode(sharp))
        before = squared(sharp, coarse)
        print(f"| {sharp_name} | before | | {psnr(before, sharp):.1f} |")
        orders = {f"squares of {side}": squares(sharp, coarse, side) for side in SIDES}
        orders["scans"] = scans(sharp)
        for name, steps in orders.items():
            # Of scans a client shows those that are better than what it has.
            errors = [psnr(min(before, shown(steps, part * whole, before)), sharp) for part in PARTS]
            cells = "".join(f" {error:.1f} |" for error in errors)
            print(f"| {sharp_name} | {name} | {steps[-1][0] / whole:.2f} |{cells}")


if __name__ == "__main__":
    main(sys.argv[1:])
