"""Views: frames in motion, and at rest the picture of `render`."""

from __future__ import annotations

import asyncio
import os
import shutil
from pathlib import Path

import pytest
from patience import PATIENCE

import surfcast
from surfcast import aio
from surfcast.testing import RunningServer, server

SIZE = (160, 120)


def moved(camera: surfcast.Camera, x: float) -> surfcast.Camera:
    return surfcast.Camera((camera.position[0] + x, *camera.position[1:]), camera.focal_point)


def test_a_view_at_rest_is_the_picture(field: surfcast.Model, camera: surfcast.Camera) -> None:
    with field.view(camera, resolution=SIZE, color_by="intensity") as view:
        frame = view.wait_converged(timeout=PATIENCE)
        assert frame.picture.data == field.render(camera, resolution=SIZE, color_by="intensity").data
        view.camera = moved(camera, 3)
        frame = view.wait_converged(timeout=PATIENCE)
        assert frame.update == 1
        assert frame.picture.data == field.render(view.camera, resolution=SIZE, color_by="intensity").data


def test_a_view_at_rest_shows_the_file_that_replaces_its_model(
    models: Path, camera: surfcast.Camera, tmp_path: Path
) -> None:
    shutil.copy(models / "degrees.surf", tmp_path / "field.surf")
    shutil.copy(models / "field.surf", tmp_path / "later.surf.part")
    os.utime(tmp_path / "field.surf", (1e9, 1e9))
    with server(tmp_path, arguments=["--model-refresh", "0.1"]) as started, started.connect() as connected:
        with connected["field"].view(camera, resolution=SIZE) as view:
            before = view.wait_converged(timeout=PATIENCE)
            (tmp_path / "later.surf.part").rename(tmp_path / "field.surf")
            after = next(frame for frame in view if frame.picture.converged and frame.number > before.number)
            assert after.update == before.update
            assert after.picture.data != before.picture.data
            assert after.picture.data == connected["field"].render(camera, resolution=SIZE).data


def test_the_newest_frame_wins(field: surfcast.Model, camera: surfcast.Camera) -> None:
    with field.view(camera, resolution=SIZE) as view:
        for step in range(20):
            view.update(moved(camera, step / 4), moving=True)
        view.update(moved(camera, 5))
        updates = []
        for frame in view:
            updates.append(frame.update)
            if frame.picture.converged:
                break
        assert updates == sorted(updates)
        assert updates[-1] == 21
        assert len(updates) < 21


def test_frames_have_the_depth_of_what_is_picked(field: surfcast.Model, camera: surfcast.Camera) -> None:
    with field.view(camera, resolution=SIZE, depth=True) as view:
        frame = view.wait_converged(timeout=PATIENCE)
        assert frame.picture.data == field.render(camera, resolution=SIZE).data
        assert frame.depth is not None
        rows, columns = frame.depth.inverse.shape
        cell = frame.depth.cell
        assert (columns, rows) == (-(-SIZE[0] // cell), -(-SIZE[1] // cell))
        x, y = SIZE[0] // 2, SIZE[1] // 2
        hit = field.pick((x, y), camera, resolution=SIZE)
        assert hit is not None
        assert 1 / frame.depth.inverse[y // cell, x // cell] == pytest.approx(hit.depth, rel=0.05)


def test_frames_have_no_depth_unless_it_is_asked_for(field: surfcast.Model, camera: surfcast.Camera) -> None:
    with field.view(camera, resolution=SIZE) as view:
        assert view.wait_converged(timeout=PATIENCE).depth is None


def test_frames_in_motion_are_marked(field: surfcast.Model, camera: surfcast.Camera) -> None:
    with field.view(camera, resolution=SIZE) as view:
        rest = view.wait_converged(timeout=PATIENCE)
        view.update(moved(camera, 1), moving=True)
        frame = view.next(after=rest, timeout=PATIENCE)
        assert frame.moving
        assert frame.resolution == SIZE


async def test_a_view_waits_for_frames_to_be_painted(running: RunningServer, camera: surfcast.Camera) -> None:
    async with aio.connect(running.address) as client:
        field = await client.model("field")
        async with field.view(camera, resolution=SIZE, acknowledge=False) as view:
            frame = await view.next(timeout=PATIENCE)
            seen = 1
            while not frame.picture.converged:
                await view.painted(frame)
                frame = await view.next(after=frame, timeout=PATIENCE)
                seen += 1
            assert frame.picture.data == (await field.render(camera, resolution=SIZE)).data


async def test_an_open_view_leaves_the_connection_to_others(running: RunningServer, camera: surfcast.Camera) -> None:
    async with aio.connect(running.address) as client:
        field = await client.model("field")
        async with field.view(camera, resolution=SIZE) as view:
            hit, picture, frame = await asyncio.gather(
                field.pick((80, 60), camera, resolution=SIZE), field.render(camera, resolution=SIZE), view.next()
            )
        assert hit is not None and picture.converged and frame.number >= 1
        frames = [frame async for frame in view]
        assert frames == []
