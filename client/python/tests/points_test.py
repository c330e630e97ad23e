"""Picks and profiles: source coordinates and attributes, as they are in the file."""

from __future__ import annotations

import asyncio

import numpy as np
import pytest
from sample_models import OFFSET, SCALE, SOUTH, STEP, WEST, Scan

import surfcast
from surfcast.testing import RunningServer

SIZE = (160, 120)


def row_of(scan: Scan, position: np.ndarray[tuple[int], np.dtype[np.float64]]) -> int:
    """The point of the scan at a position."""
    return int(np.abs(scan.xyz - position).sum(axis=1).argmin())


def test_a_pick_is_a_point_of_the_file(field: surfcast.Model, scan: Scan, camera: surfcast.Camera) -> None:
    hit = field.pick((80, 60), camera, resolution=SIZE)
    assert hit is not None
    row = row_of(scan, hit.position)
    np.testing.assert_array_equal(np.round((hit.position - OFFSET) / SCALE), np.round((scan.xyz[row] - OFFSET) / SCALE))
    np.testing.assert_allclose(hit.position, scan.xyz[row], rtol=0, atol=1e-9)
    assert hit.attributes["intensity"] == scan.intensity[row]
    assert hit.attributes["classification"] == scan.classification[row]
    assert hit.normal is not None and abs(np.linalg.norm(hit.normal) - 1) < 1e-6
    assert hit.distance == pytest.approx(surfcast.measure.distance(hit, camera.position))


def test_the_background_is_no_hit(field: surfcast.Model, camera: surfcast.Camera) -> None:
    assert field.pick((0, 0), camera, resolution=SIZE) is None


def test_many_picks_are_those_one_by_one(field: surfcast.Model, camera: surfcast.Camera) -> None:
    pixels = [(x, y) for y in range(10, 120, 20) for x in range(5, 160, 10)]
    many = field.pick_many(pixels, camera, resolution=SIZE)
    assert len(many) == len(pixels)
    for pixel, hit in list(zip(pixels, many))[::7]:
        alone = field.pick(pixel, camera, resolution=SIZE)
        assert (hit and hit.surfel) == (alone and alone.surfel)


def test_picks_pass_through_what_is_hidden(field: surfcast.Model, scan: Scan, camera: surfcast.Camera) -> None:
    pixels = [(x, 60) for x in range(60, 110, 2)]
    hits = field.pick_many(pixels, camera, resolution=SIZE, hide_classes=[6])
    assert {hit.attributes["classification"] for hit in hits if hit} == {2}


def test_a_profile_is_a_band_of_the_file(field: surfcast.Model, scan: Scan) -> None:
    a, b = OFFSET + (2, 3, 0), OFFSET + (27, 22, 0)
    profile = field.profile([a, b], 0.8)
    along = (b - a)[:2] / np.linalg.norm((b - a)[:2])
    offset = (scan.xyz - a)[:, :2]
    distance = offset @ (-along[1], along[0])
    course = offset @ along
    inside = (abs(distance) <= 0.4) & (course >= 0) & (course <= np.linalg.norm((b - a)[:2]))
    assert profile.total == profile.count == inside.sum()
    order = np.argsort(course[inside], kind="stable")
    np.testing.assert_allclose(profile["xyz"], scan.xyz[inside][order], rtol=0, atol=1e-9)
    np.testing.assert_allclose(profile["along"], course[inside][order], atol=1e-6)
    np.testing.assert_array_equal(profile["intensity"], scan.intensity[inside][order])
    np.testing.assert_array_equal(profile["rgb"], scan.rgb[inside][order])
    np.testing.assert_allclose(profile.scale, SCALE)


def test_a_profile_of_few_points_says_how_many_there_are(field: surfcast.Model) -> None:
    profile = field.profile([OFFSET, OFFSET + (30, 30, 0)], 2, max_points=50)
    assert profile.count == 50 < profile.total


def sorted_rows(*columns: np.ndarray[tuple[int, ...], np.dtype[np.generic]]) -> list[tuple[object, ...]]:
    """The rows of columns, in an order of their own."""
    return sorted(tuple(np.atleast_1d(part).tolist() for part in row) for row in zip(*columns))


def test_points_of_a_region_are_those_that_a_filter_of_the_file_finds(field: surfcast.Model, scan: Scan) -> None:
    low, high = OFFSET + (4, 3, -1), OFFSET + (20, 17.25, 1.5)
    points = field.points(box=(low, high), classes=[2])
    inside = ((scan.xyz >= low) & (scan.xyz <= high)).all(axis=1) & (scan.classification == 2)
    assert 1000 < inside.sum() < len(scan.xyz)
    assert points.count == points.total == inside.sum()
    assert points["xyz"].dtype == np.float64 and points["rgb"].dtype == np.uint16
    assert points["intensity"].dtype == np.uint16 and points["classification"].dtype == np.uint8
    ours = sorted_rows(points["xyz"], points["rgb"], points["intensity"], points["classification"])
    theirs = (scan.xyz[inside], scan.rgb[inside], scan.intensity[inside], scan.classification[inside])
    assert ours == sorted_rows(*theirs)
    assert field.count_points(box=(low, high), classes=[2]) == points.count


