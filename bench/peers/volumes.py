#!/usr/bin/env python3
"""volumes.py LABORATORY --docs DOCS [--frames N] [--side PIXELS] [--pictures DIR] [PRESET:]GRID...

Draws grids with the same cameras and opacities by Surfcast and by the two ray casters of VTK, in one run, and replaces
the table of volumes in DOCS/peers.md and the plot DOCS/images/peers_volumes.svg. LABORATORY is the program
volume_laboratory. Everything is white, so that a picture is the opacity: VTK blends sRGB codes, Surfcast light. Errors
are those of the middle of the picture, against 16 samples a spacing along the same rays in double precision: of the
same interpolation, and for Surfcast also of its filter.
"""

import argparse
import json
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np

import peers
import scene_files

BEGIN, END = "<!-- volumes: begin -->", "<!-- volumes: end -->"
EQUAL = float("inf")  # dB, which JSON does not have
METHODS = ["surfcast", "vtk fixed point", "vtk gpu"]


def srgb(codes):
    """sRGB codes of light."""
    return np.where(codes <= 0.0031308, 12.92 * codes, 1.055 * np.power(codes, 1 / 2.4) - 0.055)


def decibels(opacity, ideal):
    """Over the pixels that either picture covers. Both are opacities, compared as the sRGB codes of white light."""
    covered = np.maximum(opacity, ideal) > 0.5 / 255
    levels = [np.round(255 * srgb(picture[covered])) / 255 for picture in (opacity, ideal)]
    error = np.mean((levels[0] - levels[1]) ** 2)
    return EQUAL if error == 0 else -10 * np.log10(error)


def opacity_of(path):
    return scene_files.read_ppm(path)[..., 0] / 255.0


def middle(picture, side):
    top, left = (picture.shape[0] - side) // 2, (picture.shape[1] - side) // 2
    return picture[top:top + side, left:left + side]


def measure_ours(options, folder):
    """{file and preset: (wall, processor, dB)}"""
    command = [options.laboratory, "--files-only", "--frames", str(options.frames), "--side", str(options.side),
               "--export", str(folder), *options.grids]
    subprocess.run(command, check=True)
    files = json.loads((folder / "volumes.json").read_text())["files"]
    return {f["file"]: (f["milliseconds"], f["processor_milliseconds"], EQUAL if f["psnr"] is None else f["psnr"])
            for f in files}


def measure_vtk(options, method, scenes, folder, screen):
    measured = {}
    for drawn in peers.drawn_by(options, "draw_vtk_volumes.py", method, scenes, folder, screen):
        ideal = opacity_of(folder / f"{drawn['scene']}.ideal.ppm")
        picture = middle(opacity_of(Path(drawn["picture"])), ideal.shape[0])
        measured[drawn["scene"]] = (drawn["wall"], drawn["processor"], decibels(picture, ideal))
    return measured


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("laboratory")
    parser.add_argument("grids", nargs="+")
    parser.add_argument("--docs", type=Path)
    parser.add_argument("--frames", type=int, default=3)
    parser.add_argument("--side", type=int, default=1024)
    parser.add_argument("--pictures", type=Path, help="folder in which grids, views and pictures stay")
    options = parser.parse_intermixed_args()
    with tempfile.TemporaryDirectory() as temporary:
        folder = options.pictures or Path(temporary)
        folder.mkdir(parents=True, exist_ok=True)
        results = {name: {"surfcast": figures} for name, figures in measure_ours(options, folder).items()}
        with peers.display() as screen:
            for method in METHODS[1:]:
                for name, figures in measure_vtk(options, method, list(results), folder, screen).items():
                    results[name][method] = figures
    note = (f"{options.side} x {options.side}; medians of {options.frames} frames, processor time in brackets. "
            f"{peers.load_note()}\n\n")
    section = note + peers.table(results, METHODS) + "\n![Volumes: time against error](images/peers_volumes.svg)\n"
    if not options.docs:
        sys.stdout.write(section)
        return
    peers.replace_section(options.docs / "peers.md", section, BEGIN, END)
    (options.docs / "images" / "peers_volumes.svg").write_text(peers.svg(results, METHODS))


if __name__ == "__main__":
    main()
