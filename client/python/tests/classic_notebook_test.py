"""The widget in the classic notebook, in a browser that has no way to the server but through the kernel."""

from __future__ import annotations

import asyncio
import json
import socket
import subprocess
import sys
from collections.abc import Iterator
from importlib import import_module
from pathlib import Path
from typing import Any
from urllib.error import URLError
from urllib.request import urlopen

import pytest
from browser import Page, open_page

import surfcast
from surfcast.testing import RunningServer

CANVAS = "document.querySelector('.output canvas')"
PIXELS = f"{CANVAS}.toDataURL()"
# The pixels once there are any. Before the first frame nothing can be turned.
DRAWN = f"""(() => {{
  const empty = document.createElement('canvas');
  [empty.width, empty.height] = [{CANVAS}.width, {CANVAS}.height];
  return {PIXELS} !== empty.toDataURL() && {PIXELS};
}})()"""
# The middle of the picture in the window, once it has stayed where it is and nothing covers it. A notebook scrolls and
# lays itself out again after cells have run.
MIDDLE = f"""(() => {{
  {CANVAS}.scrollIntoView({{block: 'center'}});
  const box = {CANVAS}.getBoundingClientRect();
  const middle = [box.left + 160, box.top + 100];
  const stays = String(window.lastMiddle) === String(middle);
  window.lastMiddle = middle;
  return stays && document.elementFromPoint(...middle) === {CANVAS} && middle;
}})()"""


def free_port() -> int:
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return int(probe.getsockname()[1])


def write_book(path: Path, running: RunningServer) -> None:
    cells = [
        "import surfcast\n"
        f"view = surfcast.connect({running.address!r})['field'].widget(resolution=(320, 200))\n"
        "view",
        "print('camera', list(view.camera.position), 'hit', view.hit is not None)",
    ]
    books: Any = import_module("nbformat.v4")
    book = books.new_notebook(cells=[books.new_code_cell(cell) for cell in cells])
    path.write_text(json.dumps(book))


@pytest.fixture
def notebook_url(tmp_path: Path, running: RunningServer) -> Iterator[str]:
    """A notebook server with a notebook."""
    write_book(tmp_path / "view.ipynb", running)
    port = free_port()
    command = [sys.executable, "-m", "notebook", "--no-browser", "--allow-root", f"--port={port}", "--ip=127.0.0.1"]
    command += ["--NotebookApp.token=", "--NotebookApp.password=", f"--notebook-dir={tmp_path}"]
    with (tmp_path / "notebook.log").open("wb") as log:
        process = subprocess.Popen(command, stdout=log, stderr=log)
    try:
        yield f"http://127.0.0.1:{port}/notebooks/view.ipynb"
    finally:
        process.terminate()
        process.wait()


def fetch(url: str) -> None:
    with urlopen(url) as answer:
        answer.read()


async def answers(url: str) -> None:
    """Waits until a server is there."""
    async with asyncio.timeout(60):
        while True:
            try:
                await asyncio.to_thread(fetch, url)
                return
            except URLError:
                await asyncio.sleep(0.1)


async def run_cell(page: Page, number: int) -> None:
    await page.evaluate(f"Jupyter.notebook.execute_cells([{number}])")


async def said_by_cell(page: Page, number: int) -> str:
    """What a cell prints."""
    output = f"Jupyter.notebook.get_cell({number}).element.find('.output_stdout')"
    await page.evaluate(f"void Jupyter.notebook.get_cell({number}).clear_output()")
    await run_cell(page, number)
    return str(await page.wait_for(f"{output}.text()"))


async def test_dragging_turns_the_view(
    tmp_path: Path, notebook_url: str, running: RunningServer, field: surfcast.Model
) -> None:
    await answers(notebook_url)
    async with open_page(notebook_url, tmp_path / "profile") as page:
        await page.wait_for("window.Jupyter?.notebook?.kernel?.is_connected() && !Jupyter.notebook.kernel_busy")
        await run_cell(page, 0)
        await page.wait_for(f"{CANVAS}?.width === 320")
        drawn = await page.wait_for(DRAWN)
        x, y = await page.wait_for(MIDDLE)
        await page.mouse("mousePressed", x, y)
        for step in range(1, 6):
            await page.mouse("mouseMoved", x + 8 * step, y)
        await page.mouse("mouseReleased", x + 40, y, buttons=0)
        turned = await page.wait_for(f"{PIXELS} !== {json.dumps(drawn)} && {PIXELS}")
        assert turned != drawn
        x, y = await page.wait_for(MIDDLE)
        await page.mouse("mousePressed", x, y)
        await page.mouse("mouseReleased", x, y, buttons=0)
        await page.wait_for(f"{CANVAS}.nextSibling.textContent.includes('intensity')")
        whole = field.render(resolution=(320, 200)).camera
        said = await said_by_cell(page, 1)
        async with asyncio.timeout(60):  # gestures go one after the other, beside picks
            while str(list(whole.position)) in said:
                said = await said_by_cell(page, 1)
        assert "hit True" in said
        origins = await page.evaluate("performance.getEntries().map((e) => e.name).filter((n) => n.includes('//'))")
        port = f":{running.address.rpartition(':')[2]}"
        assert origins and not [name for name in origins if port in name]
