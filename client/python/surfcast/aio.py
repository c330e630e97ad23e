"""The client for asyncio. The names are those of the package; what asks the server is awaited."""

from __future__ import annotations

import asyncio
import os
import time
from collections.abc import AsyncIterator, Iterable, Sequence
from contextlib import aclosing, nullcontext
from os import PathLike
from types import TracebackType
from typing import Any, Unpack

from ._connection import Connection, Settings
from ._endpoint import find_token, parse_endpoint
from ._options import (
    DisplayOptions,
    PictureOptions,
    RegionOptions,
    ViewOptions,
    line_from,
    natural,
    picture_request,
    region_request,
)
from ._picture import Picture, picture_from
from ._values import (
    Annotations,
    Camera,
    Hit,
    ModelInfo,
    Points,
    Scan,
    Uploads,
    Vector,
    hit_from,
    model_info,
    points_from,
    points_of_file,
    scan_from,
)
from ._view import Frame, View
from ._wire import surfcast_pb2 as wire
from .camera_path import CameraPath
from .errors import InvalidInput, NotFound, ServerFault

__all__ = ["Frame", "Model", "Server", "View", "connect"]

Pixel = Sequence[int]


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
    """A server at HOST:PORT, with tcp:// (the default), tcps://, ws:// or wss:// before it. Connects when entered.

    `token`: by default that of SURFCAST_TOKEN, or of `surfcast login`. `ca`: a PEM file of certificates to trust with
    TLS; by default SURFCAST_CA, or those of the system. Times are in seconds: `timeout` for an answer,
    `connect_timeout`, `reconnect` for trying to connect again after a loss (0: never), `patience` for trying again
    what a busy server refuses. `window` and `pictures` bound the requests under way. `model`: the one that most
    requests are for, by which a proxy chooses the server.
    """
    endpoint = parse_endpoint(address)
    settings = Settings(
        timeout=timeout,
        connect_timeout=connect_timeout,
        reconnect=reconnect,
        patience=patience,
        window=window,
        pictures=pictures,
        token=find_token(endpoint) if token is None else token,
        ca=ca or os.environ.get("SURFCAST_CA"),
        model=model,
    )
    return Server(Connection(endpoint, settings))


class Server:
    """A server and the models that it serves."""

    def __init__(self, connection: Connection) -> None:
        self._connection = connection

    async def __aenter__(self) -> Server:
        await self._connection.link()
        return self

    async def __aexit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        await self.close()

    async def close(self) -> None:
        """Ends the connection. Requests under way raise ConnectionLost."""
        await self._connection.close()

    @property
    def address(self) -> str:
        """HOST:PORT."""
        return self._connection.endpoint.address

    async def version(self) -> str:
        """Name and version of the server's program."""
        return (await self._connection.link()).hello.program

    async def protocol(self) -> tuple[int, int]:
        """Major and minor version of the server's protocol."""
        return (await self._connection.link()).hello.protocol

    async def ping(self, *, timeout: float | None = None) -> float:
        """Seconds from a request to its answer, whatever is being drawn."""
        begin = time.perf_counter()
        await self._connection.ask(wire.Request(ping=wire.Ping()), timeout)
        return time.perf_counter() - begin

    async def models(self, *, timeout: float | None = None) -> list[str]:
        """The names of the models, sorted."""
        return list((await self._list(timeout)).models)

    async def scans(self, *, timeout: float | None = None) -> list[Scan]:
        """The scans whose models are not complete."""
        return [scan_from(scan) for scan in (await self._list(timeout)).scans]

    async def model(self, name: str, *, timeout: float | None = None) -> Model:
        """A model by its name, or a scan of which there is none yet. Raises NotFound otherwise.

        Names with plus signs between them are several models, shown as one.
        """
        served = await self._list(timeout)
        known = {*served.models, *(scan.model for scan in served.scans)}
        if name not in known and not known.issuperset(name.split("+")):
            raise NotFound(f"there is no model '{name}'")
        return Model(self._connection, name)

    async def uploads(self, *, timeout: float | None = None) -> Uploads | None:
        """Which files the server takes. None: it takes none."""
        served = await self._list(timeout)
        if not served.HasField("uploads"):
            return None
        return Uploads(served.uploads.max_bytes, tuple(served.uploads.extensions))

    async def upload(
        self, path: str | PathLike[str], name: str | None = None, *, timeout: float | None = None
    ) -> Model | None:
        """Sends a scan, under its own name or another, and returns its model, which `wait_complete` waits for.

        None: a file that others name, such as samples or textures. The timeout is for each step of the transfer.
        """
        from ._http import send_file  # whose modules take long to import

        connection = self._connection
        model = await asyncio.to_thread(send_file, connection.endpoint, connection.settings, path, name, timeout)
        return None if model is None else Model(connection, model)

    async def _list(self, timeout: float | None) -> wire.ModelList:
        request = wire.Request(list_models=wire.ListModels())
        return (await self._connection.ask(request, timeout)).model_list


