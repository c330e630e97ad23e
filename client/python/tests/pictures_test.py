"""Pictures: their bytes are those of the other interfaces, whatever is asked for."""

from __future__ import annotations

import json
import re
import subprocess
from collections.abc import Mapping
from pathlib import Path
from typing import Any
from urllib.parse import quote
from urllib.request import urlopen

import numpy as np
import pytest
from sample_models import OFFSET, SURFCAST, SURFCASTD, Scan

import surfcast
from surfcast._options import OPTIONS, picture_request
from surfcast._plain_options import PLAIN_FIELDS
from surfcast.testing import RunningServer

SIZE = (96, 64)
BOX = (*(OFFSET + (5, 5, -10)), *(OFFSET + (20, 20, 10)))
BOX_TEXT = ",".join(map(repr, map(float, BOX)))
LIGHTS = {
    "ambient": 0.1,
    "specular": 0.2,
    "exponent": 20,
    "lights": [{"direction": (1, 2, -1), "power": 0.7}, {"direction": (0, 0, -1), "power": 0.5}],
}
POINTS = [(0, 0, 0, 0, 0.0), (900, 255, 250, 240, 0.3)]


def over_http(running: RunningServer, model: str, options: Mapping[str, str]) -> bytes:
    query = "&".join(f"{name}={quote(value)}" for name, value in options.items())
    with urlopen(f"{running.url}api/models/{model}/image?resolution=96,64&{query}") as answer:
        data: bytes = answer.read()
    return data


@pytest.mark.parametrize(
    ("model", "option", "value", "text"),
    [
        ("field", "normalization", "surfel", "surfel"),
        ("field", "filter", "none", "none"),
        ("field", "spacing", 3, "3"),
        ("field", "shading", "lit", "lit"),
        ("field", "splat_convention", "exact", "exact"),
        ("field", "background", (10, 20, 30), "10,20,30"),
        ("field", "color_by", "intensity", "intensity"),
        ("field", "color_by", "classification", "classification"),
        ("field", "hide_classes", [6], "6"),
        ("ball+tensors", "hide_models", ["tensors"], "tensors"),
        ("field", "clip_box", surfcast.Box(BOX[:3], BOX[3:]), BOX_TEXT),
        ("field", "clip_out", [(BOX[:3], BOX[3:])], BOX_TEXT),
        ("field", "eye_dome", 1.0, "1"),
        ("field", "eye_dome", (2, 3), "2,3"),
        ("field", "opacity", 0.5, "0.5"),
        ("field", "opacity_by_class", {6: 0.25, 2: 1}, "6=0.25,2=1"),
        ("field", "xray", "density", "density"),
        ("field", "format", "jpg", "jpg"),
        ("field", "format", "webp", "webp"),
        ("ball", "transfer", "ct-bone", "ct-bone"),
        ("ball", "transfer", ("gray", 100, 900), "gray,100,900"),
        ("ball", "transfer", POINTS, "0,0,0,0,0;900,255,250,240,0.3"),
        ("ball", "shaded", False, "off"),
        ("ball", "iso", 400, "400"),
        ("ball", "iso", [(400, 230, 200, 180, 0.3), 800], "400,230,200,180,0.3;800"),
        ("ball", "slice", [("k", 12)], "k,12"),
        ("ball", "slice", [(12, 12, 12, 0, 1, 1)], "12,12,12,0,1,1"),
        ("ball", "medium", False, "off"),
        ("tensors", "color_by", "dec", "dec"),
        ("tensors", "color_by", "fa", "fa"),
        ("tensors", "color_by", "attribute:weight", "attribute:weight"),
        ("tensors", "glyph", "superquadric", "superquadric"),
        ("tensors", "glyph", ("superquadric", 5), "superquadric,5"),
        ("tensors", "glyph_radius", "root", "root"),
        ("tensors", "glyph_scale", 1.5, "1.5"),
        ("tensors", "threshold", [("fa", 0.3), ("weight", 2, 8)], "fa,0.3;weight,2,8"),
        ("tensors", "lights", LIGHTS, "0.1,0.2,20;1,2,-1,0.7;0,0,-1,0.5"),
    ],
)
def test_an_option_means_what_it_means_over_http(
    running: RunningServer, client: surfcast.Server, model: str, option: str, value: Any, text: str
) -> None:
    options: Any = {option: value}
    picture = client[model].render(resolution=SIZE, **options)
    assert picture.data == over_http(running, model, {option: text})
    assert option in ("format", "splat_convention") or picture.data != client[model].render(resolution=SIZE).data


