"""The examples of tests of pictures: by pytest, and as a job of GitHub Actions."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest
import yaml


@pytest.fixture
def checkout(examples: Path, tmp_path: Path) -> Path:
    """A checkout whose examples may be changed."""
    root = tmp_path / "checkout"
    shutil.copytree(examples, root / "docs/examples")
    (root / "tests").symlink_to(examples.parents[1] / "tests")
    return root


def exchange(folder: Path) -> None:
    """Makes the first golden picture that of another view."""
    first, second = sorted(folder.glob("*.png"))
    shutil.copyfile(second, first)


def run_pytest(checkout: Path) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-m", "pytest", "-p", "no:cacheprovider", "docs/examples/picture_test"]
    return subprocess.run(command, cwd=checkout, capture_output=True, text=True)


def test_the_pictures_are_the_golden_ones(checkout: Path) -> None:
    result = run_pytest(checkout)
    assert result.returncode == 0 and "2 passed" in result.stdout, result.stdout


def test_another_golden_picture_fails_and_three_pictures_are_kept(checkout: Path) -> None:
    golden = checkout / "docs/examples/picture_test/golden"
    exchange(golden)
    result = run_pytest(checkout)
    assert result.returncode == 1 and "1 failed, 1 passed" in result.stdout, result.stdout
    assert len(list((golden / "surfcast-failures").iterdir())) == 3


@pytest.fixture
def steps(examples: Path) -> dict[str, Any]:
    """The steps of the job that have a name."""
    workflow = yaml.safe_load((examples / "ci/pictures.yml").read_text(encoding="utf-8"))
    assert workflow["on"] == ["pull_request"]
    return {step["name"]: step for step in workflow["jobs"]["compare"]["steps"] if "name" in step}


def run_job(steps: dict[str, Any], checkout: Path) -> tuple[int, str]:
    """Runs the commands of the job. What it returns, and the summary that it shows."""
    python = checkout / "python3"  # the first one in the PATH may be another than that of the packages
    python.symlink_to(sys.executable)
    summary = checkout / "summary.md"
    path = f"{checkout}:{os.environ['PATH']}"
    environment = {**os.environ, "PATH": path, "GITHUB_STEP_SUMMARY": str(summary)}
    codes = [
        subprocess.run(["bash", "-e", "-c", steps[name]["run"]], cwd=checkout, env=environment).returncode
        for name in ("Compare", "Report")
    ]
    assert codes[1] == 0
    return codes[0], summary.read_text(encoding="utf-8")


def test_the_job_passes_with_the_golden_pictures(steps: dict[str, Any], checkout: Path) -> None:
    code, summary = run_job(steps, checkout)
    assert code == 0
    assert "| Front | as before |" in summary and "| By height | as before |" in summary


def test_the_job_fails_with_another_golden_picture_and_keeps_what_differs(
    steps: dict[str, Any], checkout: Path
) -> None:
    exchange(checkout / "docs/examples/ci/golden")
    code, summary = run_job(steps, checkout)
    assert code == 1
    assert "| Front | as before |" in summary and "| By height | **differs** |" in summary
    upload = steps["Keep what differs"]
    kept = {file.name for file in (checkout / upload["with"]["path"]).iterdir()}
    differing = {f"by-height.{which}.png" for which in ("actual", "expected", "difference")}
    assert kept == {"report.md"} | differing
    assert upload["uses"].startswith("actions/upload-artifact@") and "failure()" in upload["if"]


def test_the_job_installs_packages_that_are_built(examples: Path, steps: dict[str, Any]) -> None:
    packaging = (examples.parents[1] / "docs/install.md").read_text(encoding="utf-8")
    for package in ("surfcast-server", "python3-surfcast"):
        assert f"/tmp/packages/{package}_*.deb" in steps["Install"]["run"]
        assert f"`{package}`" in packaging
