"""A connection that pairs answers with requests and opens itself again."""

from __future__ import annotations

import asyncio
import itertools
from collections.abc import AsyncGenerator, AsyncIterator, Callable
from contextlib import aclosing, asynccontextmanager
from dataclasses import dataclass

from . import errors
from ._channel import Channel, open_channel
from ._endpoint import Endpoint
from ._hello import Hello
from ._wire import surfcast_pb2 as wire

_ERRORS: dict[int, type[errors.Error]] = {
    wire.ERROR_CODE_INTERNAL: errors.ServerFault,
    wire.ERROR_CODE_INVALID_INPUT: errors.InvalidInput,
    wire.ERROR_CODE_UNSUPPORTED: errors.Unsupported,
    wire.ERROR_CODE_NOT_FOUND: errors.NotFound,
    wire.ERROR_CODE_IO: errors.ServerFault,
    wire.ERROR_CODE_LIMIT: errors.Limit,
    wire.ERROR_CODE_CANCELLED: errors.Cancelled,
    wire.ERROR_CODE_UNAVAILABLE: errors.Unavailable,
    wire.ERROR_CODE_DENIED: errors.Denied,
}
_FIRST_PAUSE = 0.02  # seconds before something is tried again; doubled each time
_LONGEST_PAUSE = 1.0

# Takes the answers of a view, then the error that ends it.
Listener = Callable[["wire.Answer | errors.Error"], None]


@dataclass(frozen=True)
class Settings:
    """Times in seconds, and limits of a connection."""

    timeout: float = 120.0
    connect_timeout: float = 10.0
    reconnect: float = 10.0
    patience: float = 5.0
    window: int = 32
    pictures: int = 4
    max_answer: int = 512 << 20
    token: str | None = None
    ca: str | None = None
    model: str = ""


def error_of(error: wire.Error) -> errors.Error:
    """The exception for an error of the server. Codes that are not known are faults of the server."""
    return _ERRORS.get(error.code, errors.ServerFault)(error.message)


class Link:
    """One open connection: its reader, and who waits for what."""

    def __init__(self, channel: Channel, hello: Hello) -> None:
        self.hello = hello
        self.ended: errors.Error | None = None
        self._channel = channel
        self._ids = itertools.count(1)
        self._waiting: dict[int, asyncio.Future[wire.Answer]] = {}
        self._listeners: dict[int, Listener] = {}
        self._reader = asyncio.create_task(self._read())

    async def ask(self, request: wire.Request) -> wire.Answer:
        """Sends a request and waits for its answer. A picture that nobody waits for any more is cancelled."""
        request.id = next(self._ids)
        future: asyncio.Future[wire.Answer] = asyncio.get_running_loop().create_future()
        self._waiting[request.id] = future
        try:
            await self.send(request)
            return await future
        except asyncio.CancelledError:
            if request.WhichOneof("kind") == "draw_picture":
                await self.cancel(request.id)
            raise
        finally:
            self._waiting.pop(request.id, None)
            if not future.cancel() and not future.cancelled():
                future.exception()  # marks it as seen when sending failed first

    async def send(self, request: wire.Request) -> None:
        """Sends a request that has its id."""
        if self.ended is not None:
            raise errors.ConnectionLost(str(self.ended))
        await self._channel.send(request.SerializeToString())

    async def listen(self, request: wire.Request, listener: Listener) -> int:
        """Sends a request with many answers. Returns its id."""
        request.id = next(self._ids)
        self._listeners[request.id] = listener
        await self.send(request)
        return request.id

    def forget(self, listened: int) -> None:
        self._listeners.pop(listened, None)

    async def close(self) -> None:
        self._reader.cancel()
        await asyncio.wait([self._reader])
        self._end(errors.ConnectionLost("the connection is closed"))
        await self._channel.close()

    async def cancel(self, request_id: int) -> None:
        """Tells the server that nobody waits for an answer any more."""
        cancel = wire.Request(id=next(self._ids), cancel=wire.Cancel(request_id=request_id))
        try:
            await self.send(cancel)
        except errors.Error:
            pass  # without a connection the server cancels by itself

    async def _read(self) -> None:
        try:
            while True:
                self._take(wire.Answer.FromString(await self._channel.receive()))
        except errors.Error as error:
            self._end(error)
        except Exception as error:  # a message that cannot be decoded
            self._end(errors.ConnectionLost(f"the server sent what is no answer: {error}"))
        await self._channel.close()

    def _take(self, answer: wire.Answer) -> None:
        kind = answer.WhichOneof("kind")
        if answer.id == 0 and kind == "error":
            raise errors.ConnectionLost(answer.error.message)
        if answer.id in self._listeners:
            self._listeners[answer.id](error_of(answer.error) if kind == "error" else answer)
            return
        future = self._waiting.get(answer.id)
        if future is None or future.done():
            return  # of a request that nobody waits for any more
        if kind == "error":
            future.set_exception(error_of(answer.error))
        else:
            future.set_result(answer)

    def _end(self, error: errors.Error) -> None:
        if self.ended is not None:
            return
        self.ended = error
        lost = error if isinstance(error, errors.ConnectionLost) else errors.ConnectionLost(str(error))
        for future in self._waiting.values():
            if not future.done():
                future.set_exception(lost)
        for listener in list(self._listeners.values()):
            listener(lost)


