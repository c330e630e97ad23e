"""Views: pictures that follow a camera."""

from __future__ import annotations

import asyncio
import time
from collections.abc import AsyncIterator, Mapping
from dataclasses import dataclass
from types import TracebackType
from typing import Any, Unpack

from . import errors
from ._connection import Connection, Link
from ._depth import Depth, depth_from
from ._options import ViewOptions, picture_request
from ._picture import Picture, picture_from
from ._values import Camera
from ._wire import surfcast_pb2 as wire


@dataclass(frozen=True, eq=False)
class Frame:
    """One picture of a view. `update` is the newest update that it shows; `resolution` is that of the view.

    While `moving`, the picture may be smaller than the view: whoever shows it scales it up. `depth` is there if the
    view asks for it and one depth can stand for a pixel; it belongs to `picture.camera`, which in motion is ahead of the
    update then.
    """

    number: int
    update: int
    moving: bool
    resolution: tuple[int, int]
    picture: Picture
    arrived: float  # of its last byte, time.monotonic()
    opening: int = 0  # how many times the view had been opened before
    depth: Depth | None = None


class View:
    """A view of a model, for asyncio: `async with model.view() as view`.

    After a loss of the connection it opens itself again, with the newest picture, for as long as the settings of the
    connection say.
    """

    def __init__(
        self,
        connection: Connection,
        model: str,
        camera: Camera | None,
        target_fps: float,
        acknowledge: bool,
        depth: bool,
        options: Mapping[str, Any],
    ) -> None:
        self._connection = connection
        self._model = model
        self._camera = camera
        self._target_fps = target_fps
        self._acknowledge = acknowledge
        self._depth = depth
        self._options = dict(options)
        self._request = picture_request(model, camera, self._options)
        self._update = 0
        self._opened_at_update = 0
        self._openings = 0
        self._link: Link | None = None
        self._id = 0
        self._partial: wire.ViewFrame | None = None
        self._latest: Frame | None = None
        self._seen: Frame | None = None
        self._error: errors.Error | None = None
        self._changed = asyncio.Condition()
        self._tasks: set[asyncio.Task[None]] = set()
        self._closing = False

    async def __aenter__(self) -> View:
        await self._open()
        return self

    async def __aexit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        await self.close()

    @property
    def camera(self) -> Camera | None:
        """The camera that was asked for last. None: one that shows the whole model."""
        return self._camera

    @property
    def latest(self) -> Frame | None:
        """The newest frame."""
        return self._latest

    async def update(
        self, camera: Camera | None = None, *, moving: bool = False, **options: Unpack[ViewOptions]
    ) -> int:
        """Changes camera and options; what is not named stays. Returns the number of the update.

        `moving`: more updates will follow soon, so that nothing is refined yet.
        """
        self._camera = self._camera if camera is None else camera
        self._options.update(options)
        self._request = picture_request(self._model, self._camera, self._options)
        self._update += 1
        if self._error is not None:
            raise self._error
        try:
            await self._send_update(moving)
        except errors.ConnectionLost:
            if self._connection.settings.reconnect <= 0:
                raise  # otherwise it is sent when the view is open again
        return self._update

    async def next(self, *, after: Frame | None = None, timeout: float | None = None) -> Frame:
        """The newest frame, once it is newer than `after`."""
        async with self._connection.within(timeout, "view"):
            return await self._wait(lambda frame: frame is not after)

    async def wait_converged(self, *, timeout: float | None = None) -> Frame:
        """The frame that shows the newest update as `render` does."""
        wanted = self._update

        def shows(frame: Frame) -> bool:
            return frame.update >= wanted and not frame.moving and frame.picture.converged

        async with self._connection.within(timeout, "view"):
            return await self._wait(shows)

    async def painted(self, frame: Frame) -> None:
        """Acknowledges a frame of a view that does not do so by itself. Two may be under way."""
        link = self._link
        if link is not None and frame.opening == self._openings:
            await self._send_painted(link, self._id, frame.number, (time.monotonic() - frame.arrived) * 1e3)

    async def __aiter__(self) -> AsyncIterator[Frame]:
        """Frames as they come; those that came during the body of the loop are skipped but for the newest."""
        frame: Frame | None = None
        while True:
            try:
                frame = await self._wait(lambda newest: newest is not frame)
            except errors.ConnectionLost:
                if self._closing:
                    return
                raise
            yield frame

    async def close(self) -> None:
        """Ends the view."""
        self._closing = True
        link, self._link = self._link, None
        for task in self._tasks:
            task.cancel()
        if link is not None and link.ended is None:
            try:
                async with self._connection.within(None, "close_view"):
                    await link.ask(wire.Request(close_view=wire.CloseView(view=self._id)))
            except errors.Error:
                pass  # it ended with the connection
            link.forget(self._id)
        self._fail(errors.ConnectionLost("the view is closed"))

    async def _wait(self, wanted: Any) -> Frame:
        async with self._changed:
            while True:
                if self._error is not None:
                    raise self._error
                if self._latest is not None and wanted(self._latest):
                    self._seen = self._latest
                    return self._latest
                await self._changed.wait()

    async def _open(self) -> None:
        link = await self._connection.link()
        self._partial = None
        self._opened_at_update = self._update
        view = wire.OpenView(picture=self._request, target_fps=self._target_fps, depth=self._depth)
        opened = wire.Request(open_view=view)
        self._link, self._id = link, 0
        self._id = await link.listen(opened, lambda answer: self._take(link, answer))
        if self._update != self._opened_at_update:
            await self._send_update(moving=False)

    def _take(self, link: Link, answer: wire.Answer | errors.Error) -> None:
        if link is not self._link:
            return
        if isinstance(answer, errors.ConnectionLost) and self._connection.settings.reconnect > 0:
            self._link = None
            self._start(self._open_again())
        elif isinstance(answer, errors.Error):
            self._fail(answer)
        elif answer.WhichOneof("kind") == "view_frame":
            self._take_frame(link, answer.id, answer.view_frame)

    def _take_frame(self, link: Link, view: int, frame: wire.ViewFrame) -> None:
        """Puts the pieces of a frame together. The pieces of one that was given up are dropped."""
        if self._partial is not None and self._partial.frame == frame.frame:
            self._partial.picture.data += frame.picture.data
        else:
            self._partial = frame
        if not frame.more:
            self._show(self._partial)
            self._partial = None
        if frame.more or self._acknowledge:
            self._start(self._send_painted(link, view, frame.frame, 0.0))

    def _show(self, frame: wire.ViewFrame) -> None:
        skipped = self._latest
        if not self._acknowledge and skipped is not None and skipped is not self._seen:
            self._start(self.painted(skipped))  # nobody will
        picture = picture_from(frame.picture)
        self._latest = Frame(
            number=frame.frame,
            update=frame.update or self._opened_at_update,
            moving=frame.moving,
            resolution=(frame.resolution.width, frame.resolution.height),
            picture=picture,
            arrived=time.monotonic(),
            opening=self._openings,
            depth=depth_from(frame.depth, picture.resolution) if frame.HasField("depth") else None,
        )
        self._start(self._notify())

    async def _open_again(self) -> None:
        self._openings += 1
        try:
            await self._open()
        except errors.Error as error:
            self._fail(error)

    def _fail(self, error: errors.Error) -> None:
        self._error = self._error or error
        self._start(self._notify())

    async def _notify(self) -> None:
        async with self._changed:
            self._changed.notify_all()

    def _start(self, work: Any) -> None:
        task: asyncio.Task[None] = asyncio.get_running_loop().create_task(work)
        self._tasks.add(task)
        task.add_done_callback(self._tasks.discard)

    async def _send_update(self, moving: bool) -> None:
        if self._link is None or self._id == 0:
            return  # it is being opened, with the newest picture
        update = wire.UpdateView(update=self._update, picture=self._request, moving=moving)
        await self._link.send(wire.Request(id=self._id, update_view=update))

    async def _send_painted(self, link: Link, view: int, frame: int, milliseconds: float) -> None:
        painted = wire.FramePainted(frame=frame, client_ms=milliseconds)
        try:
            await link.send(wire.Request(id=view, frame_painted=painted))
        except errors.ConnectionLost:
            pass  # the listener hears of it
