"""Values of the interface that are no pictures: cameras, boxes, descriptions, hits."""

from __future__ import annotations

import io
import json
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from os import PathLike
from pathlib import Path
from typing import Any, Union

import numpy as np
import numpy.typing as npt

from ._wire import surfcast_pb2 as wire
from .errors import InvalidInput

Vector = Union[Sequence[float], npt.NDArray[Any]]
Floats = npt.NDArray[np.float64]

PRESETS = ("gray", "ct-bone", "ct-soft", "mr", "auto")  # in the order of the messages


def vector_of(value: Vector, what: str) -> tuple[float, float, float]:
    """Three finite floats. Raises InvalidInput otherwise."""
    try:
        x, y, z = (float(part) for part in value)
    except (TypeError, ValueError):
        raise InvalidInput(f"{what}: expected three numbers, got {value!r}") from None
    if not np.isfinite((x, y, z)).all():
        raise InvalidInput(f"{what}: numbers must be finite, not {value!r}")
    return x, y, z


def to_wire(vector: Vector) -> wire.Vector3:
    return wire.Vector3(x=vector[0], y=vector[1], z=vector[2])


def from_wire(vector: wire.Vector3) -> Floats:
    return np.array((vector.x, vector.y, vector.z))


@dataclass(frozen=True)
class Camera:
    """A view in world coordinates of the scan. `view_angle` is vertical, in degrees."""

    position: Vector
    focal_point: Vector
    view_up: Vector | None = None  # None: the model's vertical axis
    view_angle: float | None = None  # None: 30

    def __post_init__(self) -> None:
        for name in ("position", "focal_point", "view_up"):
            value = getattr(self, name)
            if value is not None:
                object.__setattr__(self, name, vector_of(value, f"camera: {name}"))

    @classmethod
    def from_dict(cls, values: Mapping[str, Any]) -> Camera:
        """A camera from the fields of a camera file (`--camera FILE.json`)."""
        unknown = set(values) - {"position", "focal_point", "view_up", "view_angle"}
        if unknown or not {"position", "focal_point"} <= set(values):
            raise InvalidInput("a camera has position, focal_point and perhaps view_up and view_angle, nothing else")
        return cls(**values)

    @classmethod
    def read(cls, path: str | PathLike[str]) -> Camera:
        """Reads a camera file."""
        return cls.from_dict(json.loads(Path(path).read_text()))

    def to_dict(self) -> dict[str, Any]:
        """The fields of a camera file."""
        values: dict[str, Any] = {"position": list(self.position), "focal_point": list(self.focal_point)}
        if self.view_up is not None:
            values["view_up"] = list(self.view_up)
        if self.view_angle is not None:
            values["view_angle"] = self.view_angle
        return values

    def to_wire(self) -> wire.Camera:
        camera = wire.Camera(position=to_wire(self.position), focal_point=to_wire(self.focal_point))
        if self.view_up is not None:
            camera.view_up.CopyFrom(to_wire(self.view_up))
        if self.view_angle is not None:
            camera.view_angle = self.view_angle
        return camera

    @classmethod
    def from_wire(cls, camera: wire.Camera) -> Camera:
        def tuple_of(v: wire.Vector3) -> tuple[float, float, float]:
            return v.x, v.y, v.z

        return cls(
            tuple_of(camera.position),
            tuple_of(camera.focal_point),
            tuple_of(camera.view_up) if camera.HasField("view_up") else None,
            camera.view_angle if camera.HasField("view_angle") else None,
        )


@dataclass(frozen=True)
class Box:
    """An axis-aligned box in world coordinates. Its faces belong to it."""

    low: Vector
    high: Vector

    def __post_init__(self) -> None:
        low, high = vector_of(self.low, "box"), vector_of(self.high, "box")
        if any(a > b for a, b in zip(low, high)):
            raise InvalidInput("box: the lower corner comes first")
        object.__setattr__(self, "low", low)
        object.__setattr__(self, "high", high)


@dataclass(frozen=True)
class Corridor:
    """What lies near a line, seen from above: round at its corners, cut off straight at its two ends.

    `line`: x and y of two corners or more; z and x where y is the vertical axis. Without `low` and `high` it has no
    limits in height.
    """

    line: Sequence[Vector]
    width: float
    low: float | None = None
    high: float | None = None

    def __post_init__(self) -> None:
        try:
            corners = tuple((float(x), float(y)) for x, y in self.line)
        except (TypeError, ValueError):
            raise InvalidInput(f"corridor: expected corners of two numbers, got {self.line!r}") from None
        object.__setattr__(self, "line", corners)


@dataclass(frozen=True)
class Range:
    """The values of an attribute. For intensities 2 % of the surfels are below `low`, and 2 % above `high`."""

    smallest: float
    largest: float
    low: float
    high: float


