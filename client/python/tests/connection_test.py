"""What becomes of requests when servers are slow, stop, or are of another version."""

from __future__ import annotations

import asyncio
import gc
import os
import queue
import signal
import struct
import subprocess
import sys
import threading
import tracemalloc
from collections.abc import AsyncIterator, Awaitable, Callable, Coroutine, Iterator
from contextlib import asynccontextmanager
from pathlib import Path
from typing import Any

import pytest
from patience import PATIENCE

import surfcast
from surfcast import aio
from surfcast._sync import Runner
from surfcast._wire import surfcast_pb2 as wire
from surfcast.testing import RunningServer, server

SIZE = (64, 48)
Handler = Callable[[asyncio.StreamReader, asyncio.StreamWriter], Awaitable[None]]


def hello(major: int = 1, minor: int = 0, status: int = 0, message: bytes = b"") -> bytes:
    return struct.pack("<8sHHHHH", b"\xf5SURFCST", major, minor, status, 4, len(message)) + b"mock" + message


async def read_hello(reader: asyncio.StreamReader) -> None:
    header = await reader.readexactly(18)
    await reader.readexactly(sum(struct.unpack_from("<HH", header, 14)))


async def read_request(reader: asyncio.StreamReader) -> wire.Request:
    (length,) = struct.unpack("<I", await reader.readexactly(4))
    request: wire.Request = wire.Request.FromString(await reader.readexactly(length))
    return request


def send(writer: asyncio.StreamWriter, answer: wire.Answer) -> None:
    data = answer.SerializeToString()
    writer.write(struct.pack("<I", len(data)) + data)


