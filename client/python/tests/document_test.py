"""The examples of docs/python.md and README.md, in a fresh virtual environment with the wheel."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from sample_models import SURFCASTD

from surfcast.testing import server

ROOT = Path(__file__).parents[3]
DOCUMENTS = (ROOT / "docs" / "python.md", ROOT / "README.md")


def examples() -> list[str]:
    text = "".join(document.read_text() for document in DOCUMENTS)
    return re.findall(r"^```python\n(.*?)^```", text, re.MULTILINE | re.DOTALL)


@pytest.fixture(scope="module")
def environment(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A virtual environment with the wheel; what the wheel needs is the system's."""
    folder = tmp_path_factory.mktemp("environment")
    subprocess.run([sys.executable, "-m", "venv", "--system-site-packages", folder], check=True, capture_output=True)
    install = [f"{folder}/bin/pip", "install", "--no-index", os.environ["WHEEL"]]
    subprocess.run(install, check=True, capture_output=True, env=without_path())
    return folder


def without_path() -> dict[str, str]:
    """The variables without the package that the other tests use."""
    return {name: value for name, value in os.environ.items() if name != "PYTHONPATH"}


def test_the_examples_run_as_they_are_written(tmp_path: Path, environment: Path, models: Path) -> None:
    shutil.copy(models / "field.surf", tmp_path / "church.surf")
    script = [example for example in examples() if not example.startswith("# test_")]
    (test,) = (example for example in examples() if example.startswith("# test_"))
    with server(tmp_path / "church.surf") as running:
        text = "\n".join(script).replace("127.0.0.1:7600", running.address)
        (tmp_path / "example.py").write_text(text)
        subprocess.run([f"{environment}/bin/python", "example.py"], check=True, cwd=tmp_path, env=without_path())
    assert (tmp_path / "church.png").exists() and (tmp_path / "frame_00003.png").exists()

    (tmp_path / "test_church.py").write_text(test)
    command = [f"{environment}/bin/python", "-m", "pytest", "-q", "-p", "no:cacheprovider", "test_church.py"]
    variables = {**without_path(), "SURFCASTD": SURFCASTD}
    for flag in ("--surfcast-update", "--exitfirst"):
        subprocess.run([*command, flag], check=True, cwd=tmp_path, env=variables)
    assert (tmp_path / "golden" / "church.png").exists()


def test_the_examples_have_types(tmp_path: Path, environment: Path) -> None:
    script = [example for example in examples() if not example.startswith("# test_")]
    (tmp_path / "example.py").write_text("\n".join(script))
    command = [sys.executable, "-m", "mypy", "--strict", "--enable-incomplete-feature=Unpack"]
    command += ["--python-executable", f"{environment}/bin/python", "--cache-dir", f"{tmp_path}/cache", "example.py"]
    checked = subprocess.run(command, cwd=tmp_path, env=without_path(), stdout=subprocess.PIPE, text=True, check=False)
    assert checked.returncode == 0, checked.stdout


def test_importing_costs_little_beside_numpy(environment: Path) -> None:
    """Modules, not times: what takes long to import is imported when it is needed."""
    late = ("PIL", "websockets", "pytest", "http", "pandas", "IPython", "surfcast.testing")
    script = f"import sys, surfcast; print([name for name in {late} if name in sys.modules])"
    said = subprocess.run(
        [f"{environment}/bin/python", "-c", script], check=True, capture_output=True, text=True, env=without_path()
    )
    assert said.stdout.strip() == "[]"
