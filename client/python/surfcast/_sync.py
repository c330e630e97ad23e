"""The client for programs without asyncio: each server has an event loop in a thread of its own."""

from __future__ import annotations

import asyncio
import threading
import weakref
from collections.abc import Callable, Coroutine, Iterable, Iterator
from concurrent.futures import CancelledError, Future
from contextlib import suppress
from os import PathLike
from types import TracebackType
from typing import TYPE_CHECKING, Any, Generic, TypeVar, Unpack

from . import aio
from ._options import DisplayOptions, PictureOptions, RegionOptions, ViewOptions
from ._picture import Picture
from ._values import Annotations, Camera, CoordinateSystem, Hit, ModelInfo, Points, Range, Scan, Uploads, Vector
from ._view import Frame
from .camera_path import CameraPath
from .errors import ConnectionLost, Unavailable

if TYPE_CHECKING:
    from .notebook import Widget

T = TypeVar("T")


class _Call(Generic[T]):
    """A coroutine that can be cancelled at any time."""

    def __init__(self, work: Coroutine[Any, Any, T]) -> None:
        self._work = work
        self._task: asyncio.Task[Any] | None = None
        self._cancelled = False

    async def run(self) -> T:
        if self._cancelled:
            raise asyncio.CancelledError
        self._task = asyncio.current_task()
        return await self._work

    def cancel(self) -> None:
        """In the thread of the event loop, or of a call whose coroutine will not run."""
        self._cancelled = True
        if self._task is not None:
            self._task.cancel()
        else:
            self._work.close()


class Runner:
    """An event loop in a thread. It ends when it is stopped, or with the program; `at_end` is run before."""

    def __init__(self, at_end: Callable[[], Coroutine[Any, Any, None]] | None = None) -> None:
        self._at_end = at_end
        self._lock = threading.Lock()
        self._ending = False
        self._loop = asyncio.new_event_loop()
        self._thread = threading.Thread(target=self._serve, name="surfcast", daemon=True)
        self._thread.start()

    def run(self, work: Coroutine[Any, Any, T]) -> T:
        """The result of a coroutine. Whatever interrupts the call cancels the coroutine."""
        call = _Call(work)
        try:
            return self.start(call.run()).result()
        except CancelledError:
            raise ConnectionLost("the connection is closed") from None  # while the coroutine waited
        except BaseException:
            # Also where it was interrupted before it had the future: the coroutine may run already.
            with self._lock:
                if self._ending:
                    call.cancel()
                else:
                    self._loop.call_soon_threadsafe(call.cancel)
            raise

    def start(self, work: Coroutine[Any, Any, T]) -> Future[T]:
        """Starts a coroutine. Raises ConnectionLost once the loop ends."""
        with self._lock:
            if not self._ending:
                return asyncio.run_coroutine_threadsafe(work, self._loop)
        work.close()
        raise ConnectionLost("the connection is closed")

    def stop(self) -> None:
        with self._lock:
            if not self._ending:
                self._ending = True
                self._loop.call_soon_threadsafe(self._loop.stop)
        if threading.current_thread() is not self._thread:
            self._thread.join()

    def _serve(self) -> None:
        asyncio.set_event_loop(self._loop)
        self._loop.run_forever()
        if self._at_end is not None:
            self._loop.run_until_complete(self._at_end())
        tasks = asyncio.all_tasks(self._loop)
        for task in tasks:
            task.cancel()
        self._loop.run_until_complete(asyncio.gather(*tasks, return_exceptions=True))
        self._loop.close()


