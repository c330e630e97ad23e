#!/usr/bin/env python3
"""glyphs.py GLYPH_BENCH FILE [--frames N] [--side PIXELS]

Draws a tensor field with the same camera, colours and light by Surfcast and by vtkTensorGlyph with spheres of 16 x 16
faces, in one run. Prints the times of both, and dB beside 8 x 8 exact samples a pixel.
"""

import argparse
import subprocess
import tempfile
from pathlib import Path

import peers
import scene_files


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("bench")
    parser.add_argument("file")
    parser.add_argument("--frames", type=int, default=3)
    parser.add_argument("--side", type=int, default=1024)
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as temporary:
        subprocess.run([options.bench, options.file, str(options.side), "export", temporary], check=True)
        folder = Path(temporary)
        with peers.display() as screen:
            for drawn in peers.drawn_by(options, "draw_vtk_glyphs.py", "vtk tensor glyphs", ["glyphs"], folder, screen):
                ideal = scene_files.read_ppm(folder / "glyphs.ideal.ppm")
                error = peers.psnr(scene_files.read_ppm(Path(drawn["picture"])), ideal)
                print(f"vtkTensorGlyph: wall {drawn['wall']:.0f} ms, processor {drawn['processor']:.0f} ms, "
                      f"{error:.1f} dB")


if __name__ == "__main__":
    main()
