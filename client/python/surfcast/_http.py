"""What is asked of a server by HTTP, on the same port: uploads, saved views and annotations."""

from __future__ import annotations

import http.client
import json
from collections.abc import Mapping
from contextlib import suppress
from os import PathLike
from pathlib import Path
from typing import IO, Any
from urllib.parse import quote

import numpy as np

from . import errors
from ._channel import tls_context
from ._connection import Settings
from ._endpoint import Endpoint
from ._values import Annotation, Annotations, SavedView

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


def _ask(
    endpoint: Endpoint,
    settings: Settings,
    request: tuple[str, str],
    body: IO[bytes] | bytes | None,
    headers: Mapping[str, str],
    timeout: float | None,
) -> tuple[int, http.client.HTTPMessage, bytes]:
    """Status, headers and body of the answer to a request, which is method and path. The timeout is for each step."""
    if settings.token:
        headers = {**headers, "Authorization": f"Bearer {settings.token}"}
    connection = _open(endpoint, settings, settings.timeout if timeout is None else timeout)
    try:
        with suppress(BrokenPipeError, ConnectionResetError):  # a refusal may come before the whole body was sent
            connection.request(*request, body, headers)
        answer = connection.getresponse()
        return answer.status, answer.headers, answer.read()
    except TimeoutError as error:
        raise errors.Timeout(f"{endpoint.address}: {request[1]} stood still") from error
    except (OSError, http.client.HTTPException) as error:
        raise errors.ConnectionLost(f"{endpoint.address}: {error}") from error
    finally:
        connection.close()


def send_file(
    endpoint: Endpoint, settings: Settings, path: str | PathLike[str], name: str | None, timeout: float | None
) -> str | None:
    """Sends a file; returns the name of the model that is built of it, or None for a file that others name.

    The timeout is for each step of the transfer.
    """
    source = Path(path)
    headers = {"Content-Length": str(source.stat().st_size)}
    request = ("PUT", f"/api/uploads/{quote(name or source.name)}")
    with source.open("rb") as file:
        status, _, text = _ask(endpoint, settings, request, file, headers, timeout)
    if status != 201:
        raise _refused(status, text)
    taken: Any = json.loads(text)
    model: str | None = taken.get("model")
    return model


def _annotations_path(model: str) -> str:
    return f"/api/models/{quote(model, safe='')}/annotations"


def _annotations_from(status: int, headers: http.client.HTTPMessage, text: bytes) -> Annotations:
    if status != 200:
        raise _refused(status, text)
    document = json.loads(text)
    return Annotations(
        tuple(SavedView(view["name"], view["parameters"]) for view in document["views"]),
        tuple(
            Annotation(entry["text"], np.array(entry["position"], np.float64), entry["parameters"])
            for entry in document["annotations"]
        ),
        headers.get("ETag", "").strip('"'),
        "PUT" in headers.get("Allow", ""),
    )


def read_annotations(endpoint: Endpoint, settings: Settings, model: str, timeout: float | None) -> Annotations:
    """The saved views and annotations of a model."""
    return _annotations_from(*_ask(endpoint, settings, ("GET", _annotations_path(model)), None, {}, timeout))


def write_annotations(
    endpoint: Endpoint, settings: Settings, model: str, annotations: Annotations, timeout: float | None
) -> Annotations:
    """Replaces the saved views and annotations of a model, if they still have the edition of `annotations`."""
    document = {
        "format": "surfcast-annotations",
        "version": 1,
        "views": [{"name": view.name, "parameters": dict(view.parameters)} for view in annotations.views],
        "annotations": [
            {
                "text": entry.text,
                "position": [float(coordinate) for coordinate in entry.position],
                "parameters": dict(entry.parameters),
            }
            for entry in annotations.annotations
        ],
    }
    headers = {"If-Match": f'"{annotations.edition}"'} if annotations.edition else {}
    request = ("PUT", _annotations_path(model))
    body = json.dumps(document).encode()
    return _annotations_from(*_ask(endpoint, settings, request, body, headers, timeout))
