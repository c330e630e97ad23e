"""A view of a model in a notebook. Its frames go through the kernel, so the browser needs no way to the server.

With anywidget it is shown by every front end that anywidget knows; without it by the classic notebook. What a notebook
keeps is a picture.
"""

from __future__ import annotations

import base64
import itertools
import json
import threading
from collections.abc import Callable, Mapping
from importlib import import_module, resources
from typing import TYPE_CHECKING, Any

import numpy as np

from . import _navigation
from ._values import Camera, Hit
from ._view import Frame, View
from .errors import ConnectionLost, Error

if TYPE_CHECKING:
    from ._sync import Model, Runner

_TARGET = "surfcast.view"
_TYPES = {"png": "image/png", "jpg": "image/jpeg", "webp": "image/webp"}
_numbers = itertools.count(1)
_widgets: dict[int, Widget] = {}

Send = Callable[[Mapping[str, Any], list[bytes]], object]

# Runs where the classic notebook shows an output. It makes of a bare comm what anywidget calls a model.
_LOADER = """
(async (element) => {
  const jupyter = window.Jupyter;
  if (!jupyter?.notebook?.kernel) {
    const still = new Image();
    still.src = "data:image/png;base64,STILL";
    element.append(still, document.createElement("br"), "This notebook shows views with the package anywidget.");
    return;
  }
  const address = URL.createObjectURL(new Blob([SOURCE], { type: "text/javascript" }));
  const { default: widget } = await import(address);
  URL.revokeObjectURL(address);
  const comm = jupyter.notebook.kernel.comm_manager.new_comm("TARGET", { widget: NUMBER });
  const listeners = new Set();
  comm.on_msg(({ content, buffers }) => listeners.forEach((listener) => listener(content.data, buffers)));
  widget.render({
    el: element,
    model: {
      send: (message) => comm.send(message),
      on: (_, listener) => listeners.add(listener),
      off: (_, listener) => listeners.delete(listener),
    },
  });
})(element[0] ?? element);
"""


def module_text() -> str:
    """The module of the front end."""
    return resources.files("surfcast").joinpath("widget.js").read_text()


class Session:
    """One front end: takes its gestures, and sends it frames."""

    def __init__(self, widget: Widget, send: Send) -> None:
        self._widget = widget
        self._send = send
        self._frames: dict[int, Frame] = {}
        self._lock = threading.Lock()
        self._view: Any = None
        self._pump: Any = None
        self._moving = False

    def receive(self, message: Mapping[str, Any]) -> None:
        """Takes a message of the front end. Errors of the server are shown there."""
        kind = message.get("kind")
        try:
            if kind == "open":
                self._open()
            elif kind == "close":
                self.close()
            elif kind == "painted":
                self._painted(int(message["frame"]))
            elif self._view is not None:
                self._gesture(str(kind), message)
        except Error as error:
            self.say(str(error))
        finally:
            if kind not in ("open", "close", "painted"):
                self._send({"kind": "taken"}, [])

    def say(self, text: str) -> None:
        """Shows a text below the picture."""
        self._send({"kind": "text", "text": text}, [])

    def close(self) -> None:
        view, self._view = self._view, None
        if view is None:
            return
        self._pump.cancel()
        try:
            self._widget.runner.run(view.close())
        except ConnectionLost:
            pass  # the view ended with its server

    def _open(self) -> None:
        self.close()
        self._frames.clear()
        width, height = self._widget.resolution
        self._send({"kind": "size", "width": width, "height": height}, [])
        self._view = self._widget.open_view()
        self._widget.runner.run(self._view.__aenter__())
        self._pump = self._widget.runner.start(self._send_frames(self._view))

    async def _send_frames(self, view: View) -> None:
        try:
            async for frame in view:
                self._send_frame(frame)
        except Error as error:
            self.say(str(error))

    def _send_frame(self, frame: Frame) -> None:
        with self._lock:
            number = next(_numbers)
            self._frames[number] = frame
        self._widget.take_frame(frame)
        kind = _TYPES[frame.picture.format]
        self._send({"kind": "frame", "frame": number, "type": kind}, [frame.picture.data])

    def _painted(self, number: int) -> None:
        with self._lock:
            frame = self._frames.pop(number, None)
        if frame is not None and self._view is not None:
            self._widget.runner.run(self._view.painted(frame))

    def _gesture(self, kind: str, message: Mapping[str, Any]) -> None:
        if kind == "pick":
            self._widget.pick(message, self)
            self._rest()
        elif kind == "rest":
            self._rest()
        elif camera := self._widget.moved(kind, message):
            self._moving = True
            self._widget.runner.run(self._view.update(camera, moving=True))

    def _rest(self) -> None:
        if self._moving:
            self._moving = False
            self._widget.runner.run(self._view.update())


