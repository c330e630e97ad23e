#!/usr/bin/env python3
"""glyphs.py GLYPH_BENCH --docs DOCS [--frames N] [--side PIXELS] [--pictures DIR] FIELD...

Draws tensor fields with the same camera, colours and light by Surfcast and by vtkTensorGlyph with spheres of 16 x 16
faces, in one run, and replaces the table of tensors in DOCS/peers.md. Without --docs the table is printed. Errors are
those beside 8 x 8 exact samples a pixel in double precision.
"""

import argparse
import re
import subprocess
import sys
import tempfile
from pathlib import Path

import peers
import scene_files

BEGIN, END = "<!-- tensors: begin -->", "<!-- tensors: end -->"
VTK = "vtk tensor glyphs"
METHODS = ["at rest", "in motion", VTK]


def measure_ours(options, field, folder):
    """{method: (wall, processor, dB)} from the lines that glyph_bench prints."""
    command = [options.bench, field, str(options.side), "export", str(folder)]
    text = subprocess.run(command, check=True, capture_output=True, text=True).stdout
    times = {method: (float(wall), float(processor)) for method, wall, processor in
             re.findall(r"^(at rest|in motion): .*wall (\d+) ms, processor (\d+) ms", text, re.MULTILINE)}
    errors = {method: float(error) for error, method in re.findall(r"([\d.]+) dB (at rest|in motion)", text)}
    return {method: (*times[method], errors[method]) for method in times}


def measure_vtk(options, folder, screen):
    for drawn in peers.drawn_by(options, "draw_vtk_glyphs.py", VTK, ["glyphs"], folder, screen):
        ideal = scene_files.read_ppm(folder / "glyphs.ideal.ppm")
        error = peers.psnr(scene_files.read_ppm(Path(drawn["picture"])), ideal)
        return {VTK: (drawn["wall"], drawn["processor"], error)}
    return {}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("bench")
    parser.add_argument("fields", nargs="+")
    parser.add_argument("--docs", type=Path)
    parser.add_argument("--frames", type=int, default=3, help="of VTK")
    parser.add_argument("--side", type=int, default=1024)
    parser.add_argument("--pictures", type=Path, help="folder in which scenes and pictures stay")
    options = parser.parse_intermixed_args()
    results = {}
    with tempfile.TemporaryDirectory() as temporary, peers.display() as screen:
        for field in options.fields:
            folder = (options.pictures or Path(temporary)) / Path(field).stem
            folder.mkdir(parents=True, exist_ok=True)
            results[Path(field).stem] = measure_ours(options, field, folder) | measure_vtk(options, folder, screen)
    note = (f"{options.side} x {options.side}; Surfcast the least of 5 frames, VTK the median of {options.frames}, "
            f"processor time in brackets. {peers.load_note()}\n\n")
    section = note + peers.table(results, METHODS)
    if not options.docs:
        sys.stdout.write(section)
        return
    peers.replace_section(options.docs / "peers.md", section, BEGIN, END)


if __name__ == "__main__":
    main()
