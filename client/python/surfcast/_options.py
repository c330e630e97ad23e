"""The options of pictures, by the names of the command line with `_` for `-`."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import reduce
from os import PathLike
from pathlib import Path
from typing import Any, Literal, TypedDict, Union

import numpy as np

from ._picture import FORMATS
from ._plain_options import PLAIN_FIELDS, PlainField, PlainOptions
from ._values import PRESETS, Box, Camera, Corridor, Vector, to_wire, vector_of
from ._wire import surfcast_pb2 as wire
from .errors import InvalidInput

Transfer = Union[str, Sequence[Any], Mapping[str, Any], "PathLike[str]"]


class DisplayOptions(PlainOptions, total=False):
    """What a picture shows, and how. Every option may be left out; then the server's default holds."""

    color_by: str  # rgb, intensity, elevation, classification, normal, direction, dec, fa, mode, md, attribute:NAME
    color_range: tuple[float, float]
    hide_classes: Iterable[int]
    hide_models: str | Iterable[str]  # of several that are shown together
    clip_box: Box | Iterable[Box | Sequence[Vector]]  # shown is what is in one of them
    clip_out: Box | Iterable[Box | Sequence[Vector]]  # and in none of these
    eye_dome: float | tuple[float, float]  # strength, or strength and radius in pixels
    transfer: Transfer  # preset, (preset, first, last), [(value, r, g, b, opacity), ...], or a transfer file's content
    iso: float | Iterable[float | Sequence[float]]  # value, or (value, r, g, b[, opacity])
    slice: Iterable[Sequence[Any]]  # (x, y, z, nx, ny, nz), or ("i" | "j" | "k", index)
    opacity_by_class: Mapping[int, float]
    glyph: str | tuple[str, float]  # ellipsoid, superquadric, or ("superquadric", sharpness)
    threshold: Iterable[Sequence[Any]]  # (attribute, smallest[, largest])
    lights: Mapping[str, Any] | PathLike[str]  # a lights file, or its content


class ViewOptions(DisplayOptions, total=False):
    """Options of views: those of what is shown, and of the pictures at rest."""

    resolution: tuple[int, int]
    format: Literal["png", "jpg", "webp", "exr"]
    quality: int  # of JPEG and WebP, 1 to 100


class PictureOptions(ViewOptions, total=False):
    """Options of pictures: those of views, and channels."""

    channels: Iterable[str]  # of EXR: depth, normal, position, coverage, classification, surfel


_SOURCES = ("rgb", "intensity", "elevation", "classification", "normal", "direction", "dec")
_MOST_INTEGER = 2**32 - 1


def _wanted(name: str, form: str, value: object) -> InvalidInput:
    return InvalidInput(f"{name}: expected {form}, got {value!r}")


def _choice(name: str, names: Sequence[str], value: object) -> Any:
    """The number of a name among those of an enumeration of the messages."""
    if not isinstance(value, str) or value not in names:
        raise _wanted(name, " or ".join(names), value)
    return names.index(value)


def _number(name: str, value: object) -> float:
    if isinstance(value, (bool, str, bytes)):
        raise _wanted(name, "a number", value)
    try:
        return float(value)  # type: ignore[arg-type]
    except (TypeError, ValueError):
        raise _wanted(name, "a number", value) from None


def natural(name: str, value: object) -> int:
    number = _number(name, value)
    if number != int(number) or not 0 <= number <= _MOST_INTEGER:
        raise _wanted(name, "a whole number from 0", value)
    return int(number)


def _numbers(name: str, value: Any, count: int) -> list[float]:
    try:
        parts = list(value)
    except TypeError:
        parts = []
    if len(parts) != count or isinstance(value, str):
        raise _wanted(name, f"{count} numbers", value)
    return [_number(name, part) for part in parts]


def _color(name: str, value: Any) -> wire.Color:
    red, green, blue = (natural(name, part) for part in _numbers(name, value, 3))
    return wire.Color(red=red, green=green, blue=blue)


def _flag(name: str, value: object) -> bool:
    if value in ("on", "off"):
        return value == "on"
    if not isinstance(value, bool):
        raise _wanted(name, "True or False", value)
    return value


