"""Servers of the tests."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest
from sample_models import Scan, build, make_scan, write_degrees, write_las, write_tensors, write_volume

import surfcast
from surfcast.testing import RunningServer, server


@pytest.fixture(scope="session")
def scan() -> Scan:
    return make_scan()


@pytest.fixture(scope="session")
def models(tmp_path_factory: pytest.TempPathFactory, scan: Scan) -> Path:
    """A folder with the models `field`, `ball`, `tensors` and `degrees`."""
    folder = tmp_path_factory.mktemp("models")
    write_las(scan, folder / "field.las")
    write_volume(folder / "ball.nrrd")
    write_tensors(folder / "tensors.csv")
    for source in ("field.las", "ball.nrrd", "tensors.csv"):
        build(folder / source, (folder / source).with_suffix(".surf"))
        (folder / source).unlink()
    write_degrees(folder / "degrees.csv")
    build(folder / "degrees.csv", folder / "degrees.surf", "--crs", "EPSG:4326")
    (folder / "degrees.csv").unlink()
    return folder


@pytest.fixture(scope="session")
def running(models: Path) -> Iterator[RunningServer]:
    with server(models) as started:
        yield started


@pytest.fixture(scope="session")
def client(running: RunningServer) -> Iterator[surfcast.Server]:
    with running.connect() as connected:
        yield connected


@pytest.fixture(scope="session")
def field(client: surfcast.Server) -> surfcast.Model:
    return client["field"]


@pytest.fixture(scope="session")
def ball(client: surfcast.Server) -> surfcast.Model:
    return client["ball"]


@pytest.fixture
def camera(scan: Scan) -> surfcast.Camera:
    """Above the field, slanted."""
    centre = scan.xyz.mean(axis=0)
    return surfcast.Camera(centre + (4.0, -30.0, 25.0), centre)
