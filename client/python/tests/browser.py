"""A browser without a window, driven by Chrome's DevTools protocol."""

from __future__ import annotations

import asyncio
import itertools
import json
import os
import re
import shutil
import signal
import subprocess
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from importlib import import_module
from pathlib import Path
from typing import Any


class Page:
    """A page of the browser. Coordinates are pixels of its window."""

    def __init__(self, socket: Any) -> None:
        self._socket = socket
        self._ids = itertools.count(1)

    async def call(self, method: str, **parameters: Any) -> Any:
        """The result of a command."""
        number = next(self._ids)
        await self._socket.send(json.dumps({"id": number, "method": method, "params": parameters}))
        while True:
            message = json.loads(await self._socket.recv())
            if message.get("id") == number:
                assert "result" in message, message
                return message["result"]

    async def evaluate(self, expression: str) -> Any:
        """The value of an expression; of a promise what it resolves to."""
        result = await self.call("Runtime.evaluate", expression=expression, returnByValue=True, awaitPromise=True)
        assert "exceptionDetails" not in result, result
        return result["result"].get("value")

    async def wait_for(self, expression: str, timeout: float = 60.0) -> Any:
        """The value of an expression once it is true."""
        async with asyncio.timeout(timeout):
            while not (value := await self.evaluate(expression)):
                await asyncio.sleep(0.1)
            return value

    async def mouse(self, kind: str, x: float, y: float, buttons: int = 1) -> None:
        await self.call("Input.dispatchMouseEvent", type=kind, x=x, y=y, button="left", buttons=buttons, clickCount=1)


async def _address(process: subprocess.Popen[str]) -> str:
    """Where the browser listens, as it says when it starts."""
    assert process.stderr is not None
    while line := await asyncio.to_thread(process.stderr.readline):
        if found := re.search(r"listening on (ws://\S+)", line):
            return found.group(1)
    raise AssertionError("the browser did not start")


@asynccontextmanager
async def open_page(url: str, folder: Path) -> AsyncIterator[Page]:
    """A page in a browser of its own, whose profile is in `folder`."""
    program = shutil.which("chromium-headless-shell") or shutil.which("chromium")
    assert program is not None
    flags = ["--headless", "--no-sandbox", "--disable-gpu", "--remote-debugging-port=0", "--window-size=1280,1000"]
    # In a group of its own: Debian's program is a script that starts the browser, which would outlive it.
    command = [program, *flags, f"--user-data-dir={folder}"]
    process = subprocess.Popen(command, stderr=subprocess.PIPE, text=True, start_new_session=True)
    connect = import_module("websockets").connect
    try:
        async with connect(await _address(process), max_size=None) as socket:
            target = (await Page(socket).call("Target.createTarget", url=url))["targetId"]
            host = str(socket.remote_address[1])
            async with connect(f"ws://127.0.0.1:{host}/devtools/page/{target}", max_size=None) as page:
                yield Page(page)
    finally:
        os.killpg(process.pid, signal.SIGKILL)
        process.wait()
        if process.stderr is not None:
            process.stderr.close()