@dataclass(frozen=True)
class TransferPoint:
    """A point of a transfer function: sRGB from 0 to 255, and the opacity of one spacing of the grid."""

    value: float
    color: tuple[int, int, int]
    opacity: float


@dataclass(frozen=True)
class Volume:
    """A regular grid of samples. `histogram` counts samples in bins of equal width from `low` to `high`."""

    name: str
    size: tuple[int, ...]
    spacing: tuple[float, ...]
    low: float
    high: float
    histogram: npt.NDArray[np.uint64]
    length_unit: str
    sample_unit: str
    presets: Mapping[str, tuple[TransferPoint, ...]]  # as they are for this volume


@dataclass(frozen=True)
class Ellipsoids:
    """A tensor field or a table of ellipsoids."""

    name: str
    tensors: bool
    size: tuple[int, ...]
    samples: int
    drawn: int
    scale: float
    mean_fa: float
    mean_mode: float
    mean_values: tuple[float, ...]
    length_unit: str
    sample_unit: str
    ranges: Mapping[str, Range]


@dataclass(frozen=True)
class CoordinateSystem:
    """A coordinate reference system. Coordinates are easting or longitude first, whatever order it states."""

    name: str
    id: str  # "EPSG:25832"; empty if no authority has it
    wkt: str


@dataclass(frozen=True)
class ModelInfo:
    """What a model holds. `bounds` has the lower and the upper corner, in world coordinates.

    `elevation` has the lowest and the highest elevation without outliers.
    `crs` is the system of world coordinates, `source_crs` that of the scan where it is another one.
    """

    name: str
    surfels: int
    bounds: Floats
    elevation: tuple[float, float]
    attributes: tuple[str, ...]
    ranges: Mapping[str, Range]
    classes: Mapping[int, int]
    color_bits: int
    oriented: bool
    z_up: bool
    upside_down: bool
    sources: tuple[str, ...]
    levels: int
    blocks: int
    spacing: float
    kinds: Mapping[str, int]
    volumes: tuple[Volume, ...]
    ellipsoids: tuple[Ellipsoids, ...]
    crs: CoordinateSystem | None
    source_crs: CoordinateSystem | None
    members: Mapping[str, Mapping[str, int]]  # of several that are shown together: the items of each kind, by name


@dataclass(frozen=True)
class Scan:
    """A scan whose model is not complete. `state` is waiting, building or failed; `done` is a share from 0 to 1."""

    model: str
    state: str
    done: float
    seconds_left: float | None
    problem: str
    preview: bool


@dataclass(frozen=True)
class Uploads:
    """Which files a server takes: their largest size, and the extensions of their names."""

    max_bytes: int
    extensions: tuple[str, ...]


@dataclass(frozen=True)
class SavedView:
    """A named view. `parameters` are those of a link: camera, display options and clip boxes."""

    name: str
    parameters: Mapping[str, str]


@dataclass(frozen=True)
class Annotation:
    """A text at a point, in world coordinates, and the parameters of a view of it."""

    text: str
    position: Floats
    parameters: Mapping[str, str]


@dataclass(frozen=True)
class Annotations:
    """What a server keeps beside a model. `edition` names the state that was read; empty: any."""

    views: tuple[SavedView, ...] = ()
    annotations: tuple[Annotation, ...] = ()
    edition: str = ""
    writable: bool = False


@dataclass(frozen=True)
class Hit:
    """The surfel, sample or ellipsoid that a picture shows at a pixel.

    `source_position` is in the system of the scan (`ModelInfo.source_crs`), where that is not the one of the picture.
    """

    position: Floats
    normal: Floats | None
    color: tuple[int, int, int] | None
    radius: float
    distance: float
    depth: float
    surfel: int
    attributes: Mapping[str, float]
    source_position: Floats | None = None
    model: str | None = None  # of several that are shown together: the one that the item is of


@dataclass(frozen=True)
class Points(Mapping[str, npt.NDArray[Any]]):
    """Points of a scan as columns: "xyz", "rgb" where the scan has colours, and the attributes.

    Points of a profile have "along" and "across", too. `total` counts the points of the region, of which these are an
    even sample if there were more than allowed. Coordinates of a profile are whole numbers times `scale` plus `offset`,
    which are NaN otherwise.
    """

    columns: Mapping[str, npt.NDArray[Any]]
    total: int
    scale: Floats
    offset: Floats
    length: float = field(default=0.0)  # of the course of a profile, world units

    def __getitem__(self, name: str) -> npt.NDArray[Any]:
        return self.columns[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self.columns)

    def __len__(self) -> int:
        return len(self.columns)

    @property
    def count(self) -> int:
        """The number of points."""
        return len(self.columns["xyz"])


def _ranges_from(ranges: Any) -> dict[str, Range]:
    return {r.attribute: Range(r.smallest, r.largest, r.low, r.high) for r in ranges}


