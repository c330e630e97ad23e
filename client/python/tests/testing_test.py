"""surfcast.testing: comparisons, golden pictures, and the plugin of pytest."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import surfcast
from surfcast.testing import assert_image, compare

pytest_plugins = ["pytester"]
SIZE = (96, 64)


def test_equal_pictures_have_no_noise(field: surfcast.Model) -> None:
    picture = field.render(resolution=SIZE)
    comparison = compare(picture, picture.array)
    assert comparison.psnr == np.inf and comparison.largest == 0 and comparison.differing == 0


def test_noise_is_measured_in_decibels() -> None:
    black = np.zeros((10, 10, 3), dtype=np.uint8)
    spot = black.copy()
    spot[4, 4] = (51, 51, 51)  # a fifth of the range in a hundredth of the pixels
    comparison = compare(spot, black)
    assert comparison.psnr == pytest.approx(10 * np.log10(25 * 100))
    assert comparison.largest == 51
    assert comparison.differing == 0.01


def test_a_picture_is_near_its_golden_one(tmp_path: Path, field: surfcast.Model) -> None:
    golden = tmp_path / "field.png"
    picture = field.render(resolution=SIZE)
    with pytest.raises(AssertionError, match="no golden picture"):
        assert_image(picture, golden)
    assert_image(picture, golden, update=True)
    assert_image(picture, golden)
    assert_image(field.render(resolution=SIZE, format="webp", quality=100), golden, psnr=30)


def test_a_failure_leaves_three_pictures(tmp_path: Path, field: surfcast.Model) -> None:
    golden = tmp_path / "field.png"
    assert_image(field.render(resolution=SIZE), golden, update=True)
    with pytest.raises(AssertionError, match="expected at least 45 dB"):
        assert_image(field.render(resolution=SIZE, color_by="intensity"), golden)
    kept = {path.name for path in (tmp_path / "surfcast-failures").iterdir()}
    assert kept == {"field.actual.png", "field.expected.png", "field.difference.png"}
    with pytest.raises(AssertionError, match="80 x 64 pixels instead of 96 x 64"):
        assert_image(field.render(resolution=(80, 64)), golden, folder=tmp_path / "other")


def test_a_picture_that_is_not_converged_is_not_compared(tmp_path: Path, field: surfcast.Model) -> None:
    picture = replace(field.render(resolution=SIZE), converged=False)
    with pytest.raises(AssertionError, match="not converged"):
        assert_image(picture, tmp_path / "field.png", update=True)


def test_the_fixture_serves_one_server_for_the_same_models(pytester: pytest.Pytester, models: Path) -> None:
    pytester.makepyfile(
        f"""
        from surfcast.testing import assert_image

        def test_picture(surfcast_server):
            running = surfcast_server({str(models)!r})
            with running.connect() as client:
                assert_image(client["field"].render(resolution=(64, 48)), "field.png")

        def test_again(surfcast_server):
            assert surfcast_server({str(models)!r}) is surfcast_server({str(models)!r})
    """
    )
    missing = pytester.runpytest_subprocess("-p", "no:cacheprovider", "-k", "picture")
    missing.assert_outcomes(failed=1)
    pytester.runpytest_subprocess("--surfcast-update").assert_outcomes(passed=2)
    pytester.runpytest_subprocess().assert_outcomes(passed=2)