def test_points_of_a_corridor_and_of_several_boxes(field: surfcast.Model, scan: Scan) -> None:
    a, b = (OFFSET + (2, 3, 0))[:2], (OFFSET + (2, 25, 0))[:2]
    corridor = surfcast.Corridor([a, b], 1.0, low=OFFSET[2], high=OFFSET[2] + 1)
    near = abs(scan.xyz[:, 0] - a[0]) <= 0.5
    along = (scan.xyz[:, 1] >= a[1]) & (scan.xyz[:, 1] <= b[1])
    level = (scan.xyz[:, 2] >= OFFSET[2]) & (scan.xyz[:, 2] <= OFFSET[2] + 1)
    assert field.count_points(corridor=corridor) == (near & along & level).sum() > 50
    corners = [(OFFSET - 50, OFFSET + (3, 3, 50)), (OFFSET + (2, 2, -50), OFFSET + (4, 4, 50))]
    inside = np.zeros(len(scan.xyz), dtype=bool)
    for low, high in corners:
        inside |= ((scan.xyz >= low) & (scan.xyz <= high)).all(axis=1)
    assert field.count_points(box=corners) == inside.sum()
    assert field.count_points(box=[surfcast.Box(*box) for box in corners]) == inside.sum()


def test_points_have_the_attributes_that_are_asked_for(field: surfcast.Model, scan: Scan) -> None:
    points = field.points(attributes=["intensity"], every=100, normals=True)
    assert list(points) == ["xyz", "normals", "rgb", "intensity"]
    assert points.count == -(-len(scan.xyz) // 100)
    np.testing.assert_allclose(np.linalg.norm(points["normals"], axis=1), 1, atol=1e-6)
    with pytest.raises(surfcast.InvalidInput, match="there is no 'height'"):
        field.points(attributes=["height"], every=1000)


def test_a_region_without_points_has_empty_columns(field: surfcast.Model) -> None:
    points = field.points(box=((0, 0, 0), (1, 1, 1)))
    assert points.count == 0 and points["xyz"].shape == (0, 3)
    assert points["intensity"].dtype == np.uint16


def test_a_scan_in_degrees_keeps_its_coordinates(client: surfcast.Server, field: surfcast.Model) -> None:
    model = client["degrees"]
    assert model.crs is not None and model.crs.id == "EPSG:32632"
    source = model.info().source_crs
    assert source is not None and (source.name, source.id) == ("WGS 84", "EPSG:4326")
    assert field.crs is None and field.info().source_crs is None
    hit = model.pick((80, 60), resolution=SIZE)
    assert hit is not None and hit.source_position is not None
    assert hit.position[0] > 400_000 and abs(hit.source_position[0] - WEST) < 30 * STEP
    steps = (model.points()["xyz"][:, :2] - (WEST, SOUTH)) / STEP
    np.testing.assert_allclose(steps, np.round(steps), atol=2e-3)  # a millimetre is 0.0014
    assert len({(int(u), int(v)) for u, v in np.round(steps)}) == 900
    assert (model.points(coordinates="world")["xyz"][:, 0] > 400_000).all()


def test_points_for_asyncio(running: RunningServer, scan: Scan) -> None:
    async def ask() -> None:
        async with surfcast.aio.connect(running.address) as server:
            model = await server.model("field")
            points, count = await asyncio.gather(model.points(every=10), model.count_points())
            assert points.count == -(-len(scan.xyz) // 10) and count == len(scan.xyz)
            given_up = asyncio.create_task(model.points())
            await asyncio.sleep(0)  # until it has begun
            given_up.cancel()
            with pytest.raises(asyncio.CancelledError):
                await given_up
            assert (await model.points()).count == len(scan.xyz)

    asyncio.run(ask())


def test_regions_that_are_refused(field: surfcast.Model, ball: surfcast.Model) -> None:
    with pytest.raises(surfcast.Limit, match="more than 100 points"):
        field.points(limit=100)
    with pytest.raises(surfcast.InvalidInput, match="the lower corner comes first"):
        field.points(box=((1, 0, 0), (0, 1, 1)))
    with pytest.raises(surfcast.InvalidInput, match="finite"):
        field.points(box=((float("nan"), 0, 0), (0, 1, 1)))
    with pytest.raises(surfcast.InvalidInput, match="there is no option 'boxes'"):
        field.points(boxes=())  # type: ignore[call-arg]
    with pytest.raises(surfcast.Unsupported, match="ball: has no points, but blocks of kind grid"):
        ball.points()


def test_measures_of_known_figures() -> None:
    far = np.array((456000.0, 5428000.0, 100.0))
    corners = [far + c for c in ((0, 0, 0), (3, 0, 4), (3, 6, 4), (0, 6, 0))]
    assert surfcast.measure.area(corners) == pytest.approx(30, abs=1e-9)
    assert surfcast.measure.distance(corners[0], corners[1]) == pytest.approx(5, abs=1e-9)
    assert surfcast.measure.length(corners[:3]) == pytest.approx(11, abs=1e-9)
    assert surfcast.measure.height(corners[0], corners[1]) == 4
    assert surfcast.measure.angle((1, 0, 0), (0, 0, 0), (0, 2, 0)) == pytest.approx(90)
    assert surfcast.measure.angle((1, 0, 0), (0, 0, 0), (1, 1e-9, 0)) == pytest.approx(np.degrees(1e-9))