def _point_from(point: wire.TransferPoint) -> TransferPoint:
    return TransferPoint(point.value, (point.color.red, point.color.green, point.color.blue), point.opacity)


def _volume_from(volume: wire.VolumeDescription) -> Volume:
    return Volume(
        volume.name,
        tuple(volume.size),
        tuple(volume.spacing),
        volume.low,
        volume.high,
        np.array(volume.histogram, dtype=np.uint64),
        volume.length_unit,
        volume.sample_unit,
        {PRESETS[p.preset]: tuple(map(_point_from, p.points)) for p in volume.presets},
    )


def _ellipsoids_from(of: wire.EllipsoidDescription) -> Ellipsoids:
    return Ellipsoids(
        of.name,
        of.tensors,
        tuple(of.size),
        of.samples,
        of.drawn,
        of.scale,
        of.mean_fa,
        of.mean_mode,
        tuple(of.mean_values),
        of.length_unit,
        of.sample_unit,
        _ranges_from(of.ranges),
    )


def _system_from(system: wire.CoordinateSystem) -> CoordinateSystem:
    return CoordinateSystem(system.name, system.id, system.wkt)


def model_info(model: wire.ModelDescription) -> ModelInfo:
    return ModelInfo(
        name=model.model,
        surfels=model.surfels,
        bounds=np.array((from_wire(model.bounds.min), from_wire(model.bounds.max))),
        elevation=(model.elevation.low, model.elevation.high),
        attributes=tuple(model.attributes),
        ranges=_ranges_from(model.ranges),
        classes={c.code: c.surfels for c in model.classes},
        color_bits=model.color_bits,
        oriented=model.oriented,
        z_up=model.z_up,
        upside_down=model.upside_down,
        sources=tuple(model.sources),
        levels=model.levels,
        blocks=model.blocks,
        spacing=model.spacing,
        kinds={k.kind: k.items for k in model.kinds},
        volumes=tuple(_volume_from(v) for v in model.volumes),
        ellipsoids=tuple(_ellipsoids_from(e) for e in model.ellipsoids),
        crs=_system_from(model.system) if model.HasField("system") else None,
        source_crs=_system_from(model.source_system) if model.HasField("source_system") else None,
        members={m.model: {k.kind: k.items for k in m.kinds} for m in model.members},
    )


def scan_from(scan: wire.ScanStatus) -> Scan:
    states = {wire.SCAN_STATE_WAITING: "waiting", wire.SCAN_STATE_BUILDING: "building"}
    left = scan.seconds_left if scan.seconds_left > 0 else None
    return Scan(scan.model, states.get(scan.state, "failed"), scan.done, left, scan.problem, scan.edition > 0)


def hit_from(result: wire.PickResult) -> Hit | None:
    if not result.hit:
        return None
    color = (result.color.red, result.color.green, result.color.blue) if result.HasField("color") else None
    return Hit(
        from_wire(result.position),
        from_wire(result.normal) if result.HasField("normal") else None,
        color,
        result.radius,
        result.distance,
        result.depth,
        result.surfel,
        {a.attribute: a.value for a in result.attributes},
        from_wire(result.source_position) if result.HasField("source_position") else None,
        result.model or None,
    )


def points_of_file(file: bytes, attributes: Iterable[str] | None) -> Points:
    """The points of a file of NumPy. `attributes`: only these; None: all."""
    rows = np.load(io.BytesIO(file), allow_pickle=False)
    names = list(rows.dtype.names)
    columns: dict[str, npt.NDArray[Any]] = {}
    for name, parts in (("xyz", ("x", "y", "z")), ("normals", ("nx", "ny", "nz")), ("rgb", ("red", "green", "blue"))):
        if parts[0] in names:
            columns[name] = np.column_stack([rows[part] for part in parts])
            names = [other for other in names if other not in parts]
    for name in names if attributes is None else attributes:
        if name not in names:
            raise InvalidInput(f"attributes: there is no {name!r}")
        columns[name] = np.ascontiguousarray(rows[name])
    unknown = np.full(3, np.nan)
    return Points(columns, len(rows), unknown, unknown)


def points_from(profile: wire.Profile) -> Points:
    columns: dict[str, npt.NDArray[Any]] = {
        "xyz": np.column_stack([np.array(axis, dtype=np.float64) for axis in (profile.x, profile.y, profile.z)]),
        "along": np.array(profile.along, dtype=np.float64),
        "across": np.array(profile.across, dtype=np.float64),
    }
    if profile.color_bits:
        depth = np.uint8 if profile.color_bits == 8 else np.uint16
        parts = (profile.red, profile.green, profile.blue)
        columns["rgb"] = np.column_stack([np.array(part, dtype=depth) for part in parts])
    for column in profile.attributes:
        columns[column.attribute] = np.array(column.values, dtype=np.float64)
    return Points(columns, profile.total, from_wire(profile.scale), from_wire(profile.offset), profile.length)
