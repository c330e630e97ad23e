"""The lion looks as before from two places.

    SURFCASTD=build/bin/surfcastd python3 -m pytest docs/examples/picture_test
    SURFCASTD=build/bin/surfcastd python3 -m pytest docs/examples/picture_test --surfcast-update
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

import surfcast
from surfcast.testing import RunningServer, assert_image

HERE = Path(__file__).resolve().parent
SCAN = HERE.parents[2] / "tests/data/lion.drc"

CAMERAS = {
    "front": surfcast.Camera(position=(1.5, -3, 2.5), focal_point=(-2.85, 3.4, -1.25), view_angle=37),
    "head": surfcast.Camera(position=(-1.5, -1.5, 1.5), focal_point=(-2.85, 3.4, 0.5), view_angle=25),
}


@pytest.fixture(scope="module")
def lion(surfcast_server: Callable[..., RunningServer]) -> Iterator[surfcast.Model]:
    """The scan as a model, which the server builds at its start."""
    with surfcast_server(SCAN).connect() as server:
        model = server["lion"]
        model.wait_complete()
        yield model


@pytest.mark.parametrize("name", CAMERAS)
def test_the_lion_looks_as_before(lion: surfcast.Model, name: str) -> None:
    picture = lion.render(CAMERAS[name], resolution=(240, 160))
    assert_image(picture, HERE / "golden" / f"{name}.png", psnr=40)
