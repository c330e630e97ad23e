"""Picks and profiles: source coordinates and attributes, as they are in the file."""

from __future__ import annotations

import numpy as np
import pytest
from sample_models import OFFSET, SCALE, Scan

import surfcast

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


def test_measures_of_known_figures() -> None:
    far = np.array((456000.0, 5428000.0, 100.0))
    corners = [far + c for c in ((0, 0, 0), (3, 0, 4), (3, 6, 4), (0, 6, 0))]
    assert surfcast.measure.area(corners) == pytest.approx(30, abs=1e-9)
    assert surfcast.measure.distance(corners[0], corners[1]) == pytest.approx(5, abs=1e-9)
    assert surfcast.measure.length(corners[:3]) == pytest.approx(11, abs=1e-9)
    assert surfcast.measure.height(corners[0], corners[1]) == 4
    assert surfcast.measure.angle((1, 0, 0), (0, 0, 0), (0, 2, 0)) == pytest.approx(90)
    assert surfcast.measure.angle((1, 0, 0), (0, 0, 0), (1, 1e-9, 0)) == pytest.approx(np.degrees(1e-9))
