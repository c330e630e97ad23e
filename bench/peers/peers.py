#!/usr/bin/env python3
"""peers.py LABORATORY --docs DOCS [--scenes NAME,...] [--frames N] [--pvpython PROGRAM] [--pictures DIR] [SCAN...]

Draws the scenes of the laboratory and scans with the same cameras by other programs of Debian, in one run with the
laboratory itself, and replaces the table in DOCS/peers.md and the plot DOCS/images/peers.svg. LABORATORY is the program
of that name. A program that cannot be started is left out, and named on stderr.
"""

import argparse
import contextlib
import json
import os
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np

import scene_files

HERE = Path(__file__).resolve().parent
BEGIN, END = "<!-- peers: begin -->", "<!-- peers: end -->"
DEFAULT_SCENES = "checker_oblique,checker_close,checker_far,checker_sphere,noise_torus,layers_oblique,random_oblique"
OURS = ["points", "discs", "per pixel", "at rest", "1 px"]
PEERS = [("draw_vtk.py", "vtk points"), ("draw_vtk.py", "vtk discs"), ("draw_vtk.py", "vtk gaussians"),
         ("draw_paraview.py", "paraview gaussians"), ("draw_open3d.py", "open3d points")]


def psnr(picture, ideal):
    error = np.mean((picture.astype(float) - ideal.astype(float)) ** 2)
    return float("inf") if error == 0 else 10 * np.log10(255**2 / error)


def measure_ours(options, folder):
    """Measurements of the laboratory: {scene: {method: (wall, processor, dB)}}."""
    command = [options.laboratory, "--frames", str(options.frames), "--path-frames", "2", "--scenes", options.scenes,
               "--export", str(folder), *options.scans]
    subprocess.run(command, check=True)
    results = json.loads((folder / "laboratory.json").read_text())
    return {scene["scene"]: {m["method"]: (m["milliseconds"], m["processor_milliseconds"], m["psnr"])
                             for m in scene["measurements"]} for scene in results["scenes"]}


@contextlib.contextmanager
def display():
    """A display without a screen. Waits until it is ready, however busy the machine is."""
    reading, writing = os.pipe()
    server = subprocess.Popen(["Xvfb", "-displayfd", str(writing), "-screen", "0", "1600x1200x24", "-nolisten", "tcp"],
                              pass_fds=[writing], stderr=subprocess.DEVNULL)
    os.close(writing)
    with os.fdopen(reading) as number:
        yield ":" + number.readline().strip()
    server.terminate()
    server.wait()


def drawn_by(options, program, method, scenes, folder, screen):
    """What a program of this folder reports of the scenes that it drew with a method."""
    python = options.pvpython if program == "draw_paraview.py" else sys.executable
    command = [python, str(HERE / program), method, str(options.frames), str(folder)]
    command += [str(folder / f"{name}.json") for name in scenes]
    environment = dict(os.environ, LIBGL_ALWAYS_SOFTWARE="1", PYTHONPATH=str(HERE), DISPLAY=screen)
    try:
        result = subprocess.run(command, capture_output=True, text=True, env=environment, check=False)
    except FileNotFoundError:
        print(f"{method}: no program {python}", file=sys.stderr)
        return []
    drawn = [json.loads(line) for line in result.stdout.splitlines() if line.startswith("{")]
    if len(drawn) < len(scenes):
        print(f"{method}: {len(drawn)} of {len(scenes)} scenes; {result.stderr.strip()[-300:]}", file=sys.stderr)
    return drawn


def measure_peer(options, program, method, scenes, folder, screen):
    """The same of a method of another program. A scene that it fails to draw is missing."""
    measured = {}
    for drawn in drawn_by(options, program, method, scenes, folder, screen):
        ideal = scene_files.read_ppm(folder / f"{drawn['scene']}.ideal.ppm")
        error = psnr(scene_files.read_ppm(Path(drawn["picture"])), ideal)
        measured[drawn["scene"]] = (drawn["wall"], drawn["processor"], error)
    return measured


def cell(measurement, best):
    if measurement is None:
        return ""
    wall, processor, error = measurement
    text = "equal" if np.isinf(error) else f"{error:.1f} dB"
    return f"{wall:.0f} ms ({processor:.0f}), " + (f"**{text}**" if error == best else text)


def table(results, methods):
    lines = ["| scene | " + " | ".join(methods) + " |", "|---" * (len(methods) + 1) + "|"]
    for scene, measured in results.items():
        best = max(m[2] for m in measured.values())
        lines.append(f"| {scene} | " + " | ".join(cell(measured.get(m), best) for m in methods) + " |")
    return "\n".join(lines) + "\n"