def _resolution(picture: wire.DrawPicture, value: Any) -> None:
    width, height = (natural("resolution", part) for part in _numbers("resolution", value, 2))
    picture.resolution.CopyFrom(wire.Resolution(width=width, height=height))


def _format(picture: wire.DrawPicture, value: Any) -> None:
    name = "jpg" if value == "jpeg" else value
    if name not in FORMATS:
        raise _wanted("format", " or ".join(FORMATS), value)
    picture.format = FORMATS[name]


def _quality(picture: wire.DrawPicture, value: Any) -> None:
    picture.quality = natural("quality", value)
    if not 1 <= picture.quality <= 100:
        raise _wanted("quality", "1 to 100", value)


def _channels(picture: wire.DrawPicture, value: Any) -> None:
    names = ("depth", "normal", "position", "coverage", "classification", "surfel")
    chosen = [value] if isinstance(value, str) else list(value)
    picture.channels.extend(_choice("channels", names, name) for name in chosen)


def _color_by(picture: wire.DrawPicture, value: Any) -> None:
    named = isinstance(value, str) and value.startswith("attribute:")
    if named or value in ("fa", "mode", "md"):
        picture.coloring.source = wire.COLOR_SOURCE_ATTRIBUTE
        picture.coloring.attribute = value.removeprefix("attribute:")
    else:
        picture.coloring.source = _choice("color_by", _SOURCES, value)


def _color_range(picture: wire.DrawPicture, value: Any) -> None:
    picture.coloring.first, picture.coloring.last = _numbers("color_range", value, 2)


def _hide_classes(picture: wire.DrawPicture, value: Any) -> None:
    codes = [value] if isinstance(value, int) else value
    picture.hidden_classes.extend(natural("hide_classes", code) for code in codes)


def _hide_models(picture: wire.DrawPicture, value: Any) -> None:
    names = [value] if isinstance(value, str) else list(value)
    if not all(isinstance(name, str) and name for name in names):
        raise _wanted("hide_models", "names of models", value)
    picture.hidden_models.extend(names)


def _clip(inverted: bool) -> Callable[[wire.DrawPicture, Any], None]:
    def set_boxes(picture: wire.DrawPicture, value: Any) -> None:
        for box in [value] if isinstance(value, Box) else value:
            corners = box if isinstance(box, Box) else Box(*box)
            shape = wire.Box(min=to_wire(corners.low), max=to_wire(corners.high))
            picture.clip_boxes.add(box=shape, inverted=inverted)

    return set_boxes


def _eye_dome(picture: wire.DrawPicture, value: Any) -> None:
    parts = list(value) if isinstance(value, Sequence) else [value, 0]
    picture.eye_dome.strength, picture.eye_dome.radius = _numbers("eye_dome", parts, 2)


def _content(name: str, value: Any) -> Mapping[str, Any]:
    """A document of JSON, or that of the file of this name."""
    document = json.loads(Path(value).read_text()) if isinstance(value, PathLike) else value
    if not isinstance(document, Mapping):
        raise _wanted(name, "a JSON object", value)
    return document


def _check_keys(name: str, document: Mapping[str, Any], known: set[str]) -> None:
    if unknown := set(document) - known:
        raise InvalidInput(f"{name}: there is no field '{sorted(unknown)[0]}'")


def _transfer_point(point: Any) -> wire.TransferPoint:
    if not isinstance(point, Mapping):
        value, red, green, blue, opacity = _numbers("transfer", point, 5)
        return wire.TransferPoint(value=value, color=_color("transfer", (red, green, blue)), opacity=opacity)
    _check_keys("transfer", point, {"value", "color", "color_linear", "opacity", "extinction"})
    result = wire.TransferPoint(value=_number("transfer", point.get("value")))
    if "color_linear" in point:
        result.color_linear.CopyFrom(to_wire(vector_of(point["color_linear"], "transfer")))
    else:
        result.color.CopyFrom(_color("transfer", point.get("color")))
    if "extinction" in point:
        result.extinction = _number("transfer", point["extinction"])
    else:
        result.opacity = _number("transfer", point.get("opacity"))
    return result


