"""The example of a notebook."""

from __future__ import annotations

import base64
from importlib import import_module
from pathlib import Path
from typing import Any

import pytest
from nbclient.client import NotebookClient

import surfcast
from surfcast.testing import RunningServer


def test_the_notebook_runs_and_shows_the_pictures_of_the_server(
    examples: Path, running: RunningServer, monkeypatch: pytest.MonkeyPatch
) -> None:
    formats: Any = import_module("nbformat")  # without types
    book = formats.read(examples / "notebook/lion.ipynb", as_version=4)
    cells = [cell for cell in book.cells if cell.cell_type == "code"]
    assert all(not cell.outputs and cell.execution_count is None for cell in cells), "outputs are not kept"
    monkeypatch.setenv("SURFCAST_SERVER", running.address)
    NotebookClient(book, timeout=300, kernel_name="python3", resources={}).execute()

    shown = {next(iter(cell.source.splitlines()[-1:])): cell.outputs for cell in cells}
    camera = surfcast.Camera(position=(1.5, -3, 2.5), focal_point=(-2.85, 3.4, -1.25), view_angle=37)
    with running.connect() as server:
        lion = server["lion"]
        picture = lion.render(camera, resolution=(480, 320))
        hit = lion.pick((240, 160), camera, resolution=(480, 320))
        assert f"{lion.surfels} surfels" in shown["lion.bounds"][0].text
    (drawn,) = shown["lion.render(camera, resolution=size)"]
    assert base64.b64decode(drawn.data["image/png"]) == picture.data
    (depth,) = shown["Image.fromarray(gray.astype(np.uint8))"]
    assert depth.data["image/png"]
    (point,) = shown["hit.position, hit.color"]
    assert hit is not None and point.data["text/plain"].startswith(repr((hit.position, hit.color))[:20])
    (heights,) = shown["heights"]
    assert heights.data["text/plain"].count(",") == 9
    (widget,) = shown["view"]
    assert "application/javascript" in widget.data
