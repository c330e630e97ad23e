"""Sends scans to a server, by HTTP on the same port."""

from __future__ import annotations

import http.client
import json
from collections.abc import Mapping
from os import PathLike
from pathlib import Path
from typing import Any
from urllib.parse import quote

from . import errors
from ._channel import tls_context
from ._connection import Settings
from ._endpoint import Endpoint

_KINDS: Mapping[str, type[errors.Error]] = {
    "invalid_input": errors.InvalidInput,
    "limit": errors.Limit,
    "not_found": errors.NotFound,
    "unsupported": errors.Unsupported,
    "unavailable": errors.Unavailable,
    "cancelled": errors.Cancelled,
    "denied": errors.Denied,
}


def _open(endpoint: Endpoint, settings: Settings, timeout: float) -> http.client.HTTPConnection:
    context = tls_context(endpoint, settings.ca)
    if context is None:
        return http.client.HTTPConnection(endpoint.host, endpoint.port, timeout=timeout)
    return http.client.HTTPSConnection(endpoint.host, endpoint.port, timeout=timeout, context=context)


def _refused(status: int, text: bytes) -> errors.Error:
    try:
        error = json.loads(text)["error"]
        return _KINDS.get(error["kind"], errors.ServerFault)(error["message"])
    except (KeyError, TypeError, ValueError):
        return errors.ServerFault(f"the server answered {status}")


def send_file(
    endpoint: Endpoint, settings: Settings, path: str | PathLike[str], name: str | None, timeout: float | None
) -> str | None:
    """Sends a file; returns the name of the model that is built of it, or None for a file that others name.

    The timeout is for each step of the transfer.
    """
    source = Path(path)
    headers = {"Content-Length": str(source.stat().st_size)}
    if settings.token:
        headers["Authorization"] = f"Bearer {settings.token}"
    connection = _open(endpoint, settings, settings.timeout if timeout is None else timeout)
    try:
        with source.open("rb") as file:
            try:
                connection.request("PUT", f"/api/uploads/{quote(name or source.name)}", file, headers)
            except (BrokenPipeError, ConnectionResetError):
                pass  # a refusal may come before the whole file was sent
        answer = connection.getresponse()
        text = answer.read()
    except TimeoutError as error:
        raise errors.Timeout(f"{endpoint.address}: the upload of {source.name} stood still") from error
    except (OSError, http.client.HTTPException) as error:
        raise errors.ConnectionLost(f"{endpoint.address}: {error}") from error
    finally:
        connection.close()
    if answer.status != 201:
        raise _refused(answer.status, text)
    taken: Any = json.loads(text)
    model: str | None = taken.get("model")
    return model