def test_a_spacing_is_chosen_for_an_error_or_a_time(running: RunningServer, field: surfcast.Model) -> None:
    picture = field.render(resolution=SIZE, error=35)
    assert picture.expected_error >= 34 and picture.expected_ms > 0
    assert picture.data == field.render(resolution=SIZE, spacing=picture.spacing).data
    plenty = field.render(resolution=SIZE, time=1e7)
    assert plenty.spacing == 0 and plenty.expected_error == float("inf")
    assert plenty.data == field.render(resolution=SIZE).data == over_http(running, "field", {"time": "1e7"})
    assert field.render(resolution=SIZE).expected_ms == 0
    quick = field.render(resolution=SIZE, time=1e-3)
    assert 0 < quick.render_scale < 1
    stated = field.render(resolution=SIZE, spacing=quick.spacing, render_scale=quick.render_scale)
    assert quick.data == stated.data and stated.render_scale == quick.render_scale
    with pytest.raises(surfcast.InvalidInput, match="at most one"):
        field.render(resolution=SIZE, error=35, time=100)
    with pytest.raises(surfcast.InvalidInput, match="error"):
        field.render(resolution=SIZE, error=0)


def test_the_headers_state_the_spacing_that_was_chosen(running: RunningServer, field: surfcast.Model) -> None:
    with urlopen(f"{running.url}api/models/field/image?resolution=96,64&error=35") as answer:
        data, headers = answer.read(), dict(answer.headers)
    assert float(headers["X-Surfcast-Expected-Error"]) >= 34
    assert float(headers["X-Surfcast-Expected-Ms"]) > 0
    assert data == field.render(resolution=SIZE, spacing=float(headers["X-Surfcast-Spacing"])).data


def test_options_that_belong_together_are_drawn_as_over_http(running: RunningServer, field: surfcast.Model) -> None:
    jpeg = field.render(resolution=SIZE, format="jpg", quality=40)
    assert jpeg.data == over_http(running, "field", {"format": "jpg", "quality": "40"})
    ranged = field.render(resolution=SIZE, color_by="elevation", color_map="turbo", color_range=(98, 103))
    wanted = {"color_by": "elevation", "color_map": "turbo", "color_range": "98,103"}
    assert ranged.data == over_http(running, "field", wanted)
    ghost = field.render(resolution=SIZE, clip_out=[(BOX[:3], BOX[3:])], ghost=0.2)
    assert ghost.data == over_http(running, "field", {"clip_out": BOX_TEXT, "ghost": "0.2"})


def test_options_are_those_of_the_command_line() -> None:
    text = subprocess.run([SURFCAST, "render", "--help"], check=True, capture_output=True, text=True).stdout
    flags = re.findall(r"^ +--([a-z-]+) .*Env:", text, re.MULTILINE)
    of_the_program = {"output", "stats", "path", "view_seconds", "fps"}
    of_the_program |= {"connect_timeout", "timeout", "ca", "token_file"}
    names = {flag.replace("-", "_") for flag in flags if not flag.startswith("camera")}
    assert names - of_the_program == set(OPTIONS)


@pytest.mark.parametrize("name", PLAIN_FIELDS)
def test_plain_options_are_members_of_the_message(name: str) -> None:
    field = PLAIN_FIELDS[name]
    of_kinds: dict[str, Any] = {"switch": True, "number": 0.5, "color": (1, 2, 255)}
    value: Any = field.names[-1] if field.kind == "choice" else of_kinds[field.kind]
    assert picture_request("field", None, {name: value}) != picture_request("field", None, {})
    with pytest.raises(surfcast.InvalidInput, match=f"{name}: expected "):
        picture_request("field", None, {name: "none of them"})


