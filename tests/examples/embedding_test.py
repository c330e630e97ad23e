"""The example of a page that shows a view of the viewer, in a browser."""

from __future__ import annotations

import asyncio
import base64
import io
import os
import shutil
from pathlib import Path

import numpy as np
import numpy.typing as npt
import pytest
from browser import Page, open_page
from PIL import Image

import surfcast
from surfcast.testing import compare, server

VIEW = "document.querySelector('iframe').contentDocument"
BACKGROUND = (14, 18, 22)  # of the viewer's pictures
FOCAL_POINT = (-2.85, 3.4, -1.25)


async def picture_at_rest(page: Page) -> npt.NDArray[np.uint8]:
    """The picture in the frame of the page."""
    await page.wait_for(f"{VIEW}?.querySelector('.status .lamp.sharp') != null")
    data = await page.evaluate(f"{VIEW}.querySelector('canvas.picture').toDataURL('image/png')")
    return np.asarray(Image.open(io.BytesIO(base64.b64decode(data.partition(",")[2]))).convert("RGB"))


async def wait_for_picture(page: Page, model: surfcast.Model, camera: surfcast.Camera) -> None:
    """Waits until the frame shows what the camera sees. The viewer rounds cameras, so it is nearly the same picture."""
    psnr = 0.0
    async with asyncio.timeout(120):
        while psnr < 40:
            shown = await picture_at_rest(page)
            size = (shown.shape[1], shown.shape[0])
            expected = await asyncio.to_thread(model.render, camera, resolution=size, background=BACKGROUND)
            psnr = compare(shown, expected).psnr


async def test_a_page_beside_the_viewer_shows_views_of_it(examples: Path, lion: Path, tmp_path: Path) -> None:
    viewer = Path(os.environ["VIEWER"])
    if not (viewer / "index.html").exists():
        pytest.skip("the viewer is not built, as npm could not install what it needs")
    pages = tmp_path / "pages"
    shutil.copytree(viewer, pages)
    shutil.copy(examples / "embedding/tour.html", pages)
    front = surfcast.Camera((1.5, -3, 2.5), FOCAL_POINT, view_angle=30)
    side = surfcast.Camera((-8, -3, 3), FOCAL_POINT, view_angle=30)
    with server(lion, arguments=["--viewer", str(pages)]) as running, running.connect() as client:
        async with open_page(running.url.rstrip("/") + "/tour.html", tmp_path / "profile") as page:
            # It is a blank page at first.
            await page.wait_for("document.readyState === 'complete' && document.querySelector('iframe') !== null")
            await wait_for_picture(page, client["lion"], front)
            await page.evaluate("document.querySelectorAll('a[target=view]')[1].click()")
            await wait_for_picture(page, client["lion"], side)
            await page.evaluate("document.querySelectorAll('a[target=view]')[0].click()")
            await wait_for_picture(page, client["lion"], front)
