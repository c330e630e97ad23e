#!/usr/bin/env python3
"""Draws the saved views of a model and compares them with golden pictures.

VIEWS is a file that the viewer exports: it names the model, and has the camera, colours and clip boxes of each view.
REPORT gets report.md and, of each picture that differs, the actual, the expected and the difference picture. The exit
code is 1 if one does.
"""

from __future__ import annotations

import argparse
import io
import json
import re
import sys
import urllib.parse
import urllib.request
from pathlib import Path

import numpy as np
from PIL import Image

from surfcast.testing import assert_image, compare, server


def draw(url: str, model: str, parameters: dict[str, str], resolution: str) -> np.ndarray:
    """The picture of a view. The parameters of links are those of HTTP."""
    query = urllib.parse.urlencode({**parameters, "resolution": resolution, "format": "png"})
    address = f"{url.rstrip('/')}/api/models/{urllib.parse.quote(model)}/image?{query}"
    with urllib.request.urlopen(address) as answer:
        return np.asarray(Image.open(io.BytesIO(answer.read())).convert("RGB"))


def file_name(view: str) -> str:
    return re.sub(r"[^a-z0-9]+", "-", view.lower()).strip("-") + ".png"


def check(picture: np.ndarray, golden: Path, arguments: argparse.Namespace) -> tuple[bool, str]:
    """Whether a picture is near its golden one, and what is said of it."""
    try:
        assert_image(picture, golden, psnr=arguments.psnr, update=arguments.update, folder=arguments.report)
    except AssertionError as difference:
        return False, str(difference)
    return True, "made" if arguments.update else str(compare(picture, golden))


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scan", type=Path, help="a model, or a scan")
    parser.add_argument("views", type=Path)
    parser.add_argument("golden", type=Path, help="folder of golden pictures")
    parser.add_argument("--report", type=Path, default=Path("pictures"))
    parser.add_argument("--resolution", default="240,160")
    parser.add_argument("--psnr", type=float, default=40, help="decibels that a picture must reach (default 40)")
    parser.add_argument("--update", action="store_true", help="make the pictures the golden ones")
    arguments = parser.parse_args()

    document = json.loads(arguments.views.read_text(encoding="utf-8"))
    rows = []
    with server(arguments.scan) as running:
        with running.connect() as connection:
            connection[document["model"]].wait_complete()
        for view in document["views"]:
            picture = draw(running.url, document["model"], view["parameters"], arguments.resolution)
            rows.append((view["name"], *check(picture, arguments.golden / file_name(view["name"]), arguments)))

    lines = ["| view | | |", "|---|---|---|"]
    lines += [f"| {name} | {'as before' if good else '**differs**'} | {said} |" for name, good, said in rows]
    arguments.report.mkdir(parents=True, exist_ok=True)
    (arguments.report / "report.md").write_text("\n".join(lines) + "\n", encoding="utf-8")
    print("\n".join(lines))
    return 0 if all(good for _, good, _ in rows) else 1


if __name__ == "__main__":
    sys.exit(main())
