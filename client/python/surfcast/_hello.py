"""The first message of both sides. Its layout is the same in every version of the protocol."""

from __future__ import annotations

import struct
from dataclasses import dataclass
from urllib.parse import quote

from ._build import PROTOCOL, VERSION
from .errors import ConnectionLost, Unavailable, VersionMismatch

_MAGIC = b"\xf5SURFCST"
_HEADER = struct.Struct("<8sHHHHH")
_MAX_TEXT = 1024

HEADER_BYTES = _HEADER.size


@dataclass(frozen=True)
class Hello:
    """What a server says of itself."""

    protocol: tuple[int, int]
    status: int
    program: str
    message: str


def client_hello(model: str) -> bytes:
    """The hello of this client. Proxies choose a server by the model that it names, if it does."""
    program = f"surfcast-python {VERSION}".encode()
    if model:
        program += f" model={quote(model, safe='')}".encode()
    return _HEADER.pack(_MAGIC, *PROTOCOL, 0, len(program), 0) + program


def text_bytes(header: bytes) -> int:
    """The number of bytes that follow the header of a hello."""
    magic, _, _, _, program, message = _HEADER.unpack(header)
    if magic != _MAGIC or max(program, message) > _MAX_TEXT:
        raise ConnectionLost("what answers is no Surfcast server")
    return int(program + message)


def parse_hello(data: bytes) -> Hello:
    """Parses a whole hello. Raises ConnectionLost if it is none."""
    if len(data) < HEADER_BYTES or len(data) != HEADER_BYTES + text_bytes(data[:HEADER_BYTES]):
        raise ConnectionLost("what answers is no Surfcast server")
    _, major, minor, status, program, _ = _HEADER.unpack(data[:HEADER_BYTES])
    texts = data[HEADER_BYTES:]
    return Hello(
        (major, minor), status, texts[:program].decode(errors="replace"), texts[program:].decode(errors="replace")
    )


def check_hello(hello: Hello) -> None:
    """Raises VersionMismatch or Unavailable if the server does not go on with this client."""
    if hello.status == 2:
        raise Unavailable(hello.message or "the server is busy")
    if hello.protocol[0] != PROTOCOL[0] or hello.status == 1:
        said = hello.message or f"the server speaks version {hello.protocol[0]} of the protocol, not {PROTOCOL[0]}"
        raise VersionMismatch(said)
    if hello.status != 0:
        raise Unavailable(hello.message or f"the server refuses, with status {hello.status}")
