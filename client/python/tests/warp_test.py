"""Frames as another camera sees them, against scenes that are known in closed form."""

from __future__ import annotations

import dataclasses
import io
import time
from collections.abc import Callable

import numpy as np
import numpy.typing as npt
import pytest
from patience import PATIENCE
from PIL import Image

import surfcast
from surfcast._fill_colors import fill_colors
from surfcast._picture import picture_from
from surfcast._warp import _Lens
from surfcast._warp_mesh import Sheet, make_warp_mesh
from surfcast._wire import surfcast_pb2 as wire

SIZE = (320, 200)
CELL = 8
BACKGROUND = (10, 20, 30)
RED = (255, 0, 0)
Array = npt.NDArray[np.float64]
# Depth along the view axis and colour of what rays through pixels meet; a depth of 0 is nothing.
Scene = Callable[[Array, Array], tuple[Array, Array]]


def camera(eye: tuple[float, float, float], at: tuple[float, float, float]) -> surfcast.Camera:
    return surfcast.Camera(eye, at, (0, 1, 0), 40)


def pixels(size: tuple[int, int] = SIZE) -> Array:
    """The centres of all pixels, height x width x 2."""
    return np.stack(np.meshgrid(np.arange(size[0]) + 0.5, np.arange(size[1]) + 0.5), axis=-1)


def wall(eye: Array, rays: Array) -> tuple[Array, Array]:
    """The plane z = 0 in colours of its coordinates, which bilinear interpolation keeps."""
    depth = np.where(rays[..., 2] < 0, -eye[2] / np.minimum(rays[..., 2], -1e-9), 0)
    at = eye + depth[..., None] * rays
    color = np.stack([at[..., 0] / 8 + 0.5, at[..., 1] / 8 + 0.5, np.full(depth.shape, 0.5)], axis=-1)
    return depth, np.where(depth[..., None] > 0, np.clip(255 * color, 0, 255).astype(int), BACKGROUND)


def square(eye: Array, rays: Array) -> tuple[Array, Array]:
    """A red square at z = 1 in front of the wall."""
    depth = (1 - eye[2]) / rays[..., 2]
    at = eye + depth[..., None] * rays
    hit = (depth > 0) & (np.abs(at[..., :2]) < 0.5).all(axis=-1)
    behind, color = wall(eye, rays)
    return np.where(hit, depth, behind), np.where(hit[..., None], RED, color)


def seen(scene: Scene, by: surfcast.Camera, size: tuple[int, int] = SIZE) -> tuple[Array, Array]:
    lens = _Lens.of(by, size)
    return scene(lens.eye, lens.rays(pixels(size)))


