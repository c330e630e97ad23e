"""Transports of messages: frames on a stream, and WebSockets."""

from __future__ import annotations

import asyncio
import ssl
import struct
from importlib import import_module
from typing import Any, Protocol
from urllib.parse import quote

from ._endpoint import Endpoint
from ._hello import HEADER_BYTES, Hello, check_hello, client_hello, parse_hello, text_bytes
from .errors import ConnectionLost, Limit, Unsupported

_LENGTH = struct.Struct("<I")
_SUBPROTOCOL = "surfcast.v1"
# Larger pauses of the transport make large pictures slower.
_READ_AHEAD = 1 << 20


class Channel(Protocol):
    """Carries whole messages. Everything that ends it is raised as ConnectionLost."""

    async def send(self, message: bytes) -> None:
        ...

    async def receive(self) -> bytes:
        ...

    async def close(self) -> None:
        ...


class FramedChannel:
    """Messages with their length before them, on a stream."""

    def __init__(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter, max_answer: int) -> None:
        self._reader = reader
        self._writer = writer
        self._max_answer = max_answer

    async def say_hello(self, model: str) -> Hello:
        self._writer.write(client_hello(model))
        header = await self._read(HEADER_BYTES)
        return parse_hello(header + await self._read(text_bytes(header)))

    async def send(self, message: bytes) -> None:
        try:
            self._writer.write(_LENGTH.pack(len(message)) + message)
            await self._writer.drain()
        except (OSError, RuntimeError) as error:
            raise ConnectionLost(f"the connection broke: {error}") from error

    async def receive(self) -> bytes:
        (length,) = _LENGTH.unpack(await self._read(_LENGTH.size))
        if length > self._max_answer:
            raise Limit(f"an answer of {length} bytes is beyond the limit of {self._max_answer}")
        return await self._read(length)

    async def close(self) -> None:
        self._writer.close()
        try:
            await self._writer.wait_closed()
        except (OSError, ssl.SSLError):
            pass  # it is closed either way

    async def _read(self, count: int) -> bytes:
        try:
            return await self._reader.readexactly(count)
        except asyncio.IncompleteReadError as error:
            raise ConnectionLost("the server closed the connection") from error
        except OSError as error:
            raise ConnectionLost(f"the connection broke: {error}") from error


class WebSocketChannel:
    """Each message is one binary message of a WebSocket."""

    def __init__(self, socket: Any) -> None:
        self._socket = socket

    async def say_hello(self, model: str) -> Hello:
        await self.send(client_hello(model))
        return parse_hello(await self.receive())

    async def send(self, message: bytes) -> None:
        try:
            await self._socket.send(message)
        except Exception as error:  # of the library's own kinds
            raise ConnectionLost(f"the connection broke: {error}") from error

    async def receive(self) -> bytes:
        try:
            message = await self._socket.recv()
        except Exception as error:  # of the library's own kinds
            raise ConnectionLost(f"the connection ended: {error}") from error
        if not isinstance(message, bytes):
            raise ConnectionLost("the server sent a text where a message was due")
        return message

    async def close(self) -> None:
        await self._socket.close()


def tls_context(endpoint: Endpoint, ca: str | None) -> ssl.SSLContext | None:
    """How an encrypted connection is made. None: it is not encrypted."""
    if not endpoint.encrypted:
        return None
    context = ssl.create_default_context(cafile=ca)
    context.minimum_version = ssl.TLSVersion.TLSv1_2
    return context


async def _open_framed(endpoint: Endpoint, tls: ssl.SSLContext | None, max_answer: int) -> FramedChannel:
    reader, writer = await asyncio.open_connection(endpoint.host, endpoint.port, ssl=tls, limit=_READ_AHEAD)
    return FramedChannel(reader, writer, max_answer)


async def _open_websocket(
    endpoint: Endpoint, tls: ssl.SSLContext | None, max_answer: int, model: str
) -> WebSocketChannel:
    try:
        websockets: Any = import_module("websockets")  # whose attributes are found late
    except ImportError as error:
        raise Unsupported("ws:// and wss:// need the package websockets") from error
    scheme = "wss" if endpoint.encrypted else "ws"
    try:
        socket = await websockets.connect(
            f"{scheme}://{endpoint.address}/ws" + (f"?model={quote(model, safe='')}" if model else ""),
            subprotocols=[websockets.Subprotocol(_SUBPROTOCOL)],
            compression=None,
            max_size=max_answer,
            ping_interval=None,
            ssl=tls,
        )
    except websockets.exceptions.WebSocketException as error:
        raise ConnectionLost(f"{endpoint.address}: {error}") from error
    return WebSocketChannel(socket)


async def open_channel(
    endpoint: Endpoint, ca: str | None, max_answer: int, model: str = ""
) -> tuple[Channel, Hello]:
    """Connects, exchanges hellos, and names the model that is meant, if any, to proxies. Raises ConnectionLost, VersionMismatch, Unavailable or Unsupported."""
    channel: FramedChannel | WebSocketChannel
    try:
        if endpoint.websocket:
            channel = await _open_websocket(endpoint, tls_context(endpoint, ca), max_answer, model)
        else:
            channel = await _open_framed(endpoint, tls_context(endpoint, ca), max_answer)
    except OSError as error:  # errors of TLS are among them
        raise ConnectionLost(f"{endpoint.address}: {error}") from error
    try:
        hello = await channel.say_hello(model)
        check_hello(hello)
    except BaseException:
        await channel.close()
        raise
    return channel, hello
