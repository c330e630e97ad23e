"""Notebooks: stills, the widget with a front end of the test, and its module in a browser."""

from __future__ import annotations

import base64
import json
import queue
import subprocess
import sys
from collections.abc import Mapping
from importlib import import_module
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
import pytest
from browser import open_page
from nbclient.client import NotebookClient
from patience import PATIENCE
from sample_models import SURFCASTD

import surfcast
from surfcast import _navigation, notebook
from surfcast.testing import RunningServer, server

SIZE = (96, 64)
UP = (0.0, 0.0, 1.0)


def test_a_notebook_holds_the_picture_of_the_program(tmp_path: Path, models: Path, running: RunningServer) -> None:
    cells = [
        f"import surfcast; field = surfcast.connect({running.address!r})['field']; field.render(resolution=(96, 64))",
        "field",
        "field.widget(resolution=(96, 64))",
    ]
    books: Any = import_module("nbformat.v4")  # without types
    book = books.new_notebook(cells=[books.new_code_cell(cell) for cell in cells])
    NotebookClient(book, timeout=120, kernel_name="python3", resources={}).execute()
    for cell, size in zip(book.cells, ("96,64", "1280,720", "96,64")):
        command = [SURFCASTD, "render", f"{models}/field.surf", "--resolution", size, "--output", "-"]
        command += ["--format", "png"]
        drawn = subprocess.run(command, check=True, capture_output=True).stdout
        (output,) = cell.outputs
        assert base64.b64decode(output.data["image/png"]) == drawn
    assert "application/javascript" in book.cells[2].outputs[0].data


class FrontEnd:
    """What a browser does: it paints each frame, and keeps what it is told."""

    def __init__(self, widget: notebook.Widget) -> None:
        self.frames: queue.Queue[bytes] = queue.Queue()
        self.messages: list[Mapping[str, Any]] = []
        self.painted: queue.Queue[int] = queue.Queue()
        self.session = widget.connect(self.take)

    def take(self, message: Mapping[str, Any], buffers: list[bytes]) -> None:
        self.messages.append(message)
        if message["kind"] == "frame":
            self.painted.put(message["frame"])
            self.frames.put(buffers[0])

    def send(self, kind: str, **fields: Any) -> None:
        self.session.receive({"kind": kind, **fields})

    def next(self) -> bytes:
        """The next frame, which is painted."""
        frame = self.frames.get(timeout=PATIENCE)
        self.send("painted", frame=self.painted.get())
        return frame

    def wait_for(self, picture: bytes) -> None:
        while self.next() != picture:
            pass


def test_a_widget_shows_the_picture_at_rest_after_each_gesture(field: surfcast.Model, camera: surfcast.Camera) -> None:
    widget = field.widget(camera, resolution=SIZE, color_by="intensity")
    front_end = FrontEnd(widget)
    front_end.send("open")
    front_end.wait_for(field.render(camera, resolution=SIZE, color_by="intensity").data)
    for gesture in (
        {"kind": "orbit", "dx": 20, "dy": -5},
        {"kind": "pan", "dx": 5, "dy": 5},
        {"kind": "zoom", "factor": 1.3},
    ):
        before = widget.camera
        front_end.session.receive(gesture)
        front_end.send("rest")
        assert widget.camera != before
        front_end.wait_for(field.render(widget.camera, resolution=SIZE, color_by="intensity").data)
    front_end.send("fit")
    assert widget.camera == camera
    assert sum(message["kind"] == "taken" for message in front_end.messages) == 7
    widget.close()


def test_a_widget_without_a_camera_shows_the_whole_model(field: surfcast.Model) -> None:
    widget = field.widget(resolution=SIZE)
    front_end = FrontEnd(widget)
    front_end.send("open")
    whole = field.render(resolution=SIZE)
    front_end.wait_for(whole.data)
    assert widget.camera == whole.camera
    widget.close()