@asynccontextmanager
async def mock(handler: Handler) -> AsyncIterator[str]:
    """A server that does what a handler says to each connection."""

    async def serve(reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        try:
            await handler(reader, writer)
        except (asyncio.IncompleteReadError, ConnectionError):
            pass
        writer.close()

    listening = await asyncio.start_server(serve, "127.0.0.1", 0)
    async with listening:
        yield f"127.0.0.1:{listening.sockets[0].getsockname()[1]}"


async def test_a_picture_that_nobody_waits_for_is_cancelled_on_the_server() -> None:
    requests: asyncio.Queue[wire.Request] = asyncio.Queue()

    async def slow(reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        await read_hello(reader)
        writer.write(hello())
        while True:
            request = await read_request(reader)
            if request.WhichOneof("kind") == "list_models":
                send(writer, wire.Answer(id=request.id, model_list=wire.ModelList(models=["a"])))
            requests.put_nowait(request)

    async with mock(slow) as address, aio.connect(address) as client:
        model = await client.model("a")
        await requests.get()
        with pytest.raises(surfcast.Timeout, match="within 0.05 s"):
            await model.render(timeout=0.05)
        drawn, cancel = await requests.get(), await requests.get()
        assert cancel.cancel.request_id == drawn.id

        task = asyncio.create_task(model.render())
        drawn = await requests.get()
        task.cancel()
        cancel = await requests.get()
        assert cancel.cancel.request_id == drawn.id
        with pytest.raises(asyncio.CancelledError):
            await task


async def test_the_model_that_is_meant_is_named_to_proxies() -> None:
    said: list[bytes] = []

    async def listen(reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        header = await reader.readexactly(18)
        said.append(await reader.readexactly(struct.unpack_from("<H", header, 14)[0]))
        writer.write(hello())

    async with mock(listen) as address, aio.connect(address, model="old church"):
        assert said[0].endswith(b" model=old%20church")


async def test_a_server_of_another_version_is_told_apart() -> None:
    async def other(reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        await read_hello(reader)
        writer.write(hello(major=9, status=1, message=b"version 9 is wanted"))

    async with mock(other) as address:
        with pytest.raises(surfcast.VersionMismatch, match="version 9 is wanted"):
            async with aio.connect(address):
                pass


async def test_what_is_no_surfcast_is_told_apart() -> None:
    async def other(reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        writer.write(b"HTTP/1.1 400 Bad Request\r\n\r\n")

    async with mock(other) as address:
        with pytest.raises(surfcast.ConnectionLost, match="no Surfcast server"):
            async with aio.connect(address):
                pass


async def test_a_busy_server_is_unavailable() -> None:
    async def busy(reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        await read_hello(reader)
        writer.write(hello(status=2, message=b"256 connections are open"))

    async with mock(busy) as address:
        with pytest.raises(surfcast.Unavailable, match="256 connections"):
            async with aio.connect(address):
                pass


async def test_a_pick_that_a_busy_server_refuses_is_tried_again() -> None:
    picks = 0

    async def busy(reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        nonlocal picks
        await read_hello(reader)
        writer.write(hello())
        while True:
            request = await read_request(reader)
            if request.WhichOneof("kind") == "list_models":
                send(writer, wire.Answer(id=request.id, model_list=wire.ModelList(models=["a"])))
                continue
            picks += 1
            if picks < 3:
                error = wire.Error(code=wire.ERROR_CODE_UNAVAILABLE, message="too many picks")
                send(writer, wire.Answer(id=request.id, error=error))
            else:
                send(writer, wire.Answer(id=request.id, pick_result=wire.PickResult()))

    async with mock(busy) as address, aio.connect(address) as client:
        assert await (await client.model("a")).pick((1, 2)) is None
    assert picks == 3


async def test_a_request_is_asked_again_when_its_connection_ends() -> None:
    connections = 0

    async def leaving(reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        nonlocal connections
        connections += 1
        await read_hello(reader)
        writer.write(hello())
        request = await read_request(reader)
        if connections > 1:
            send(writer, wire.Answer(id=request.id, model_list=wire.ModelList(models=["a"])))
            await reader.read()

    async with mock(leaving) as address, aio.connect(address) as client:
        assert await client.models() == ["a"]
    assert connections == 2


async def test_a_silent_server_ends_in_time() -> None:
    async def silent(reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        await reader.read()

    async with mock(silent) as address:
        with pytest.raises(surfcast.ConnectionLost, match="no connection within 0.1 s"):
            async with aio.connect(address, connect_timeout=0.1):
                pass


@pytest.fixture
def interruptible() -> Iterator[None]:
    """Interrupts raise KeyboardInterrupt, as they do not where a shell has started the tests in the background."""
    former = signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    signal.signal(signal.SIGINT, former)


@pytest.mark.usefixtures("interruptible")
def test_an_interrupt_cancels_the_picture() -> None:
    requests: queue.Queue[wire.Request] = queue.Queue()

    async def interrupting(reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        await read_hello(reader)
        writer.write(hello())
        while True:
            request = await read_request(reader)
            if request.WhichOneof("kind") == "list_models":
                send(writer, wire.Answer(id=request.id, model_list=wire.ModelList(models=["a"])))
                continue
            requests.put(request)
            if request.WhichOneof("kind") == "draw_picture":
                os.kill(os.getpid(), signal.SIGINT)

    runner = Runner()
    listening = mock(interrupting)
    try:
        with surfcast.connect(runner.run(listening.__aenter__())) as client:
            with pytest.raises(KeyboardInterrupt):
                client["a"].render()
            drawn, cancel = requests.get(timeout=PATIENCE), requests.get(timeout=PATIENCE)
            assert cancel.cancel.request_id == drawn.id
        runner.run(listening.__aexit__(None, None, None))
    finally:
        runner.stop()


def test_an_interrupt_before_the_wait_cancels_what_has_begun(monkeypatch: pytest.MonkeyPatch) -> None:
    begun, cancelled = threading.Event(), threading.Event()

    async def work() -> None:
        begun.set()
        try:
            await asyncio.sleep(3600)
        except asyncio.CancelledError:
            cancelled.set()
            raise

    start = asyncio.run_coroutine_threadsafe

    def interrupted(coroutine: Coroutine[Any, Any, None], loop: asyncio.AbstractEventLoop) -> None:
        start(coroutine, loop)
        assert begun.wait(60)
        raise KeyboardInterrupt

    runner = Runner()
    monkeypatch.setattr(asyncio, "run_coroutine_threadsafe", interrupted)
    try:
        with pytest.raises(KeyboardInterrupt):
            runner.run(work())
        assert cancelled.wait(60)
    finally:
        runner.stop()


def test_a_view_keeps_its_connection(running: RunningServer) -> None:
    view = running.connect()["field"].view(resolution=SIZE)
    gc.collect()
    assert view.wait_converged(timeout=PATIENCE).picture.converged
    view.close()


def test_closing_ends_what_other_threads_wait_for(running: RunningServer) -> None:
    ended: queue.Queue[BaseException] = queue.Queue()
    client = running.connect()
    with client["field"].view(resolution=SIZE) as view:
        last = view.wait_converged(timeout=PATIENCE)

        def wait() -> None:
            try:
                view.next(after=last)
            except surfcast.Error as error:
                ended.put(error)

        thread = threading.Thread(target=wait)
        thread.start()
        client.close()
        assert isinstance(ended.get(timeout=PATIENCE), surfcast.ConnectionLost)
        thread.join()


def test_a_program_may_end_without_closing(running: RunningServer) -> None:
    script = f"import surfcast; view = surfcast.connect({running.address!r})['field'].view(); view.next(); print('end')"
    said = subprocess.run([sys.executable, "-W", "error", "-c", script], capture_output=True, text=True, check=True)
    assert (said.stdout, said.stderr) == ("end\n", "")


def test_errors_have_the_servers_sentence(client: surfcast.Server, field: surfcast.Model) -> None:
    with pytest.raises(surfcast.NotFound, match="nothing"):
        client["nothing"]
    with pytest.raises(surfcast.Limit):
        field.render(resolution=(100_000, 100_000))
    with pytest.raises(surfcast.InvalidInput, match="resolution"):
        field.render(resolution=(0, 10))
    with pytest.raises(surfcast.InvalidInput, match="there is no option 'colour'"):
        field.render(colour="intensity")  # type: ignore[call-arg]
    with pytest.raises(surfcast.InvalidInput, match="xray"):
        field.render(xray="sometimes")  # type: ignore[arg-type]
    with pytest.raises(surfcast.InvalidInput, match="HOST:PORT"):
        surfcast.connect("nowhere")


def test_a_killed_server_is_a_lost_connection(models: Path) -> None:
    with server(models) as running:
        with running.connect(reconnect=0.2) as client:
            field = client["field"]
            with field.view(resolution=SIZE) as view:
                view.wait_converged(timeout=PATIENCE)
                newest = view.latest
                running.kill()
                with pytest.raises(surfcast.ConnectionLost):
                    view.next(after=newest, timeout=20)
                with pytest.raises(surfcast.ConnectionLost):
                    field.render(resolution=SIZE, timeout=20)


def test_a_connection_comes_back_with_its_views(models: Path) -> None:
    with server(models) as running:
        port = running.address.rpartition(":")[2]
        with running.connect(reconnect=60) as client:
            field = client["field"]
            with field.view(resolution=SIZE) as view:
                before = view.wait_converged(timeout=PATIENCE)
                running.stop()
                with server(models, listen=f"127.0.0.1:{port}"):
                    after = view.next(after=before, timeout=PATIENCE)
                    assert after.picture.resolution
                    view.update(shading="lit")
                    lit = view.wait_converged(timeout=PATIENCE)
                    assert lit.picture.data == field.render(resolution=SIZE, shading="lit").data


def test_threads_share_a_connection(field: surfcast.Model, scan: object, camera: surfcast.Camera) -> None:
    expected = [field.render(camera, resolution=(40 + n, 40)).data for n in range(10)]
    pictures: list[bytes] = [b""] * 10
    picks: list[list[surfcast.Hit | None]] = [[]] * 10

    def work(n: int) -> None:
        pictures[n] = field.render(camera, resolution=(40 + n, 40)).data
        picks[n] = field.pick_many([(20 + i, 20) for i in range(10)], camera, resolution=SIZE)

    threads = [threading.Thread(target=work, args=(n,)) for n in range(10)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert pictures == expected
    surfels = [[hit and hit.surfel for hit in hits] for hits in picks]
    assert surfels == [surfels[0]] * 10


async def test_a_hundred_tasks_share_a_connection(running: RunningServer, camera: surfcast.Camera) -> None:
    async with aio.connect(running.address) as client:
        field = await client.model("field")
        pictures = await asyncio.gather(*(field.render(camera, resolution=(20 + n % 5, 20)) for n in range(50)))
        picks = await asyncio.gather(*(field.pick((n, 24), camera, resolution=SIZE) for n in range(50)))
    for n, picture in enumerate(pictures):
        assert picture.resolution == (20 + n % 5, 20)
        assert picture.data == pictures[n % 5].data
    assert sum(hit is not None for hit in picks) > 20


def test_nothing_leaks(field: surfcast.Model, camera: surfcast.Camera) -> None:
    pixels = [(x % 64, 24) for x in range(500)]

    def work() -> int:
        field.pick_many(pixels, camera, resolution=SIZE)
        for _ in range(50):
            field.render(camera, resolution=SIZE)
        gc.collect()
        return tracemalloc.get_traced_memory()[0]

    tracemalloc.start()
    try:
        work()
        before = work()
        after = work()
    finally:
        tracemalloc.stop()
    assert after <= 1.01 * before + 4096


def test_threads_end_with_their_server(running: RunningServer) -> None:
    before = threading.active_count()
    with running.connect() as client:
        client.models()
        assert threading.active_count() == before + 1
    assert threading.active_count() == before
    with pytest.raises(surfcast.ConnectionLost):
        client.models()
