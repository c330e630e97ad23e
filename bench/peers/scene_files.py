"""Scenes as `laboratory --export` writes them, and pictures, for the programs that draw scenes with other libraries."""

import json
import resource
import time
from pathlib import Path

import numpy as np

POINT = np.dtype([("position", "<f8", 3), ("normal", "<f4", 3), ("radius", "<f4"), ("color", "u1", 3)])


class View:
    """A size of a picture and a camera."""

    def __init__(self, facts: dict, origin=np.zeros(3)):
        self.width, self.height = facts["resolution"]
        camera = facts["camera"]
        self.position = np.array(camera["position"]) - origin
        self.focal_point = np.array(camera["focal_point"]) - origin
        self.view_up = np.array(camera["view_up"])
        self.view_angle = camera["view_angle"]


class VolumeScene(View):
    """A file with a grid, and what its values look like: points with sRGB codes in [0, 1] and the opacity of one
    spacing."""

    def __init__(self, description: Path):
        facts = json.loads(description.read_text())
        super().__init__(facts)
        self.grid = description.parent / facts["grid"]
        self.transfer = facts["transfer"]
        self.spacing = facts["spacing"]


class Scene(View):
    """A scan with a camera. Positions are relative to the middle of the scan, so that single precision holds them."""

    def __init__(self, description: Path):
        facts = json.loads(description.read_text())
        with open(description.with_suffix(".ply"), "rb") as file:
            while file.readline().strip() != b"end_header":
                pass
            points = np.frombuffer(file.read(), POINT)
        origin = 0.5 * (points["position"].min(axis=0) + points["position"].max(axis=0))
        self.positions = points["position"] - origin
        self.normals = points["normal"]
        self.radii = points["radius"]
        self.colors = points["color"]
        super().__init__(facts, origin)

    def radius_in_pixels(self) -> float:
        """Of the middle of the points in view."""
        forward = (self.focal_point - self.position) / np.linalg.norm(self.focal_point - self.position)
        depths = (self.positions - self.position) @ forward
        eta = self.height / (2 * np.tan(np.radians(self.view_angle) / 2))
        return float(np.median((self.radii * eta / depths)[depths > 0]))


def processor_seconds() -> float:
    usage = resource.getrusage(resource.RUSAGE_SELF)
    return usage.ru_utime + usage.ru_stime


def measure(draw, frames: int):
    """Calls `draw`, which returns a picture, once to warm up and then `frames` times. Returns the last picture, and the
    medians of wall and processor time in milliseconds."""
    draw()
    walls, processors = [], []
    for _ in range(frames):
        wall, processor = time.perf_counter(), processor_seconds()
        picture = draw()
        walls.append(1e3 * (time.perf_counter() - wall))
        processors.append(1e3 * (processor_seconds() - processor))
    return picture, float(np.median(walls)), float(np.median(processors))


def read_ppm(path: Path) -> np.ndarray:
    with open(path, "rb") as file:
        assert file.readline().strip() == b"P6"
        width, height = map(int, file.readline().split())
        file.readline()
        return np.frombuffer(file.read(), np.uint8).reshape(height, width, 3)


def write_ppm(path: Path, picture: np.ndarray) -> None:
    path.write_bytes(b"P6\n%d %d\n255\n" % (picture.shape[1], picture.shape[0]) + picture.astype(np.uint8).tobytes())


def run(methods: dict, scene_of=Scene) -> None:
    """The command line of every drawing program: METHOD FRAMES PICTURE_FOLDER SCENE.json... `methods` maps names to
    functions of a scene that return a drawing function. Prints a line of JSON for each scene."""
    import sys

    name, frames, folder = sys.argv[1], int(sys.argv[2]), Path(sys.argv[3])
    for description in map(Path, sys.argv[4:]):
        picture, wall, processor = measure(methods[name](scene_of(description)), frames)
        target = folder / f"{description.stem}.{name}.ppm"
        write_ppm(target, picture)
        print(json.dumps({"scene": description.stem, "picture": str(target), "wall": wall, "processor": processor}),
              flush=True)