def test_a_picture_is_that_of_the_program(
    tmp_path: Path, models: Path, field: surfcast.Model, camera: surfcast.Camera
) -> None:
    (tmp_path / "camera.json").write_text(json.dumps(camera.to_dict()))
    target = tmp_path / "program.png"
    command = [SURFCASTD, "render", f"{models}/field.surf", "--camera", f"{tmp_path}/camera.json"]
    command += ["--resolution", "160,120", "--output", str(target)]
    subprocess.run(command, check=True, capture_output=True)
    field.render(camera, resolution=(160, 120)).save(tmp_path / "client.png")
    assert (tmp_path / "client.png").read_bytes() == target.read_bytes()


def test_a_picture_is_an_array_with_the_top_row_first(field: surfcast.Model, camera: surfcast.Camera) -> None:
    picture = field.render(camera, resolution=SIZE, background=(1, 2, 3))
    assert picture.array.shape == (64, 96, 3)
    assert picture.array.dtype == np.uint8
    assert tuple(picture.array[0, 0]) == (1, 2, 3)  # the corner is beyond the field
    assert picture.converged and not picture.preview
    assert picture.camera.view_up is not None and picture.camera.view_angle == 30
    assert {"queue", "splat", "encode"} <= set(picture.stages)


def test_channels_of_exr_agree_with_picks(field: surfcast.Model, camera: surfcast.Camera) -> None:
    picture = field.render(camera, resolution=SIZE, format="exr", channels=["depth", "position", "surfel"])
    hit = field.pick((48, 32), camera, resolution=SIZE)
    assert hit is not None
    assert picture.channels["Z"][32, 48] == np.float32(hit.depth)
    assert picture.channels["id"][32, 48] == hit.surfel
    assert picture.origin is not None
    np.testing.assert_array_equal(picture.origin, picture.camera.position)
    front = picture.origin + [picture.channels[f"P.{axis}"][32, 48] for axis in "XYZ"]
    assert np.linalg.norm(front - hit.position) < 0.5
    assert picture.array.dtype == np.float32 and picture.array.shape == (64, 96, 3)


def test_exr_in_linear_light_agrees_with_png(field: surfcast.Model, camera: surfcast.Camera) -> None:
    linear = field.render(camera, resolution=SIZE, format="exr").array.astype(np.float64)
    srgb = np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * np.maximum(linear, 0) ** (1 / 2.4) - 0.055)
    png = field.render(camera, resolution=SIZE).array
    assert np.abs(255 * srgb - png).max() <= 0.51


def test_frames_of_a_path_are_those_of_the_program(tmp_path: Path, models: Path, field: surfcast.Model) -> None:
    centre = OFFSET + (15, 15, 0)
    keyframes = [
        {"time": t, "position": list(centre + p), "focal_point": list(centre), "view_up": up, "view_angle": angle}
        for t, p, up, angle in (
            (0, (0, -30, 25), [0, 0, 1], 30),
            (0.5, (20, -20, 15), [0, 0.2, 1], 35),
            (2, (30, 0, 12), [0.1, 0, 1], 25),
        )
    ]
    path = tmp_path / "path.json"
    path.write_text(json.dumps({"keyframes": keyframes}))
    command = [SURFCASTD, "render", f"{models}/field.surf", "--resolution", "64,48", "--path", str(path), "--fps", "2"]
    subprocess.run([*command, "--output", f"{tmp_path}/frame_%d.png"], check=True, capture_output=True)
    pictures = list(field.render_path(surfcast.CameraPath.read(path), fps=2, resolution=(64, 48)))
    assert [picture.data for picture in pictures] == [
        (tmp_path / f"frame_{number}.png").read_bytes() for number in range(5)
    ]