def frame_of(
    scene: Scene, by: surfcast.Camera, *, size: tuple[int, int] = SIZE, cell: int = CELL, color: int | None = None
) -> surfcast.Frame:
    """A frame with the pixels of a scene, or of one grey."""
    depth, colors = seen(scene, by, size)
    inverse = np.divide(1, depth, out=np.zeros_like(depth), where=depth > 0)
    rows, columns = -(-size[1] // cell), -(-size[0] // cell)
    padded = np.pad(inverse, ((0, rows * cell - size[1]), (0, columns * cell - size[0])))
    texels = padded.reshape(rows, cell, columns, cell).max(axis=(1, 3)).astype(np.float32)
    file = io.BytesIO()
    Image.fromarray((colors if color is None else np.full_like(colors, color)).astype(np.uint8)).save(file, "png")
    picture = wire.Picture(data=file.getvalue(), format=wire.FILE_FORMAT_PNG, camera=by.to_wire())
    picture.resolution.width, picture.resolution.height = size
    return surfcast.Frame(1, 0, False, SIZE, picture_from(picture), time.monotonic(), 0, surfcast.Depth(cell, texels))


def off(warped: Array | npt.NDArray[np.uint8], truth: Array) -> Array:
    """The largest difference of a channel in each pixel, levels."""
    difference: Array = np.abs(warped.astype(np.float64) - truth).max(axis=-1)
    return difference


def source_pixels(scene: Scene, source: surfcast.Camera, target: surfcast.Camera) -> Array:
    """Where a frame shows what the target sees."""
    depth, _ = seen(scene, target)
    to, lens = _Lens.of(target, SIZE), _Lens.of(source, SIZE)
    along = (to.eye + depth[..., None] * to.rays(pixels()) - lens.eye) @ lens.axes.T
    places: Array = np.stack(
        [
            SIZE[0] / 2 + lens.eta * along[..., 0] / along[..., 2],
            SIZE[1] / 2 - lens.eta * along[..., 1] / along[..., 2],
        ],
        axis=-1,
    )
    return places


def inside(places: Array, margin: float) -> npt.NDArray[np.bool_]:
    result: npt.NDArray[np.bool_] = ((places > margin) & (places < np.asarray(SIZE) - margin)).all(axis=-1)
    return result


@pytest.mark.parametrize("with_rest", [False, True])
def test_the_same_camera_shows_the_frame(with_rest: bool) -> None:
    frame = frame_of(square, camera((0.3, 0.2, 4), (0, 0, 0)))
    warped = surfcast.warp(frame, frame.picture.camera, rest=frame if with_rest else None)
    assert (warped == frame.picture.array).all()


@pytest.mark.parametrize(
    ("source", "target", "cell", "margin"),
    [
        (camera((0, 0, 4), (0, 0, 0)), camera((0, 0, 4), (0.6, 0.3, 0)), CELL, 1),  # turns
        (camera((0, -2, 1.5), (0, 0, 0)), camera((0.4, -1.9, 1.4), (0, 0.1, 0)), 4, 8),  # slanted by 53 degrees
        (camera((0, 0, 4), (0, 0, 0)), camera((0.2, 0.1, 3), (0.2, 0.1, 0)), CELL, 8),  # comes nearer
    ],
)
def test_a_plane_is_the_plane_that_the_camera_sees(
    source: surfcast.Camera, target: surfcast.Camera, cell: int, margin: float
) -> None:
    warped = surfcast.warp(frame_of(wall, source, cell=cell), target)
    compared = inside(source_pixels(wall, source, target), margin)
    assert compared.mean() > 0.5
    assert off(warped, seen(wall, target)[1])[compared].max() <= 1


@pytest.mark.parametrize("step", [0.1, 0.3, 0.8])
def test_a_near_square_keeps_its_outline(step: float) -> None:
    target = camera((step, step / 2, 4), (step, step / 2, 0))
    warped = surfcast.warp(frame_of(square, camera((0, 0, 4), (0, 0, 0))), target)
    red = off(warped, np.asarray(RED)) <= 100
    truth = np.pad((seen(square, target)[1] == RED).all(axis=-1), 1)
    near = np.any([truth[y : y + SIZE[1], x : x + SIZE[0]] for y in range(3) for x in range(3)], axis=0)
    assert near[red].all()
    side = _Lens.of(target, SIZE).eta / 3
    assert red.sum() == pytest.approx(side * side, abs=4 * side)


def test_what_comes_out_behind_a_square_has_the_color_of_the_wall() -> None:
    target = camera((0.5, 0, 4), (0.5, 0, 0))
    warped = surfcast.warp(frame_of(square, camera((0, 0, 4), (0, 0, 0))), target)
    truth = seen(square, target)[1]
    behind = ~(truth == RED).all(axis=-1) & (off(warped, np.asarray(RED)) > 150)
    assert off(warped, truth)[40:-40, 40:-80][behind[40:-40, 40:-80]].max() <= 60


def test_what_comes_out_has_the_mean_color_of_what_is_behind() -> None:
    source = camera((0, 0, 4), (0, 0, 0))
    target = camera((0.9, 0, 4), (0.9, 0, 0))

    def lines(eye: Array, rays: Array) -> tuple[Array, Array]:
        depth, color = square(eye, rays)
        lens = _Lens.of(source, SIZE)
        along = (eye + depth[..., None] * rays - lens.eye) @ lens.axes.T
        row = np.floor(SIZE[1] / 2 - lens.eta * along[..., 1] / along[..., 2])
        levels = np.stack([np.zeros_like(row), np.where(row % 2 == 0, 100, 200), np.zeros_like(row)], axis=-1)
        return depth, np.where((color == RED).all(axis=-1, keepdims=True), color, levels)

    warped = surfcast.warp(frame_of(lines, source), target)
    # (Within a cell of the outline, pixels of the wall may be taken for the square.)
    clear = np.roll((seen(square, target)[1] != RED).any(axis=-1), CELL, axis=1)
    unseen = np.abs(source_pixels(wall, source, target)[..., 0] - SIZE[0] / 2) < _Lens.of(target, SIZE).eta / 6 - 10
    opened = (clear & unseen)[70:130]
    assert opened.sum() > 100
    assert off(warped, np.asarray((0, 150, 0)))[70:130][opened].max() <= 1


def test_beyond_the_border_a_reflection_fades_to_the_mean_color_there() -> None:
    source = camera((0, 0, 4), (0, 0, 0))
    target = camera((0, 0, 4), (0.4, 0, 0))  # a turn to the right

    def stripes(eye: Array, rays: Array) -> tuple[Array, Array]:
        depth, _ = wall(eye, rays)
        light = (eye + depth[..., None] * rays)[..., 0] % 0.2 < 0.1  # 7 pixels each
        return depth, np.where(light[..., None], 200, 100) + np.zeros(3)

    frame = frame_of(stripes, source)
    row = SIZE[1] // 2
    warped = surfcast.warp(frame, target)[row, :, 0].astype(float)
    beyond = source_pixels(wall, source, target)[row, :, 0] - SIZE[0]
    reflected = (SIZE[0] - beyond).astype(int)
    shown = frame.picture.array[row, :, 0].astype(float)
    column = np.clip(reflected, 1, SIZE[0] - 2)
    plain = (beyond > 1) & (shown[column - 1] == shown[column + 1])  # not between two stripes
    kept = (1 - np.clip(beyond / (SIZE[1] / 4), 0, 1)) ** 2
    expected = kept * shown[column] + (1 - kept) * 150
    assert plain.sum() > 20
    assert np.abs(warped - expected)[plain].max() <= 12


def test_behind_a_surface_no_triangle_joins_another_one_and_background() -> None:
    x, y = np.meshgrid(np.arange(16), np.arange(9))
    near = (x > 4) & (x < 10) & (y > 2) & (y < 6)
    inverse = np.where(near, 1, np.where(x + y < 12, 0.2, 0)).astype(np.float32)
    mesh = make_warp_mesh(surfcast.Depth(CELL, inverse), (128, 72))
    opened = (mesh.inverse[mesh.sheet == Sheet.FAR] == 0).sum(axis=1)
    assert set(opened) == {0, 3}


def test_fill_colors_do_not_mix_surfaces() -> None:
    part = np.arange(24) // 8  # near, far, background
    picture = np.broadcast_to(255 * np.eye(3, dtype=np.uint8)[part], (8, 24, 3))
    inverse = np.broadcast_to(np.array([1, 1, 0.5, 0.5, 0, 0], np.float32), (2, 6))
    colors = fill_colors(picture, surfcast.Depth(4, inverse)).reshape(2, 6, 3)
    assert (colors == 255 * np.eye(3, dtype=np.uint8)[[0, 0, 1, 1, 2, 2]]).all()
    # Pixels are weighed, not texels: the last one has a single column.
    narrow = np.zeros((4, 17, 3), np.uint8)
    narrow[:, 16] = (170, 17, 255)
    colors = fill_colors(narrow, surfcast.Depth(4, np.ones((1, 5), np.float32)))
    assert colors[[0, 2, 4]].tolist() == [[0, 0, 0], [10, 1, 15], [19, 2, 28]]


def test_a_sharper_frame_at_rest_is_shown_where_it_agrees() -> None:
    target = camera((0.1, 0, 4), (0.1, 0, 0))
    half = (SIZE[0] // 2, SIZE[1] // 2)
    rest = frame_of(wall, camera((0, 0, 4), (0, 0, 0)))
    newest = frame_of(wall, target, size=half, cell=CELL // 2, color=0)
    both, alone = surfcast.warp(newest, target, rest=rest), surfcast.warp(rest, target)
    assert (both[:, : SIZE[0] - 16] == alone[:, : SIZE[0] - 16]).all()
    assert (both[:, -1] == 0).all()  # beyond the border of the frame at rest
    square_at_rest = frame_of(square, target)
    assert not (surfcast.warp(newest, target, rest=square_at_rest)[100, 160] == RED).all()


@pytest.mark.parametrize(("difference", "seen_through", "shown"), [(20, True, 100), (60, True, 160), (60, False, 100)])
def test_where_things_are_seen_through_a_frame_at_rest_has_to_look_the_same(
    difference: int, seen_through: bool, shown: int
) -> None:
    target = camera((0, 0, 4), (0, 0, 0))
    rest = frame_of(wall, target, color=100)
    assert rest.depth is not None
    rest = dataclasses.replace(rest, depth=dataclasses.replace(rest.depth, seen_through=seen_through))
    half = (SIZE[0] // 2, SIZE[1] // 2)
    newest = frame_of(wall, target, size=half, cell=CELL // 2, color=100 + difference)
    assert (surfcast.warp(newest, target, rest=rest)[50, 50] == shown).all()


def test_where_nothing_was_seen_is_background() -> None:
    frame = frame_of(wall, camera((0, 0, 4), (0, 0, 0)))
    away = surfcast.warp(frame, camera((0, 0, 4), (0, 0, 8)), background=BACKGROUND)
    assert (away == BACKGROUND).all()


def test_a_resolution_of_its_own_and_what_is_refused() -> None:
    frame = frame_of(wall, camera((0, 0, 4), (0, 0, 0)))
    assert surfcast.warp(frame, frame.picture.camera, resolution=(64, 40)).shape == (40, 64, 3)
    with pytest.raises(surfcast.InvalidInput, match="depth=True"):
        surfcast.warp(dataclasses.replace(frame, depth=None), frame.picture.camera)
    with pytest.raises(surfcast.InvalidInput, match="view_up"):
        surfcast.warp(frame, surfcast.Camera((0, 0, 4), (0, 0, 0)))


def test_a_frame_of_a_server_is_nearer_to_the_truth_than_as_it_is(
    field: surfcast.Model, camera: surfcast.Camera
) -> None:
    size = (160, 120)
    with field.view(camera, resolution=size, depth=True) as view:
        frame = view.wait_converged(timeout=PATIENCE)
    now = frame.picture.camera
    moved = dataclasses.replace(now, position=(now.position[0] + 2, now.position[1] + 1, now.position[2]))
    truth = field.render(moved, resolution=size).array.astype(np.float64)

    def error(shown: npt.NDArray[np.uint8]) -> float:
        return float(np.mean((shown - truth) ** 2))

    assert error(surfcast.warp(frame, moved)) < 0.5 * error(frame.picture.array)