class Server:
    """A server and the models that it serves. May be used by several threads."""

    def __init__(self, address: str, **settings: Any) -> None:
        server = aio.connect(address, **settings)  # refuses wrong addresses before there is a thread
        self._runner = Runner(at_end=server.close)
        self._server = server
        self._stop = weakref.finalize(self, self._runner.stop)
        try:
            self._runner.run(server.__aenter__())
        except BaseException:
            self.close()
            raise

    def __enter__(self) -> Server:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def close(self) -> None:
        """Ends the connection. Requests under way raise ConnectionLost."""
        self._stop()

    @property
    def address(self) -> str:
        """HOST:PORT."""
        return self._server.address

    @property
    def version(self) -> str:
        """Name and version of the server's program."""
        return self._runner.run(self._server.version())

    @property
    def protocol(self) -> tuple[int, int]:
        """Major and minor version of the server's protocol."""
        return self._runner.run(self._server.protocol())

    def ping(self, *, timeout: float | None = None) -> float:
        """Seconds from a request to its answer, whatever is being drawn."""
        return self._runner.run(self._server.ping(timeout=timeout))

    def models(self, *, timeout: float | None = None) -> list[str]:
        """The names of the models, sorted."""
        return self._runner.run(self._server.models(timeout=timeout))

    def scans(self, *, timeout: float | None = None) -> list[Scan]:
        """The scans whose models are not complete."""
        return self._runner.run(self._server.scans(timeout=timeout))

    def uploads(self, *, timeout: float | None = None) -> Uploads | None:
        """Which files the server takes. None: it takes none."""
        return self._runner.run(self._server.uploads(timeout=timeout))

    def upload(
        self, path: str | PathLike[str], name: str | None = None, *, timeout: float | None = None
    ) -> Model | None:
        """Sends a scan, under its own name or another, and returns its model, which `wait_complete` waits for.

        None: a file that others name, such as samples or textures. The timeout is for each step of the transfer.
        """
        model = self._runner.run(self._server.upload(path, name, timeout=timeout))
        return None if model is None else Model(self, self._runner, model)

    def __getitem__(self, name: str) -> Model:
        """A model by its name, or a scan of which there is none yet. Raises NotFound otherwise."""
        return Model(self, self._runner, self._runner.run(self._server.model(name)))

    def __iter__(self) -> Iterator[str]:
        return iter(self.models())

    def __contains__(self, name: object) -> bool:
        return name in self.models()

    def __repr__(self) -> str:
        return f"<surfcast.Server {self.address}>"