def test_a_flight_through_saved_views_is_that_of_the_program(
    tmp_path: Path, models: Path, field: surfcast.Model
) -> None:
    centre = OFFSET + (15, 15, 0)

    def text(values: Any) -> str:
        return ",".join(repr(float(value)) for value in values)

    places: list[tuple[tuple[int, int, int], dict[str, str]]] = [
        ((0, -30, 25), {}),
        ((20, -20, 15), {"view_angle": "40"}),
    ]
    saved = [
        surfcast.SavedView(
            f"View {number}",
            {"position": text(centre + place), "focal_point": text(centre), "view_up": "0,0,1", **angle},
        )
        for number, (place, angle) in enumerate(places)
    ]
    path = tmp_path / "views.json"
    views = [{"name": view.name, "parameters": dict(view.parameters)} for view in saved]
    path.write_text(json.dumps({"format": "surfcast-views", "version": 1, "model": "field", "views": views}))
    command = [SURFCASTD, "render", f"{models}/field.surf", "--resolution", "64,48", "--path", str(path)]
    command += ["--view-seconds", "2", "--fps", "1", "--output", f"{tmp_path}/frame_%d.png"]
    subprocess.run(command, check=True, capture_output=True)
    frames = [(tmp_path / f"frame_{number}.png").read_bytes() for number in range(3)]
    read = surfcast.CameraPath.read(path, seconds_per_view=2)
    assert [picture.data for picture in field.render_path(read, fps=1, resolution=(64, 48))] == frames
    assert surfcast.CameraPath.through(saved, 2).keyframes == read.keyframes
    wrong = surfcast.SavedView("Wrong", {"position": "1,x,0", "focal_point": "0,0,0", "view_up": "0,0,1"})
    with pytest.raises(surfcast.InvalidInput, match="Wrong"):
        surfcast.CameraPath.through([saved[0], wrong])


def test_a_model_tells_what_it_holds(field: surfcast.Model, scan: Scan) -> None:
    assert field.surfels == len(scan.xyz)
    np.testing.assert_allclose(field.bounds, (scan.xyz.min(axis=0), scan.xyz.max(axis=0)), atol=1e-3)
    assert field.bounds[0][2] <= field.elevation[0] < field.elevation[1] <= field.bounds[1][2]
    assert set(field.attributes) >= {"intensity", "classification"}
    assert field.classes == {code: int((scan.classification == code).sum()) for code in (2, 6)}
    assert field.ranges["intensity"].largest == scan.intensity.max()
    assert field.z_up


def test_a_volume_tells_its_grid(ball: surfcast.Model) -> None:
    (volume,) = ball.info().volumes
    assert volume.size == (24, 24, 24)
    assert volume.spacing == (1, 1, 1)
    assert volume.histogram.sum() == 24**3
    values = [point.value for point in volume.presets["gray"]]
    assert volume.low <= values[0] < values[-1] <= volume.high
    assert set(volume.presets) == {"auto", "gray", "ct-bone", "ct-soft", "mr"}


def test_a_table_of_ellipsoids_tells_its_ranges(client: surfcast.Server) -> None:
    tensors = client["tensors"].info()
    (ellipsoids,) = tensors.ellipsoids
    assert tensors.kinds == {"ellipsoid": 36} and ellipsoids.drawn == ellipsoids.samples == 36
    assert ellipsoids.tensors and (ellipsoids.ranges["weight"].smallest, ellipsoids.ranges["weight"].largest) == (0, 10)


def test_files_of_options_are_read(tmp_path: Path, client: surfcast.Server) -> None:
    (tmp_path / "lights.json").write_text(json.dumps(LIGHTS))
    points = [{"value": v, "color": [r, g, b], "opacity": a} for v, r, g, b, a in POINTS]
    (tmp_path / "transfer.json").write_text(json.dumps({"points": points}))
    tensors, ball = client["tensors"], client["ball"]
    lit = tensors.render(resolution=SIZE, lights=tmp_path / "lights.json")
    assert lit.data == tensors.render(resolution=SIZE, lights=LIGHTS).data
    shown = ball.render(resolution=SIZE, transfer=tmp_path / "transfer.json")
    assert shown.data == ball.render(resolution=SIZE, transfer=POINTS).data


def test_a_picture_is_saved_under_its_own_format_alone(tmp_path: Path, field: surfcast.Model) -> None:
    picture = field.render(resolution=SIZE)
    with pytest.raises(surfcast.InvalidInput, match="png"):
        picture.save(tmp_path / "picture.jpg")
    picture.save(tmp_path / "picture.png")
    assert [file.name for file in tmp_path.iterdir()] == ["picture.png"]