COLORS = ["#999999", "#6b4c9a", "#1b6ca8", "#1b9e77", "#4a9bd1", "#d2691e", "#c0392b", "#e7a33e", "#8c564b", "#222222"]


def plot(scene, measured, methods, x0, y0):
    """Processor time (logarithmic) against error of one scene."""
    width, height, left, bottom, top = 250, 210, 38, 30, 24
    times = [m[1] for m in measured.values()]
    errors = [min(m[2], 60) for m in measured.values()]
    low, high = np.log(max(min(times), 0.1) / 1.2), np.log(max(times) * 1.2)
    least, most = 5 * np.floor((min(errors) - 0.5) / 5), 5 * np.ceil((max(errors) + 0.5) / 5)
    place_x = lambda t: x0 + left + (width - left - 12) * (np.log(max(t, 0.1)) - low) / (high - low)
    place_y = lambda e: y0 + height - bottom - (height - top - bottom) * (min(e, 60) - least) / (most - least)
    text = [f'<text x="{x0 + left}" y="{y0 + 16}" font-weight="bold">{scene}</text>',
            f'<rect x="{x0 + left}" y="{y0 + top}" width="{width - left - 12}" height="{height - top - bottom}" '
            'fill="none" stroke="#cccccc"/>',
            f'<text x="{x0 + 4}" y="{y0 + top + 8}">{most:.0f} dB</text>',
            f'<text x="{x0 + 4}" y="{y0 + height - bottom}">{least:.0f}</text>',
            f'<text x="{x0 + left}" y="{y0 + height - 14}">{np.exp(low):.0f} ms</text>',
            f'<text x="{x0 + width - 12}" y="{y0 + height - 14}" text-anchor="end">{np.exp(high):.0f} ms</text>']
    for method, color in zip(methods, COLORS):
        if method in measured:
            text.append(f'<circle cx="{place_x(measured[method][1]):.1f}" cy="{place_y(measured[method][2]):.1f}" '
                        f'r="4" fill="{color}"/>')
    return text


def svg(results, methods):
    columns, legend = 3, 40
    rows = -(-len(results) // columns)
    width, height = 250 * columns, 210 * rows + legend
    text = [f'<svg xmlns="http://www.w3.org/2000/svg" width="{width}" height="{height}" '
            'font-family="sans-serif" font-size="10">', f'<rect width="{width}" height="{height}" fill="white"/>']
    for i, (method, color) in enumerate(zip(methods, COLORS)):
        x, y = 12 + 145 * (i % 5), 14 + 16 * (i // 5)
        text += [f'<circle cx="{x}" cy="{y - 3}" r="4" fill="{color}"/>', f'<text x="{x + 8}" y="{y}">{method}</text>']
    for i, (scene, measured) in enumerate(results.items()):
        text += plot(scene, measured, methods, 250 * (i % columns), legend + 210 * (i // columns))
    return "\n".join(text + ["</svg>"]) + "\n"


def replace_section(page, section, begin=BEGIN, end=END):
    text = page.read_text()
    head, rest = text.split(begin)
    page.write_text(head + begin + "\n\n" + section + "\n" + end + rest.split(end)[1])


def load_note():
    """A machine that is busy with other work is no place for wall times."""
    busy = os.getloadavg()[0] / os.cpu_count()
    return f"Load of the machine during the run: {busy:.1f} waiting programs for each core" + (
        "; **wall times are disturbed**." if busy > 1.2 else ".")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("laboratory")
    parser.add_argument("scans", nargs="*")
    parser.add_argument("--docs", type=Path, required=True)
    parser.add_argument("--scenes", default=DEFAULT_SCENES)
    parser.add_argument("--frames", type=int, default=5)
    parser.add_argument("--pvpython", default="pvpython")
    parser.add_argument("--pictures", type=Path, help="folder in which scenes and pictures stay")
    options = parser.parse_intermixed_args()
    with tempfile.TemporaryDirectory() as temporary:
        folder = options.pictures or Path(temporary)
        folder.mkdir(parents=True, exist_ok=True)
        results = {scene: {m: v for m, v in measured.items() if m in OURS}
                   for scene, measured in measure_ours(options, folder).items()}
        methods = list(OURS)
        with display() as screen:
            for program, method in PEERS:
                measured = measure_peer(options, program, method, list(results), folder, screen)
                for scene, measurement in measured.items():
                    results[scene][method] = measurement
                methods += [method] if measured else []
    note = f"512 x 512; medians of {options.frames} frames. {load_note()}\n\n"
    section = note + table(results, methods) + "\n![Time against error](images/peers.svg)\n"
    replace_section(options.docs / "peers.md", section)
    (options.docs / "images" / "peers.svg").write_text(svg(results, methods))


if __name__ == "__main__":
    main()