class Model:
    """A model of a server. In a notebook it shows as a picture of the whole model."""

    def __init__(self, server: Server, runner: Runner, model: aio.Model) -> None:
        self._server = server  # keeps the connection
        self._runner = runner
        self._model = model
        self._info: ModelInfo | None = None

    @property
    def name(self) -> str:
        """The name under which it is served."""
        return self._model.name

    @property
    def server(self) -> Server:
        """The server that serves it."""
        return self._server

    def info(self, *, timeout: float | None = None) -> ModelInfo:
        """What the model holds, asked anew: previews of scans grow."""
        self._info = self._runner.run(self._model.info(timeout=timeout))
        return self._info

    @property
    def surfels(self) -> int:
        """How many surfels the model has."""
        return self._known().surfels

    @property
    def bounds(self) -> Any:
        """The lower and the upper corner in world coordinates: a 2 x 3 array of float64."""
        return self._known().bounds

    @property
    def elevation(self) -> tuple[float, float]:
        """The lowest and the highest elevation, without outliers."""
        return self._known().elevation

    @property
    def attributes(self) -> tuple[str, ...]:
        """The names of the attributes."""
        return self._known().attributes

    @property
    def ranges(self) -> dict[str, Range]:
        """The values of the attributes."""
        return dict(self._known().ranges)

    @property
    def classes(self) -> dict[int, int]:
        """The number of surfels by classification code."""
        return dict(self._known().classes)

    @property
    def z_up(self) -> bool:
        """Whether the vertical axis is z; otherwise it is y."""
        return self._known().z_up

    @property
    def crs(self) -> CoordinateSystem | None:
        """The system of world coordinates. None: not known."""
        return self._known().crs

    def render(
        self, camera: Camera | None = None, *, timeout: float | None = None, **options: Unpack[PictureOptions]
    ) -> Picture:
        """The converged picture; without a camera one of the whole model, 1280 x 720, PNG."""
        return self._runner.run(self._model.render(camera, timeout=timeout, **options))

    def render_path(
        self,
        path: CameraPath | Iterable[Camera],
        fps: float = 30.0,
        *,
        timeout: float | None = None,
        **options: Unpack[PictureOptions],
    ) -> Iterator[Picture]:
        """The pictures of the frames of a camera path, or of cameras. The next one is drawn meanwhile."""
        pictures: Any = self._model.render_path(path, fps, timeout=timeout, **options)
        try:
            while True:
                try:
                    picture = self._runner.run(_next(pictures))
                except StopAsyncIteration:
                    return
                yield picture
        finally:
            self._runner.run(pictures.aclose())

    def pick(
        self,
        pixel: aio.Pixel,
        camera: Camera | None = None,
        *,
        resolution: tuple[int, int] | None = None,
        timeout: float | None = None,
        **options: Unpack[DisplayOptions],
    ) -> Hit | None:
        """What the picture shows at a pixel, counted from the upper left corner. None: the background."""
        return self._runner.run(self._model.pick(pixel, camera, resolution=resolution, timeout=timeout, **options))

    def pick_many(
        self,
        pixels: Iterable[aio.Pixel],
        camera: Camera | None = None,
        *,
        resolution: tuple[int, int] | None = None,
        timeout: float | None = None,
        **options: Unpack[DisplayOptions],
    ) -> list[Hit | None]:
        """What the picture shows at pixels, in their order. The requests overlap; the timeout is that of each."""
        picked = self._model.pick_many(pixels, camera, resolution=resolution, timeout=timeout, **options)
        return self._runner.run(picked)

    def profile(
        self, line: Iterable[Vector], width: float, *, max_points: int = 0, timeout: float | None = None
    ) -> Points:
        """The points of the scan in a band along a line on the horizontal plane, in ascending order of "along".

        The band has no limits in height. `max_points`: an even sample of so many; 0: as many as the server allows.
        """
        return self._runner.run(self._model.profile(line, width, max_points=max_points, timeout=timeout))

    def points(
        self,
        *,
        attributes: Iterable[str] | None = None,
        limit: int = 0,
        normals: bool = False,
        timeout: float | None = None,
        **region: Unpack[RegionOptions],
    ) -> Points:
        """The points of the scan in a region, in the order of the model's file. Without a region: all.

        Positions, colours and attributes have the values and types of the scan. `attributes`: only these. `limit`: more
        points raise Limit; 0: those that the server allows. The timeout is for each of the pieces that are sent.
        """
        points = self._model.points(attributes=attributes, limit=limit, normals=normals, timeout=timeout, **region)
        return self._runner.run(points)

    def count_points(self, *, timeout: float | None = None, **region: Unpack[RegionOptions]) -> int:
        """How many points there are in a region."""
        return self._runner.run(self._model.count_points(timeout=timeout, **region))

    def annotations(self, *, timeout: float | None = None) -> Annotations:
        """The saved views and annotations. Raises Unsupported if the server keeps none."""
        return self._runner.run(self._model.annotations(timeout=timeout))

    def write_annotations(self, annotations: Annotations, *, timeout: float | None = None) -> Annotations:
        """Replaces the saved views and annotations; returns them with their new edition.

        Raises Unavailable if somebody else has written since `annotations.edition` was read, and Denied if the token may
        not write.
        """
        return self._runner.run(self._model.write_annotations(annotations, timeout=timeout))

    def view(
        self,
        camera: Camera | None = None,
        *,
        target_fps: float = 0.0,
        acknowledge: bool = True,
        depth: bool = False,
        **options: Unpack[ViewOptions],
    ) -> View:
        """A view of the model, which is open while entered. See `surfcast.aio.Model.view`."""
        return View(self, self._runner, camera, dict(options, target_fps=target_fps, acknowledge=acknowledge, depth=depth))

    def widget(
        self,
        camera: Camera | None = None,
        *,
        resolution: tuple[int, int] = (960, 540),
        on_pick: Callable[[Hit | None], None] | None = None,
        **options: Unpack[DisplayOptions],
    ) -> Widget:
        """A view for a notebook, whose frames go through the kernel. `on_pick` hears of what is clicked on."""
        from .notebook import Widget

        return Widget(self, camera, resolution, on_pick, options)

    def wait_complete(self, *, timeout: float | None = None) -> None:
        """Waits until the model of a scan is complete. Raises ServerFault if it could not be built.

        `timeout`: of the whole wait, seconds; None: as long as the build takes. The server builds at low priority.
        """
        self._runner.run(self._model.wait_complete(timeout=timeout))
        self._info = None

    def _known(self) -> ModelInfo:
        return self.info() if self._info is None else self._info

    def _repr_png_(self) -> bytes | None:
        try:
            return self.render().data
        except Unavailable:
            return None  # there is nothing to see yet

    def __repr__(self) -> str:
        return f"<surfcast.Model {self.name} of {self._server.address}>"


