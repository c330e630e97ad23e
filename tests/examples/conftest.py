"""Folders and servers of the tests of the examples."""

from __future__ import annotations

import os
import subprocess
from collections.abc import Iterator
from pathlib import Path

import pytest

from surfcast.testing import RunningServer, server


@pytest.fixture(scope="session")
def examples() -> Path:
    """The folder of the examples."""
    return Path(os.environ["EXAMPLES"]).parent


@pytest.fixture(scope="session")
def lion(examples: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The model of the lion."""
    model = tmp_path_factory.mktemp("models") / "lion.surf"
    scan = examples.parents[1] / "tests/data/lion.drc"
    subprocess.run([os.environ["SURFCASTD"], "build", scan, "--output", model], check=True, capture_output=True)
    return model


@pytest.fixture(scope="session")
def running(lion: Path) -> Iterator[RunningServer]:
    with server(lion) as started:
        yield started
