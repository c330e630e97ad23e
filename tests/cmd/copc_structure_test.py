#!/usr/bin/env python3
"""Reads what `surfcastd export` writes as COPC and EPT, after the specifications and with nothing but Python.

Chunks of point formats 6 to 8 begin with a whole record and the number of points, which need no decoder.
"""

import json
import math
import pathlib
import random
import struct
import subprocess
import sys
import tempfile

RECORD = struct.Struct("<iiiHBBBBhHd")  # point format 6
SCALE = 0.01


def write_scan(path: pathlib.Path) -> set[bytes]:
    """Writes a LAS 1.4 file of a hilly surface. Returns its records."""
    chance = random.Random(3)
    records = set()
    for i in range(4000):
        x, y = chance.random(), chance.random()
        z = math.sin(6 * x) * math.cos(4 * y)
        records.add(
            RECORD.pack(int(9000 * x), int(7000 * y), int(900 * z), i, 1 + i % 3 | 0x30, 0, i % 7, 0, 0, i % 5, i / 8)
        )
    header = bytearray(375)
    header[0:4] = b"LASF"
    header[24:26] = bytes([1, 4])
    struct.pack_into("<HI", header, 94, 375, 375)
    struct.pack_into("<BH", header, 104, 6, RECORD.size)
    struct.pack_into("<6d", header, 131, SCALE, SCALE, SCALE, 500000, 5000000, 0)
    struct.pack_into("<Q", header, 247, len(records))
    path.write_bytes(header + b"".join(sorted(records)))
    return records


def variable_records(data: bytes) -> list[tuple[str, int, bytes]]:
    """The records before the points: user, number, body."""
    (at,) = struct.unpack_from("<H", data, 94)
    (count,) = struct.unpack_from("<I", data, 100)
    found = []
    for _ in range(count):
        user, number, size = struct.unpack_from("<16sHH", data, at + 2)
        found.append((user.rstrip(b"\0").decode(), number, data[at + 54 : at + 54 + size]))
        at += 54 + size
    assert at == struct.unpack_from("<I", data, 96)[0], "the points begin behind the records"
    return found


def extended_records(data: bytes) -> list[tuple[str, int, int, int]]:
    """The records behind the points: user, number, offset and size of the body."""
    at, count = struct.unpack_from("<QI", data, 235)
    found = []
    for _ in range(count):
        user, number, size = struct.unpack_from("<16sHQ", data, at + 2)
        found.append((user.rstrip(b"\0").decode(), number, at + 60, size))
        at += 60 + size
    assert at == len(data), "nothing lies behind the last record"
    return found


def walk(data: bytes, offset: int, size: int) -> dict[tuple[int, ...], tuple[int, int, int]]:
    """The nodes of a page of the hierarchy and those below: offset, bytes and points of the chunk."""
    nodes = {}
    for at in range(offset, offset + size, 32):
        *key, begin, length, points = struct.unpack_from("<4iQ2i", data, at)
        if points == -1:
            nodes.update(walk(data, begin, length))
        else:
            nodes[tuple(key)] = (begin, length, points)
    return nodes


def position(record: bytes, offset: tuple[float, ...]) -> list[float]:
    return [number * SCALE + shift for number, shift in zip(struct.unpack_from("<3i", record), offset)]


def check_chunk(chunk: bytes, points: int, cube: tuple[list[float], float], records: set[bytes]) -> None:
    first = chunk[: RECORD.size]
    assert first in records, "a chunk begins with a record of the scan"
    assert struct.unpack_from("<I", chunk, RECORD.size)[0] == points
    low, side = cube
    for at, begin in zip(position(first, (500000, 5000000, 0)), low):
        assert begin - 1e-7 <= at <= begin + side + 1e-7, "a point lies outside of the cube of its node"