async def _next(pictures: Any) -> Picture:
    picture: Picture = await pictures.__anext__()
    return picture


class View:
    """A view of a model: `with model.view() as view`. The newest frame wins."""

    def __init__(self, model: Model, runner: Runner, camera: Camera | None, settings: dict[str, Any]) -> None:
        self._model = model  # keeps the connection
        self._runner = runner
        self._view: aio.View = runner.run(_opened(model._model, camera, settings))

    def __enter__(self) -> View:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    @property
    def camera(self) -> Camera | None:
        """The camera that was asked for last. Setting it asks for another picture, at rest."""
        return self._view.camera

    @camera.setter
    def camera(self, camera: Camera) -> None:
        self.update(camera)

    @property
    def latest(self) -> Frame | None:
        """The newest frame."""
        return self._view.latest

    def update(self, camera: Camera | None = None, *, moving: bool = False, **options: Unpack[ViewOptions]) -> int:
        """Changes camera and options; what is not named stays. Returns the number of the update.

        `moving`: more updates will follow soon, so that nothing is refined yet.
        """
        return self._runner.run(self._view.update(camera, moving=moving, **options))

    def next(self, *, after: Frame | None = None, timeout: float | None = None) -> Frame:
        """The newest frame, once it is newer than `after`."""
        return self._runner.run(self._view.next(after=after, timeout=timeout))

    def wait_converged(self, *, timeout: float | None = None) -> Frame:
        """The frame that shows the newest update as `render` does."""
        return self._runner.run(self._view.wait_converged(timeout=timeout))

    def painted(self, frame: Frame) -> None:
        """Acknowledges a frame of a view that does not do so by itself. Two may be under way."""
        self._runner.run(self._view.painted(frame))

    def __iter__(self) -> Iterator[Frame]:
        """Frames as they come; those that came during the body of the loop are skipped but for the newest."""
        frame: Frame | None = None
        while True:
            frame = self.next(after=frame)
            yield frame

    def close(self) -> None:
        """Ends the view, if it has not ended with its server."""
        with suppress(ConnectionLost):
            self._runner.run(self._view.close())


async def _opened(model: aio.Model, camera: Camera | None, settings: dict[str, Any]) -> aio.View:
    view = model.view(camera, **settings)
    return await view.__aenter__()


def connect(
    address: str,
    *,
    token: str | None = None,
    ca: str | None = None,
    timeout: float = 120.0,
    connect_timeout: float = 10.0,
    reconnect: float = 10.0,
    patience: float = 5.0,
    window: int = 32,
    pictures: int = 4,
    model: str = "",
) -> Server:
    """Connects to a server at HOST:PORT, with tcp:// (the default), tcps://, ws:// or wss:// before it.

    The parameters are those of `surfcast.aio.connect`.
    """
    return Server(
        address,
        token=token,
        ca=ca,
        timeout=timeout,
        connect_timeout=connect_timeout,
        reconnect=reconnect,
        patience=patience,
        window=window,
        pictures=pictures,
        model=model,
    )