class Widget:
    """A view of a model that is turned, moved and zoomed with the pointer. Made by `Model.widget`.

    `camera` is the one that is shown, `hit` what was picked last. `on_pick` is called with each hit, or None for the
    background.
    """

    def __init__(
        self,
        model: Model,
        camera: Camera | None,
        resolution: tuple[int, int],
        on_pick: Callable[[Hit | None], None] | None,
        options: Mapping[str, Any],
    ) -> None:
        self.resolution = resolution
        self.hit: Hit | None = None
        self.runner: Runner = model._runner
        self._model = model
        self._first = camera
        self._camera = camera
        self._on_pick = on_pick
        self._options = dict(options)
        self._vertical = np.array((0.0, 0.0, 1.0) if model.z_up else (0.0, 1.0, 0.0))
        self._sessions: list[Session] = []
        self._number = next(_numbers)
        _widgets[self._number] = self

    @property
    def camera(self) -> Camera | None:
        """The camera that is shown. None: there is no frame yet."""
        return self._camera

    def connect(self, send: Send) -> Session:
        """A session for a front end to which `send` carries messages."""
        session = Session(self, send)
        self._sessions.append(session)
        return session

    def close(self) -> None:
        """Ends the views of all front ends."""
        _widgets.pop(self._number, None)
        for session in self._sessions:
            session.close()
        self._sessions.clear()

    def open_view(self) -> View:
        options: Any = self._options
        return self._model._model.view(self._camera, acknowledge=False, resolution=self.resolution, **options)

    def take_frame(self, frame: Frame) -> None:
        """The first frame tells the camera that shows the whole model."""
        if self._camera is None:
            self._camera = frame.picture.camera
        if self._first is None:
            self._first = frame.picture.camera

    def moved(self, kind: str, message: Mapping[str, Any]) -> Camera | None:
        """The camera after a gesture; None if it stays."""
        camera, height = self._camera, self.resolution[1]
        if camera is None:
            return None
        if kind in ("orbit", "pan"):
            move = _navigation.orbit if kind == "orbit" else _navigation.pan
            camera = move(camera, self._vertical, float(message["dx"]), float(message["dy"]), height)
        elif kind == "zoom":
            camera = _navigation.zoom(camera, float(message["factor"]))
        elif kind == "fit" and self._first is not None:
            camera = self._first
        elif kind == "focus":
            hit = self._hit_at(message)
            camera = camera if hit is None else _navigation.focus(camera, hit.position)
        self._camera = camera
        return camera

    def pick(self, message: Mapping[str, Any], session: Session) -> None:
        """Picks at a pixel, shows the hit below the picture, and tells `on_pick`."""
        self.hit = self._hit_at(message)
        session.say("" if self.hit is None else _line_of(self.hit))
        if self._on_pick is not None:
            self._on_pick(self.hit)

    def _hit_at(self, message: Mapping[str, Any]) -> Hit | None:
        width, height = self.resolution
        pixel = (min(max(int(message["x"]), 0), width - 1), min(max(int(message["y"]), 0), height - 1))
        options: Any = {name: value for name, value in self._options.items() if name not in ("format", "quality")}
        return self._model.pick(pixel, self._camera, resolution=self.resolution, **options)

    def _still(self) -> bytes:
        options: Any = self._options
        return self._model.render(self._camera, resolution=self.resolution, **options).data

    def _repr_mimebundle_(self, include: Any = None, exclude: Any = None) -> Any:
        shown = _by_anywidget(self)
        if shown is not None:
            return shown
        _register_target()
        still = self._still()
        script = _LOADER.replace("TARGET", _TARGET).replace("NUMBER", str(self._number))
        script = script.replace("STILL", base64.b64encode(still).decode())
        return {
            "application/javascript": script.replace("SOURCE", json.dumps(module_text())),
            "image/png": still,
            "text/plain": repr(self),
        }

    def __repr__(self) -> str:
        return f"<surfcast.Widget of {self._model.name}>"


def _line_of(hit: Hit) -> str:
    position = ", ".join(f"{part:.3f}" for part in hit.position)
    return f"{position}   " + "  ".join(f"{name} {value:g}" for name, value in hit.attributes.items())


def _by_anywidget(widget: Widget) -> Any:
    """The widget as anywidget shows it; None where that is not installed."""
    try:
        anywidget = import_module("anywidget")
    except ImportError:
        return None
    shown = type("SurfcastView", (anywidget.AnyWidget,), {"_esm": module_text()})()
    session = widget.connect(lambda message, buffers: shown.send(dict(message), buffers))
    shown.on_msg(lambda _, message, __: session.receive(message))
    return shown._repr_mimebundle_()


def _register_target() -> None:
    """Lets the kernel take the comms that the loader opens."""
    kernel = getattr(import_module("IPython").get_ipython(), "kernel", None)
    if kernel is not None:
        kernel.comm_manager.register_target(_TARGET, _take_comm)


def _take_comm(comm: Any, opened: Mapping[str, Any]) -> None:
    widget = _widgets.get(opened["content"]["data"].get("widget"))
    if widget is None:
        comm.close()
        return
    session = widget.connect(lambda message, buffers: comm.send(dict(message), buffers=buffers))
    comm.on_msg(lambda message: session.receive(message["content"]["data"]))
    comm.on_close(lambda _: session.close())
