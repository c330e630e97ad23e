"""The framed protocol as far as the programs of this folder speak it, without a library: they also send errors."""
import struct


def hello(program="attack"):
    return b"\xf5SURFCST" + struct.pack("<HHHHH", 1, 0, 0, len(program), 0) + program.encode()


# Numbers of kinds, protocol/surfcast.proto.
DRAW_PICTURE, PING, OPEN_VIEW, UPDATE_VIEW, FRAME_PAINTED, RESUME = 4, 6, 8, 9, 10, 14
ERROR, PICTURE, PONG, VIEW_FRAME, RESUMED = 2, 5, 7, 9, 13


def varint(value):
    out = bytearray()
    while value > 127:
        out.append(value & 127 | 128)
        value >>= 7
    out.append(value)
    return bytes(out)


def field(number, value):
    """A field of an encoded message: an integer, or bytes."""
    if isinstance(value, int):
        return varint(number << 3) + varint(value)
    return varint(number << 3 | 2) + varint(len(value)) + value


def real_field(number, value):
    return varint(number << 3 | 1) + struct.pack("<d", value)


def fields(message):
    """The fields of an encoded message, by number: the last value of each."""
    found, place = {}, 0

    def number():
        nonlocal place
        value = shift = 0
        while True:
            byte = message[place]
            place += 1
            value |= (byte & 127) << shift
            shift += 7
            if byte < 128:
                return value

    while place < len(message):
        key = number()
        if key & 7 == 0:
            found[key >> 3] = number()
            continue
        size = {1: 8, 5: 4}.get(key & 7) or number()
        found[key >> 3] = message[place:place + size]
        place += size
    return found


def picture(model, width, height, spacing=0):
    """A DrawPicture; spacing in pixels, 0 for every point."""
    return field(1, model.encode()) + field(3, field(1, width) + field(2, height)) + real_field(8, spacing)


def request(number, kind, content=b""):
    message = field(1, number) + field(kind, content)
    return struct.pack("<I", len(message)) + message


class Session:
    """A connection of the framed protocol."""

    def __init__(self, connection, program="attack"):
        self.connection = connection
        connection.sendall(hello(program))
        self.read(sum(struct.unpack("<HH", self.read(18)[14:])))

    def read(self, size):
        parts = bytearray()
        while len(parts) < size:
            part = self.connection.recv(size - len(parts))
            if not part:
                raise ConnectionError("the server has ended the connection")
            parts += part
        return bytes(parts)

    def send(self, number, kind, content=b""):
        self.connection.sendall(request(number, kind, content))

    def receive(self):
        """The next answer: its fields by number."""
        return fields(self.read(struct.unpack("<I", self.read(4))[0]))

    def await_kind(self, kind):
        """The next answer of that kind; frames of views before it are acknowledged."""
        while True:
            answer = self.receive()
            if VIEW_FRAME in answer:
                self.send(answer[1], FRAME_PAINTED, field(1, fields(answer[VIEW_FRAME])[1]))
            if kind in answer:
                return answer
            if ERROR in answer:
                raise ConnectionError(fields(answer[ERROR]).get(2, b"").decode())