def _transfer_from_file(document: Mapping[str, Any]) -> wire.TransferFunction:
    _check_keys("transfer", document, {"preset", "first", "last", "points"})
    if "preset" not in document:
        return wire.TransferFunction(points=[_transfer_point(p) for p in document.get("points", [])])
    transfer = wire.TransferFunction(preset=_choice("transfer", PRESETS, document["preset"]))
    for end in ("first", "last"):
        if end in document:
            setattr(transfer, end, _number("transfer", document[end]))
    return transfer


def _transfer(picture: wire.DrawPicture, value: Any) -> None:
    if isinstance(value, str):
        transfer = _transfer_from_file({"preset": value})
    elif isinstance(value, (Mapping, PathLike)):
        transfer = _transfer_from_file(_content("transfer", value))
    elif len(value) == 3 and isinstance(value[0], str):
        transfer = _transfer_from_file({"preset": value[0], "first": value[1], "last": value[2]})
    else:
        transfer = wire.TransferFunction(points=[_transfer_point(point) for point in value])
    picture.transfer.CopyFrom(transfer)


def _iso(picture: wire.DrawPicture, value: Any) -> None:
    for surface in value if isinstance(value, Iterable) else [value]:
        parts = list(surface) if isinstance(surface, Iterable) else [surface]
        if len(parts) not in (1, 4, 5):
            raise _wanted("iso", "a value, perhaps with a colour and an opacity", surface)
        added = picture.iso_surfaces.add(value=_number("iso", parts[0]))
        if len(parts) > 1:
            added.color.CopyFrom(_color("iso", parts[1:4]))
        if len(parts) == 5:
            added.opacity = _number("iso", parts[4])


def _slice(picture: wire.DrawPicture, value: Any) -> None:
    for plane in value:
        if isinstance(plane[0], str):
            axis = 1 + _choice("slice", "ijk", plane[0])
            picture.slices.add(axis=axis, index=_number("slice", plane[1]))
        else:
            parts = _numbers("slice", plane, 6)
            picture.slices.add(point=to_wire(parts[:3]), normal=to_wire(parts[3:]))


def _opacity_by_class(picture: wire.DrawPicture, value: Any) -> None:
    for code, factor in value.items():
        picture.class_opacities.add(
            code=natural("opacity_by_class", code), opacity=_number("opacity_by_class", factor)
        )


def _glyph(picture: wire.DrawPicture, value: Any) -> None:
    shape, sharpness = (value, None) if isinstance(value, str) else value
    picture.glyphs.shape = _choice("glyph", ("ellipsoid", "superquadric"), shape)
    if sharpness is not None:
        picture.glyphs.sharpness = _number("glyph", sharpness)


def _threshold(picture: wire.DrawPicture, value: Any) -> None:
    for threshold in value:
        if not 2 <= len(threshold) <= 3 or not isinstance(threshold[0], str):
            raise _wanted("threshold", "(attribute, smallest[, largest])", threshold)
        added = picture.glyphs.thresholds.add(attribute=threshold[0], smallest=_number("threshold", threshold[1]))
        if len(threshold) == 3:
            added.largest = _number("threshold", threshold[2])


def _lights(picture: wire.DrawPicture, value: Any) -> None:
    document = _content("lights", value)
    _check_keys("lights", document, {"ambient", "specular", "exponent", "lights"})
    lighting = picture.lighting
    lighting.ambient = _number("lights", document.get("ambient", 0))
    lighting.specular = _number("lights", document.get("specular", 0))
    lighting.exponent = _number("lights", document.get("exponent", 32))
    for light in document["lights"]:
        _check_keys("lights", light, {"direction", "power"})
        lighting.lights.add(
            direction=to_wire(vector_of(light["direction"], "lights")), power=_number("lights", light.get("power", 1))
        )


def _plain_value(name: str, field: PlainField, value: Any) -> Any:
    """An option that is one value, as it is kept in a message."""
    if field.kind == "choice":
        return _choice(name, field.names, value)
    if field.kind == "switch":
        return _flag(name, value)
    if field.kind == "color":
        return _color(name, value)
    number = _number(name, value)
    if field.above is not None and number <= field.above:
        raise _wanted(name, f"a number above {field.above:g}", value)
    return number