class Model:
    """A model of a server."""

    def __init__(self, connection: Connection, name: str) -> None:
        self.name = name
        self._connection = connection

    async def annotations(self, *, timeout: float | None = None) -> Annotations:
        """The saved views and annotations. Raises Unsupported if the server keeps none."""
        from ._http import read_annotations  # whose modules take long to import

        connection = self._connection
        return await asyncio.to_thread(
            read_annotations, connection.endpoint, connection.settings, self.name, timeout
        )

    async def write_annotations(self, annotations: Annotations, *, timeout: float | None = None) -> Annotations:
        """Replaces the saved views and annotations; returns them with their new edition.

        Raises Unavailable if somebody else has written since `annotations.edition` was read, and Denied if the token may
        not write.
        """
        from ._http import write_annotations

        connection = self._connection
        return await asyncio.to_thread(
            write_annotations, connection.endpoint, connection.settings, self.name, annotations, timeout
        )

    async def info(self, *, timeout: float | None = None) -> ModelInfo:
        """What the model holds. Raises Unavailable while there is neither a model nor a preview of a scan."""
        request = wire.Request(describe_model=wire.DescribeModel(model=self.name))
        return model_info((await self._connection.ask(request, timeout)).model_description)

    async def render(
        self, camera: Camera | None = None, *, timeout: float | None = None, **options: Unpack[PictureOptions]
    ) -> Picture:
        """The converged picture; without a camera one of the whole model, 1280 x 720, PNG."""
        request = wire.Request(draw_picture=picture_request(self.name, camera, options))
        return picture_from((await self._connection.ask(request, timeout)).picture)

    async def render_path(
        self,
        path: CameraPath | Iterable[Camera],
        fps: float = 30.0,
        *,
        timeout: float | None = None,
        **options: Unpack[PictureOptions],
    ) -> AsyncIterator[Picture]:
        """The pictures of the frames of a camera path, or of cameras. The next one is drawn meanwhile."""
        cameras = path.cameras(fps) if isinstance(path, CameraPath) else path
        following: list[asyncio.Task[Picture]] = []
        try:
            for camera in cameras:
                following.append(asyncio.create_task(self.render(camera, timeout=timeout, **options)))
                if len(following) > 1:
                    yield await following.pop(0)
            while following:
                yield await following.pop(0)
        finally:
            for task in following:
                task.cancel()

    async def pick(
        self,
        pixel: Pixel,
        camera: Camera | None = None,
        *,
        resolution: tuple[int, int] | None = None,
        timeout: float | None = None,
        **options: Unpack[DisplayOptions],
    ) -> Hit | None:
        """What the picture shows at a pixel, counted from the upper left corner. None: the background."""
        picture = picture_request(self.name, camera, {"resolution": resolution, **options})
        return await self._pick(picture, pixel, timeout)

    async def pick_many(
        self,
        pixels: Iterable[Pixel],
        camera: Camera | None = None,
        *,
        resolution: tuple[int, int] | None = None,
        timeout: float | None = None,
        **options: Unpack[DisplayOptions],
    ) -> list[Hit | None]:
        """What the picture shows at pixels, in their order. The requests overlap; the timeout is that of each."""
        picture = picture_request(self.name, camera, {"resolution": resolution, **options})
        waiting = enumerate(pixels)
        hits: dict[int, Hit | None] = {}

        async def work() -> None:
            for number, pixel in waiting:
                hits[number] = await self._pick(picture, pixel, timeout)

        workers = [asyncio.create_task(work()) for _ in range(self._connection.settings.window)]
        try:
            await asyncio.gather(*workers)
        finally:
            for worker in workers:
                worker.cancel()
        return [hits[number] for number in range(len(hits))]

    async def profile(
        self, line: Iterable[Vector], width: float, *, max_points: int = 0, timeout: float | None = None
    ) -> Points:
        """The points of the scan in a band along a line on the horizontal plane, in ascending order of "along".

        The band has no limits in height. `max_points`: an even sample of so many; 0: as many as the server allows.
        """
        profile = wire.GetProfile(model=self.name, line=line_from(line), width=width, max_points=max_points)
        return points_from((await self._connection.ask(wire.Request(get_profile=profile), timeout)).profile)

    async def points(
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
        request = region_request(self.name, region)
        request.max_points = natural("limit", limit)
        request.normals = normals
        file = bytearray()
        async with aclosing(self._connection.points(request, timeout)) as messages:
            async for message in messages:
                file += message.data
        return points_of_file(bytes(file), attributes)

    async def count_points(self, *, timeout: float | None = None, **region: Unpack[RegionOptions]) -> int:
        """How many points there are in a region."""
        request = region_request(self.name, region)
        request.only_count = True
        async with aclosing(self._connection.points(request, timeout)) as messages:
            return sum([message.total async for message in messages])

    def view(
        self,
        camera: Camera | None = None,
        *,
        target_fps: float = 0.0,
        acknowledge: bool = True,
        depth: bool = False,
        **options: Unpack[ViewOptions],
    ) -> View:
        """A view of the model, which is open while entered.

        `target_fps`: while the camera moves; 0: the server's own. `acknowledge`: False if the caller tells by
        `Frame.painted` when a frame is on the screen; otherwise frames are acknowledged when they arrive. `depth`:
        frames have a depth, and those in motion are drawn for the camera that is expected when they arrive.
        """
        return View(self._connection, self.name, camera, target_fps, acknowledge, depth, dict(options))

    async def wait_complete(self, *, timeout: float | None = None, pause: float = 0.2) -> None:
        """Waits until the model of a scan is complete. Raises ServerFault if it could not be built.

        `timeout`: of the whole wait, seconds; None: as long as the build takes. The server builds at low priority.
        """
        limit = nullcontext() if timeout is None else self._connection.within(timeout, "wait_complete")
        async with limit:
            while scan := await self._scan():
                if scan.state == "failed":
                    raise ServerFault(f"{self.name}: {scan.problem}")
                await asyncio.sleep(pause)

    async def _scan(self) -> Scan | None:
        request = wire.Request(list_models=wire.ListModels())
        scans = (await self._connection.ask(request)).model_list.scans
        return next((scan_from(scan) for scan in scans if scan.model == self.name), None)

    async def _pick(self, picture: wire.DrawPicture, pixel: Any, timeout: float | None) -> Hit | None:
        try:
            x, y = (int(part) for part in pixel)
            pick = wire.PickSurfel(picture=picture, x=x, y=y)
        except (TypeError, ValueError):
            raise InvalidInput(f"pixel: expected two whole numbers from 0, got {pixel!r}") from None
        return hit_from((await self._connection.ask(wire.Request(pick_surfel=pick), timeout)).pick_result)
