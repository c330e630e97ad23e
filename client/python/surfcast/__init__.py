"""A client of Surfcast, which draws large point scans on a server.

    with surfcast.connect("127.0.0.1:7600") as server:
        server["church"].render(resolution=(1280, 720)).save("church.png")

`surfcast.aio` is the same for asyncio, `surfcast.measure` measures, `surfcast.testing` compares pictures.
"""

from . import aio, measure
from ._build import VERSION as __version__
from ._depth import Depth
from ._options import DisplayOptions, PictureOptions, RegionOptions, ViewOptions
from ._picture import LevelCount, Picture
from ._sync import Model, Server, View, connect
from ._values import (
    Annotation,
    Annotations,
    Box,
    Camera,
    CoordinateSystem,
    Corridor,
    Ellipsoids,
    Hit,
    ModelInfo,
    Points,
    Range,
    SavedView,
    Scan,
    TransferPoint,
    Uploads,
    Volume,
)
from ._view import Frame
from ._warp import warp
from .camera_path import CameraPath, Keyframe
from .errors import (
    Cancelled,
    ConnectionLost,
    Denied,
    Error,
    InvalidInput,
    Limit,
    NotFound,
    ServerFault,
    Timeout,
    Unavailable,
    Unsupported,
    VersionMismatch,
)

__all__ = [
    "Annotation",
    "Annotations",
    "Box",
    "Camera",
    "CameraPath",
    "Cancelled",
    "ConnectionLost",
    "CoordinateSystem",
    "Corridor",
    "Denied",
    "Depth",
    "DisplayOptions",
    "Ellipsoids",
    "Error",
    "Frame",
    "Hit",
    "InvalidInput",
    "Keyframe",
    "LevelCount",
    "Limit",
    "Model",
    "ModelInfo",
    "NotFound",
    "Picture",
    "PictureOptions",
    "Points",
    "Range",
    "RegionOptions",
    "SavedView",
    "Scan",
    "Server",
    "ServerFault",
    "Timeout",
    "TransferPoint",
    "Unavailable",
    "Unsupported",
    "Uploads",
    "VersionMismatch",
    "View",
    "ViewOptions",
    "Volume",
    "__version__",
    "aio",
    "connect",
    "measure",
    "warp",
]
