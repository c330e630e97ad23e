"""Addresses of servers and the tokens that are kept for them."""

from __future__ import annotations

import json
import os
from dataclasses import dataclass
from pathlib import Path

from .errors import InvalidInput

_SCHEMES = {"tcp": (False, False), "ws": (True, False), "tcps": (False, True), "wss": (True, True)}


@dataclass(frozen=True)
class Endpoint:
    """The address of a server, and the transport to it."""

    host: str
    port: int
    websocket: bool
    encrypted: bool

    @property
    def address(self) -> str:
        """HOST:PORT; an IPv6 address is in brackets."""
        return f"[{self.host}]:{self.port}" if ":" in self.host else f"{self.host}:{self.port}"


def _split_scheme(text: str) -> tuple[str, str]:
    scheme, found, address = text.partition("://")
    return (scheme, address) if found else ("tcp", text)


def _host_of(text: str) -> str | None:
    if text.startswith("[") and text.endswith("]"):
        return text[1:-1] or None
    return None if not text or set(text) & set(":[]/") else text


def parse_endpoint(text: str) -> Endpoint:
    """Parses HOST:PORT with the schemes tcp, tcps, ws and wss. Without a scheme it is tcp."""
    scheme, address = _split_scheme(text)
    name, _, port = address.rpartition(":")
    host = _host_of(name)
    if scheme not in _SCHEMES or host is None or not (port.isascii() and port.isdigit()) or int(port) > 65535:
        raise InvalidInput(f"'{text}': expected HOST:PORT, optionally with tcp://, tcps://, ws:// or wss:// before it")
    websocket, encrypted = _SCHEMES[scheme]
    return Endpoint(host, int(port), websocket, encrypted)


def _token_store() -> Path:
    config = os.environ.get("XDG_CONFIG_HOME")
    return (Path(config) if config else Path.home() / ".config") / "surfcast" / "tokens.json"


def find_token(endpoint: Endpoint) -> str | None:
    """The token of SURFCAST_TOKEN, or what `surfcast login` has kept for the server."""
    named = os.environ.get("SURFCAST_TOKEN")
    if named is not None:
        return named or None
    try:
        tokens = json.loads(_token_store().read_text())
    except (OSError, RuntimeError, ValueError):
        return None
    key = ("tcps://" if endpoint.encrypted else "tcp://") + endpoint.address
    token = tokens.get(key) if isinstance(tokens, dict) else None
    return token if isinstance(token, str) else None
