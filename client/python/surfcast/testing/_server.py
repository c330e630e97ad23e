"""Starts `surfcastd` for tests."""

from __future__ import annotations

import os
import selectors
import shutil
import signal
import subprocess
import tempfile
import time
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from os import PathLike
from pathlib import Path
from typing import Any, Union
from urllib.parse import urlsplit

from .._sync import Server, connect
from ..errors import NotFound, Unavailable

PathText = Union[str, "PathLike[str]"]


class RunningServer:
    """A server that runs for a test. `log` is a file with what it says."""

    def __init__(self, process: subprocess.Popen[bytes], url: str, log: Path) -> None:
        self.process = process
        self.url = url
        self.log = log

    @property
    def address(self) -> str:
        """HOST:PORT, with tcps:// before it where the server has a certificate."""
        parts = urlsplit(self.url)
        return ("tcps://" if parts.scheme == "https" else "") + parts.netloc

    def connect(self, **settings: Any) -> Server:
        """A connection to it; the settings are those of `surfcast.connect`."""
        return connect(self.address, **settings)

    def stop(self, *, timeout: float = 30.0) -> None:
        """Ends the server: asks it to stop, and kills it after the timeout."""
        self.process.send_signal(signal.SIGTERM)
        try:
            self.process.wait(timeout)
        except subprocess.TimeoutExpired:
            self.kill()

    def kill(self) -> None:
        """Ends the server at once."""
        self.process.kill()
        self.process.wait()


def find_program(program: PathText | None = None) -> str:
    """The server's program: `program`, the variable SURFCASTD, or `surfcastd` in the PATH."""
    named = os.fspath(program or os.environ.get("SURFCASTD") or "surfcastd")
    found = shutil.which(named)
    if found is None:
        raise NotFound(f"there is no program '{named}'; SURFCASTD may name one")
    return found


def _read_url(process: subprocess.Popen[bytes], log: Path, timeout: float) -> str:
    """The line that the server prints when it is ready."""
    assert process.stdout is not None
    end = time.monotonic() + timeout
    with selectors.DefaultSelector() as selector:
        selector.register(process.stdout, selectors.EVENT_READ)
        if selector.select(max(0.0, end - time.monotonic())):
            if line := process.stdout.readline().decode().strip():
                return line.split()[-1]
    raise Unavailable(f"the server did not start: {log.read_text(errors='replace')[-2000:]}")


@contextmanager
def server(
    paths: PathText | Sequence[PathText],
    *,
    listen: str = "127.0.0.1:0",
    arguments: Sequence[str] = (),
    environment: Mapping[str, str] | None = None,
    program: PathText | None = None,
    timeout: float = 60.0,
) -> Iterator[RunningServer]:
    """Serves models, scans or folders while entered; by default on a free port of this machine.

    `arguments`: further flags of `surfcastd serve`. The server keeps models of scans in a folder of its own.
    """
    served = [paths] if isinstance(paths, (str, PathLike)) else list(paths)
    with tempfile.TemporaryDirectory(prefix="surfcast-") as folder:
        log = Path(folder) / "server.log"
        command = [find_program(program), "serve", *(os.fspath(path) for path in served), "--listen", listen]
        command += ["--cache", os.path.join(folder, "cache"), *arguments]
        with log.open("wb") as errors:
            process = subprocess.Popen(
                command, stdout=subprocess.PIPE, stderr=errors, env={**os.environ, **(environment or {})}
            )
        try:
            running = RunningServer(process, _read_url(process, log, timeout), log)
            yield running
            running.stop()
        finally:
            if process.poll() is None:
                process.kill()
                process.wait()
            if process.stdout is not None:
                process.stdout.close()