def _plain_setter(name: str, field: PlainField) -> Callable[[wire.DrawPicture, Any], None]:
    *path, member = field.place.split(".")

    def set_plain(picture: wire.DrawPicture, value: Any) -> None:
        wanted = _plain_value(name, field, value)
        message: Any = reduce(getattr, path, picture)
        if field.kind == "color":
            getattr(message, member).CopyFrom(wanted)
        else:
            setattr(message, member, wanted)

    return set_plain


_SETTERS: dict[str, Callable[[wire.DrawPicture, Any], None]] = {
    "resolution": _resolution,
    "format": _format,
    "quality": _quality,
    "channels": _channels,
    "color_by": _color_by,
    "color_range": _color_range,
    "hide_classes": _hide_classes,
    "hide_models": _hide_models,
    "clip_box": _clip(False),
    "clip_out": _clip(True),
    "eye_dome": _eye_dome,
    "transfer": _transfer,
    "iso": _iso,
    "slice": _slice,
    "opacity_by_class": _opacity_by_class,
    "glyph": _glyph,
    "threshold": _threshold,
    "lights": _lights,
    **{name: _plain_setter(name, field) for name, field in PLAIN_FIELDS.items()},
}
OPTIONS = tuple(_SETTERS)


def picture_request(model: str, camera: Camera | None, options: Mapping[str, Any]) -> wire.DrawPicture:
    """The request for a picture. Raises InvalidInput for what is no option, or has a wrong value."""
    picture = wire.DrawPicture(model=model)
    if camera is not None:
        picture.camera.CopyFrom(camera.to_wire())
    for name, value in options.items():
        if name not in _SETTERS:
            raise InvalidInput(f"there is no option '{name}'")
        if value is not None:
            _SETTERS[name](picture, value)
    return picture


class RegionOptions(TypedDict, total=False):
    """Which points are taken. Without options: all."""

    box: Box | Sequence[Vector] | Iterable[Box | Sequence[Vector]]  # points in one of them
    corridor: Corridor | Iterable[Corridor]  # and in one of these
    classes: Iterable[int]  # and of these classes
    every: int  # of all points of the model every n-th
    coordinates: Literal["source", "world"]  # of the system of the scan, or of that of the model, where it differs


def _boxes(value: Any) -> list[Box]:
    if isinstance(value, Box):
        return [value]
    items = list(value)
    corners = len(items) == 2 and not any(isinstance(item, Box) for item in items) and np.ndim(items[0]) == 1
    return [Box(*items)] if corners else [item if isinstance(item, Box) else Box(*item) for item in items]


def _corridor(corridor: Corridor) -> wire.Corridor:
    message = wire.Corridor(line=[number for corner in corridor.line for number in corner], width=corridor.width)
    if corridor.low is not None:
        message.low = corridor.low
    if corridor.high is not None:
        message.high = corridor.high
    return message


def region_request(model: str, options: Mapping[str, Any]) -> wire.GetPoints:
    """The request for points of a region, as an array of NumPy."""
    for name in options:
        if name not in RegionOptions.__annotations__:
            raise InvalidInput(f"there is no option {name!r}")
    given = {name: value for name, value in options.items() if value is not None}
    request = wire.GetPoints(model=model, format=wire.POINT_FORMAT_NPY)
    for box in _boxes(given["box"]) if "box" in given else []:
        request.boxes.append(wire.Box(min=to_wire(box.low), max=to_wire(box.high)))
    corridors = given.get("corridor", ())
    for corridor in [corridors] if isinstance(corridors, Corridor) else corridors:
        request.corridors.append(_corridor(corridor))
    request.classes.extend(natural("classes", code) for code in given.get("classes", ()))
    request.every = natural("every", given.get("every", 1))
    request.world_coordinates = _choice("coordinates", ("source", "world"), given.get("coordinates", "source")) == 1
    return request


def line_from(line: Iterable[Vector]) -> list[wire.Vector3]:
    """The points of a profile's line."""
    return [to_wire(vector_of(point, "line")) for point in line]