def test_a_click_is_a_pick(field: surfcast.Model, camera: surfcast.Camera) -> None:
    hits: list[surfcast.Hit | None] = []
    widget = field.widget(camera, resolution=SIZE, on_pick=hits.append)
    front_end = FrontEnd(widget)
    front_end.send("open")
    front_end.next()
    front_end.send("pick", x=48.4, y=32.2)
    front_end.send("pick", x=0, y=0)
    expected = field.pick((48, 32), camera, resolution=SIZE)
    assert hits[0] is not None and expected is not None and hits[0].surfel == expected.surfel
    assert hits[1] is None
    assert widget.hit is None
    texts = [message["text"] for message in front_end.messages if message["kind"] == "text"]
    assert texts[0].startswith(f"{expected.position[0]:.3f}") and texts[1] == ""
    widget.close()


def test_a_double_click_looks_there(field: surfcast.Model, camera: surfcast.Camera) -> None:
    widget = field.widget(camera, resolution=SIZE)
    front_end = FrontEnd(widget)
    front_end.send("open")
    front_end.send("focus", x=60, y=40)
    hit = field.pick((60, 40), camera, resolution=SIZE)
    assert hit is not None and widget.camera is not None
    np.testing.assert_allclose(widget.camera.focal_point, hit.position)
    widget.close()


def test_a_front_end_is_told_what_goes_wrong(models: Path) -> None:
    with server(models) as running, running.connect(reconnect=0) as client:
        widget = client["field"].widget(resolution=SIZE)
        front_end = FrontEnd(widget)
        front_end.send("open")
        front_end.next()
        running.kill()
        front_end.send("pick", x=5, y=5)
        assert any(message["kind"] == "text" and message["text"] for message in front_end.messages)
        widget.close()


def test_with_anywidget_the_widget_is_one(field: surfcast.Model, monkeypatch: pytest.MonkeyPatch) -> None:
    sent: queue.Queue[tuple[Any, Any]] = queue.Queue()

    class AnyWidget:
        _esm = ""

        def on_msg(self, handler: Any) -> None:
            AnyWidget.handler = handler  # type: ignore[attr-defined]

        def send(self, message: Any, buffers: Any) -> None:
            sent.put((message, buffers))

        def _repr_mimebundle_(self) -> Any:
            return {"application/vnd.jupyter.widget-view+json": {"esm": self._esm}}

    module = ModuleType("anywidget")
    module.AnyWidget = AnyWidget  # type: ignore[attr-defined]
    monkeypatch.setitem(sys.modules, "anywidget", module)
    widget = field.widget(resolution=SIZE)
    shown = widget._repr_mimebundle_()
    assert shown["application/vnd.jupyter.widget-view+json"]["esm"] == notebook.module_text()
    AnyWidget.handler(None, {"kind": "open"}, [])  # type: ignore[attr-defined]
    assert sent.get(timeout=PATIENCE)[0] == {"kind": "size", "width": 96, "height": 64}
    message, buffers = sent.get(timeout=PATIENCE)
    assert message["kind"] == "frame" and len(buffers[0]) > 100
    widget.close()


PAGE = """<!doctype html><body><div id="out"></div><script type="module">
const sent = [];
window.sent = sent;
let receive;
const say = (data, buffers = []) => receive({ content: { data }, buffers });
const frame = Uint8Array.from(atob("FRAME"), (c) => c.charCodeAt(0));
const react = async (message) => {
  if (message.kind === "open") {
    say({ kind: "size", width: 96, height: 64 });
    say({ kind: "frame", frame: 7, type: "image/png" }, [new DataView(frame.buffer)]);
  } else if (message.kind === "painted") {
    drive();
  } else if (message.kind === "orbit") {
    setTimeout(() => say({ kind: "taken" }), 50);
  } else {
    say({ kind: "taken" });
  }
};
const comm = {
  send: (message) => { sent.push(message); setTimeout(() => react(message), 0); },
  on_msg: (listener) => { receive = listener; },
};
const new_comm = (target, data) => { sent.push({ target, data }); return comm; };
window.Jupyter = { notebook: { kernel: { comm_manager: { new_comm } } } };
const drive = () => {
  const canvas = document.querySelector("canvas");
  const box = canvas.getBoundingClientRect();
  const at = (type, x, y, extra = {}) => canvas.dispatchEvent(new PointerEvent(type, {
    pointerId: 1, clientX: box.left + x, clientY: box.top + y, buttons: 1, bubbles: true, ...extra }));
  at("pointerdown", 10, 10); at("pointermove", 14, 11); at("pointermove", 16, 12); at("pointermove", 21, 15);
  at("pointerup", 21, 15);
  at("pointerdown", 30, 20); at("pointerup", 30, 20);
  canvas.dispatchEvent(new WheelEvent("wheel", { deltaY: -100, cancelable: true }));
  canvas.dispatchEvent(new KeyboardEvent("keydown", { key: "ArrowLeft" }));
  say({ kind: "text", text: "a hit" });
};
const script = SCRIPT;
new Function("element", script)(document.querySelector("#out"));
</script></body>"""


