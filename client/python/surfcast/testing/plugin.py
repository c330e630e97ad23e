"""The plugin of pytest. The client is imported when a test asks for it."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator
from contextlib import ExitStack
from typing import TYPE_CHECKING, Any

import pytest

if TYPE_CHECKING:
    from . import RunningServer


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.getgroup("surfcast").addoption(
        "--surfcast-update", action="store_true", help="make the pictures of the tests the golden ones"
    )


def pytest_configure(config: pytest.Config) -> None:
    if config.getoption("--surfcast-update"):
        os.environ["SURFCAST_UPDATE_GOLDEN"] = "1"


@pytest.fixture(scope="session")
def surfcast_server() -> Iterator[Callable[..., RunningServer]]:
    """Starts servers, by the parameters of `surfcast.testing.server`. They run until all tests are done."""
    from . import server

    servers: dict[str, RunningServer] = {}
    with ExitStack() as stack:

        def start(paths: Any, **settings: Any) -> RunningServer:
            key = repr((paths, sorted(settings.items())))
            if key not in servers:
                servers[key] = stack.enter_context(server(paths, **settings))
            return servers[key]

        yield start