class Connection:
    """Opens a link when one is needed, and again when it was lost. For the tasks of one event loop."""

    def __init__(self, endpoint: Endpoint, settings: Settings) -> None:
        self.endpoint = endpoint
        self.settings = settings
        self._link: Link | None = None
        self._opening = asyncio.Lock()
        self._window = asyncio.Semaphore(settings.window)
        self._pictures = asyncio.Semaphore(settings.pictures)
        self._closed = False
        self._was_open = False

    async def ask(self, request: wire.Request, timeout: float | None = None) -> wire.Answer:
        """The answer to a request, within the timeout from its turn on.

        Picks and profiles that a busy server refuses are tried again.
        """
        kind = request.WhichOneof("kind")
        turns = self._pictures if kind == "draw_picture" else self._window
        async with turns, self.within(timeout, kind or "request"):
            patience = self.settings.patience if kind in ("pick_surfel", "get_profile") else 0.0
            return await self._ask_patiently(request, patience)

    async def points(self, request: wire.GetPoints, timeout: float | None = None) -> AsyncGenerator[wire.Points, None]:
        """The messages with the points of a region. The timeout is for each of them.

        A server that is busy is asked again, as long as it has sent nothing.
        """
        loop = asyncio.get_running_loop()
        end = loop.time() + self.settings.patience
        pause = _FIRST_PAUSE
        async with self._window:
            while True:
                begun = False
                try:
                    async with aclosing(self._messages(request, timeout)) as messages:
                        async for message in messages:
                            begun = True
                            yield message
                    return
                except errors.Unavailable:
                    if begun or loop.time() + pause > end:
                        raise
                await asyncio.sleep(pause)
                pause = min(2 * pause, _LONGEST_PAUSE)

    async def _messages(self, request: wire.GetPoints, timeout: float | None) -> AsyncGenerator[wire.Points, None]:
        link = await self.link()
        answers: asyncio.Queue[wire.Answer | errors.Error] = asyncio.Queue()
        number = await link.listen(wire.Request(get_points=request), answers.put_nowait)
        more = True
        try:
            while more:
                async with self.within(timeout, "get_points"):
                    answer = await answers.get()
                if isinstance(answer, errors.Error):
                    more = False
                    raise answer
                more = answer.points.more
                yield answer.points
        finally:
            link.forget(number)
            if more:
                await link.cancel(number)

    @asynccontextmanager
    async def within(self, timeout: float | None, what: str) -> AsyncIterator[None]:
        """Turns the end of a timeout into an error of this package."""
        seconds = self.settings.timeout if timeout is None else timeout
        try:
            async with asyncio.timeout(seconds) as limit:
                yield
        except TimeoutError as error:
            if isinstance(error, errors.Error) or not limit.expired():
                raise
            sentence = f"{self.endpoint.address}: no answer to {what} within {seconds:g} s"
            raise errors.Timeout(sentence) from None

    async def link(self) -> Link:
        """The open link. One that was lost is opened again, for as long as the settings say."""
        async with self._opening:
            if self._closed:
                raise errors.ConnectionLost("the connection is closed")
            if self._link is None or self._link.ended is not None:
                self._link = await self._open_again() if self._was_open else await self._open()
                self._was_open = True
            return self._link

    async def close(self) -> None:
        self._closed = True
        if self._link is not None:
            await self._link.close()

    async def _ask_patiently(self, request: wire.Request, patience: float) -> wire.Answer:
        end = asyncio.get_running_loop().time() + patience
        pause = _FIRST_PAUSE
        while True:
            try:
                return await self._ask_again(request)
            except errors.Unavailable:
                if asyncio.get_running_loop().time() + pause > end:
                    raise
            await asyncio.sleep(pause)
            pause = min(2 * pause, _LONGEST_PAUSE)

    async def _ask_again(self, request: wire.Request) -> wire.Answer:
        """Asks once more if the connection ends meanwhile: no request changes anything on the server."""
        link = await self.link()
        try:
            return await link.ask(request)
        except errors.ConnectionLost:
            if self.settings.reconnect <= 0 or self._closed:
                raise
        return await (await self.link()).ask(request)

    async def _open_again(self) -> Link:
        end = asyncio.get_running_loop().time() + self.settings.reconnect
        pause = _FIRST_PAUSE
        if self.settings.reconnect <= 0 and self._link is not None and self._link.ended is not None:
            raise errors.ConnectionLost(str(self._link.ended))
        while True:
            try:
                return await self._open()
            except (errors.ConnectionLost, errors.Unavailable):
                if asyncio.get_running_loop().time() + pause > end:
                    raise
            await asyncio.sleep(pause)
            pause = min(2 * pause, _LONGEST_PAUSE)

    async def _open(self) -> Link:
        try:
            async with asyncio.timeout(self.settings.connect_timeout) as limit:
                channel, hello = await open_channel(
                    self.endpoint, self.settings.ca, self.settings.max_answer, self.settings.model
                )
        except TimeoutError as error:
            if not limit.expired():
                raise
            within = f"within {self.settings.connect_timeout:g} s"
            raise errors.ConnectionLost(f"{self.endpoint.address}: no connection {within}") from error
        link = Link(channel, hello)
        try:
            await self._authenticate(link)
        except BaseException:
            await link.close()
            raise
        return link

    async def _authenticate(self, link: Link) -> None:
        if self.settings.token:
            async with self.within(self.settings.connect_timeout, "authenticate"):
                await link.ask(wire.Request(authenticate=wire.Authenticate(token=self.settings.token)))