async def test_the_module_of_the_browser_paints_frames_and_sends_gestures_one_by_one(
    tmp_path: Path, field: surfcast.Model, camera: surfcast.Camera
) -> None:
    picture = field.render(camera, resolution=SIZE)
    widget = field.widget(camera, resolution=SIZE)
    script = widget._repr_mimebundle_()["application/javascript"]
    frame = base64.b64encode(picture.data).decode()
    page = PAGE.replace("FRAME", frame).replace("SCRIPT", json.dumps(script).replace("</", "<\\/"))
    (tmp_path / "page.html").write_text(page)
    async with open_page((tmp_path / "page.html").as_uri(), tmp_path / "profile") as browser:
        await browser.wait_for("window.sent?.length >= 10")
        values = "Array.from(document.querySelector('canvas').getContext('2d').getImageData(0, 0, 96, 64).data)"
        pixels = np.array(await browser.evaluate(values), dtype=np.uint8).reshape(64, 96, 4)
        text = await browser.evaluate("document.querySelector('#out').textContent")
        messages = await browser.evaluate("window.sent")
    np.testing.assert_array_equal(pixels[:, :, :3], picture.array)
    assert text == "a hit"
    opened, *sent = messages
    assert opened["target"] == "surfcast.view"
    # The second and the third move of the pointer became one while the first one was under way.
    assert sent == [
        {"kind": "open"},
        {"kind": "painted", "frame": 7},
        {"kind": "orbit", "dx": 4, "dy": 1},
        {"kind": "orbit", "dx": 7, "dy": 4},
        {"kind": "rest"},
        {"kind": "pick", "x": 30, "y": 20},
        {"kind": "zoom", "factor": pytest.approx(np.exp(0.15))},
        {"kind": "orbit", "dx": -20, "dy": 0},
        {"kind": "rest"},
    ]
    widget.close()


def test_a_drag_over_the_height_turns_to_the_other_side(camera: surfcast.Camera) -> None:
    turned = _navigation.orbit(camera, UP, 64, 0, 64)
    arm = np.subtract(camera.position, camera.focal_point)
    np.testing.assert_allclose(np.subtract(turned.position, turned.focal_point), arm * (-1, -1, 1), atol=1e-9)


def test_a_camera_stays_upright(camera: surfcast.Camera) -> None:
    for dy in (-1000, 1000):
        turned = _navigation.orbit(camera, UP, 0, dy, 64)
        arm = np.subtract(turned.position, turned.focal_point)
        distance = surfcast.measure.distance(camera.position, camera.focal_point)
        assert np.linalg.norm(arm) == pytest.approx(distance)
        assert np.linalg.norm(arm[:2]) / np.linalg.norm(arm) == pytest.approx(np.sin(np.radians(0.5)))


def test_the_focal_point_follows_the_pointer(camera: surfcast.Camera) -> None:
    """The former focal point is seen where it was dragged to."""
    moved = _navigation.pan(camera, UP, 10, 6, 64)
    arm = np.subtract(moved.position, moved.focal_point)
    towards = -arm / np.linalg.norm(arm)
    right = np.cross(towards, UP)
    right /= np.linalg.norm(right)
    seen = np.subtract(camera.focal_point, moved.position)
    scale = 64 / (2 * np.tan(np.radians(15))) / np.dot(seen, towards)
    np.testing.assert_allclose(
        (scale * np.dot(seen, right), -scale * np.dot(seen, np.cross(right, towards))), (10, 6), rtol=1e-9
    )


def test_zooming_brings_the_focal_point_nearer(camera: surfcast.Camera) -> None:
    near = _navigation.zoom(camera, 2)
    assert near.focal_point == camera.focal_point
    distance = surfcast.measure.distance(camera.position, camera.focal_point)
    assert surfcast.measure.distance(near.position, near.focal_point) == pytest.approx(distance / 2)