def check_copc(path: pathlib.Path, records: set[bytes]) -> None:
    data = path.read_bytes()
    assert data[:4] == b"LASF" and data[24:26] == bytes([1, 4])
    assert struct.unpack_from("<H", data, 94)[0] == 375
    assert data[104] == 0x80 | 6
    found = variable_records(data)
    user, number, info = found[0]
    assert (user, number, len(info)) == ("copc", 1, 160), "the info record comes first"
    *centre, half, spacing, page, page_size, first_time, last_time = struct.unpack_from("<5d2Q2d", info)
    assert info[72:] == bytes(88), "what is reserved is zero"
    assert math.isclose(spacing, half / 64)
    times = [struct.unpack_from("<d", record, 22)[0] for record in records]
    assert (first_time, last_time) == (min(times), max(times))
    laszip = next(body for user, number, body in found if (user, number) == ("laszip encoded", 22204))
    assert struct.unpack_from("<H", laszip)[0] == 3, "layers in chunks"
    assert struct.unpack_from("<I", laszip, 12)[0] == 0xFFFFFFFF, "chunks of any size"
    user, number, offset, size = extended_records(data)[0]
    assert (user, number) == ("copc", 1000)
    assert offset <= page and page + page_size <= offset + size, "the hierarchy is in its record"
    nodes = walk(data, page, page_size)
    assert len(nodes) > 10
    assert sum(points for _, _, points in nodes.values()) == len(records) == struct.unpack_from("<Q", data, 247)[0]
    (place,) = struct.unpack_from("<I", data, 96)
    end = place + 8
    for key, (begin, length, points) in sorted(nodes.items(), key=lambda node: node[1]):
        assert begin == end, "the chunks lie one behind another"
        end = begin + length
        depth, *cell = key
        assert depth == 0 or (depth - 1, *(number // 2 for number in cell)) in nodes
        side = 2 * half / 2**depth
        low = [middle - half + side * number for middle, number in zip(centre, cell)]
        check_chunk(data[begin:end], points, (low, side), records)
    assert struct.unpack_from("<q", data, place)[0] == end, "the chunk table comes next"
    assert struct.unpack_from("<2I", data, end) == (0, len(nodes))
    check_header(data, records)


def check_header(data: bytes, records: set[bytes]) -> None:
    places = [position(record, (500000, 5000000, 0)) for record in records]
    bounds = struct.unpack_from("<6d", data, 179)
    for axis in range(3):
        values = [place[axis] for place in places]
        assert math.isclose(bounds[2 * axis], max(values)) and math.isclose(bounds[2 * axis + 1], min(values))
    returns = struct.unpack_from("<15Q", data, 255)
    assert list(returns[:4]) == [sum(record[14] & 15 == number for record in records) for number in range(1, 5)]


def check_ept(folder: pathlib.Path, records: set[bytes]) -> None:
    ept = json.loads((folder / "ept.json").read_text())
    assert ept["points"] == len(records) and ept["dataType"] == "laszip"
    low, side = ept["bounds"][:3], ept["bounds"][3] - ept["bounds"][0]
    counts = json.loads((folder / "ept-hierarchy/0-0-0-0.json").read_text())
    assert sum(counts.values()) == len(records)
    assert {path.stem for path in (folder / "ept-data").iterdir()} == set(counts)
    for name, points in counts.items():
        depth, *cell = map(int, name.split("-"))
        data = (folder / f"ept-data/{name}.laz").read_bytes()
        assert struct.unpack_from("<Q", data, 247)[0] == points
        (begin,) = struct.unpack_from("<I", data, 96)
        step = side / 2**depth
        corner = [least + step * number for least, number in zip(low, cell)]
        check_chunk(data[begin + 8 :], points, (corner, step), records)


def main() -> None:
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        records = write_scan(folder / "scan.las")
        for target in ("scan.copc.laz", "scan/ept.json"):
            command = [sys.argv[1], "export", "scan.las", "--output", target, "--chunk", "100"]
            subprocess.run(command, cwd=folder, check=True, stdout=subprocess.DEVNULL)
        check_copc(folder / "scan.copc.laz", records)
        check_ept(folder / "scan", records)


if __name__ == "__main__":
    main()
