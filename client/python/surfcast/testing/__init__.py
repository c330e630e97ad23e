"""Automated tests of pictures: a server for the test, and comparisons with golden pictures.

Installed beside pytest, the fixture `surfcast_server` and the option `--surfcast-update` are there without an import.
"""

from ._images import Comparison, assert_image, compare
from ._server import RunningServer, server

__all__ = ["Comparison", "RunningServer", "assert_image", "compare", "server"]
