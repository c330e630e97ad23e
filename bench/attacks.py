#!/usr/bin/env python3
"""Attacks a server and tells what held: attacks.py SURFCASTD MODEL [--only NAME ...] [--json FILE]

Starts `surfcastd serve MODEL` on a free port of the loopback, and stops it afterwards. Every attack is made by clients
of one address, while another address asks for small pictures and for health. The exit code is 1 if an attack was not
held. What counts as held are states, counts and memory; times are printed, and depend on the machine.
"""
import argparse
import json
import os
import signal
import socket
import subprocess
import sys
import tempfile
import threading
import time

import wire

ATTACKER = "127.0.0.2"
VICTIM = "127.0.0.1"
HELLO = b"\xf5SURFCST" + b"\1\0" + b"\0\0" + b"\0\0" + b"\6\0" + b"\0\0" + b"attack"
UPGRADE = ("Upgrade: websocket\r\nConnection: Upgrade\r\nSec-WebSocket-Version: 13\r\n"
           "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\nSec-WebSocket-Protocol: surfcast.v1\r\n")


PICTURE_MEMORY = 256  # MiB


class Target:
    """A running server."""

    def __init__(self, program, model, flags):
        self.model = os.path.splitext(os.path.basename(model))[0]
        self.log = tempfile.TemporaryFile()
        command = [program, "serve", model, "--listen", "127.0.0.1:0", *flags]
        self.process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=self.log)
        line = self.process.stdout.readline().decode()
        if "http://" not in line:
            sys.exit(f"the server did not start: {line}")
        self.port = int(line.rsplit(":", 1)[1].strip().rstrip("/"))

    def connect(self, source=ATTACKER, timeout=20):
        return socket.create_connection((VICTIM, self.port), timeout=timeout, source_address=(source, 0))

    def ask(self, request, source=ATTACKER, timeout=20):
        """Everything that is answered until the connection ends."""
        answer = b""
        try:
            with self.connect(source, timeout) as connection:
                connection.sendall(request)
                while chunk := connection.recv(65536):
                    answer += chunk
        except OSError as error:
            answer += f"<{type(error).__name__}>".encode()
        return answer

    def get(self, path, source=ATTACKER, host="127.0.0.1", headers="", timeout=20):
        request = f"GET {path} HTTP/1.1\r\nHost: {host}\r\nConnection: close\r\n{headers}\r\n"
        return self.ask(request.encode(), source, timeout)

    def picture(self, source=VICTIM, size="96,64", timeout=60, more=""):
        return self.get(f"/api/models/{self.model}/image?resolution={size}{more}", source, timeout=timeout)

    def memory(self):
        """Resident, MiB."""
        with open(f"/proc/{self.process.pid}/status") as status:
            return next(int(line.split()[1]) // 1024 for line in status if line.startswith("VmRSS"))

    def lives(self):
        return self.process.poll() is None and status(self.get("/healthz", VICTIM)) == 200


def status(answer):
    return int(answer[9:12]) if answer.startswith(b"HTTP/1.") else 0


def timed(action):
    begin = time.monotonic()
    return action(), time.monotonic() - begin


class Victim(threading.Thread):
    """Asks for small pictures and for health while an attack goes on."""

    def __init__(self, target):
        super().__init__()
        self.target, self.over = target, threading.Event()
        self.pictures, self.health, self.refused = [], [], 0

    def run(self):
        while not self.over.is_set():
            answer, seconds = timed(self.target.picture)
            self.pictures.append(seconds)
            self.refused += status(answer) != 200
            answer, seconds = timed(lambda: self.target.get("/healthz", VICTIM))
            self.health.append(seconds if status(answer) == 200 else float("inf"))

    def __enter__(self):
        self.start()
        return self

    def __exit__(self, *_):
        self.over.set()
        self.join()


def p95(seconds):
    return sorted(seconds)[min(len(seconds) - 1, int(0.95 * len(seconds)))]


# Each attack returns whether it was held, and what is to be said about it.


def all_connections(target):
    held = []
    for _ in range(300):
        held.append(target.connect())
    health, pictures = status(target.get("/healthz", VICTIM)), status(target.picture())
    for connection in held:
        connection.close()
    return health == 200 and pictures == 200, f"300 idle sockets: health {health}, another's picture {pictures}"


def unread_answers(target):
    before = target.memory()
    connection = target.connect(timeout=3)
    connection.sendall(HELLO)
    connection.recv(4096)
    ping = b"\x04\0\0\0\x08\1\x32\0"  # a Request with id 1 and an empty Ping
    sent = 0
    try:
        while sent < 20_000_000:
            sent += connection.send(ping * 8192)
    except OSError:
        pass
    grown = target.memory() - before
    connection.close()
    return grown < 32, f"{sent} bytes of requests were taken, memory grew by {grown} MiB"


def nonsense(target):
    answers = [target.ask(HELLO + b"\0\0\0\0" * 100), target.ask(os.urandom(4096)), target.ask(b"\xf5" * 64),
               target.ask(HELLO + b"\xff\xff\xff\xff")]
    return target.lives(), f"{len(answers)} kinds of it, each ended"


def largest_pictures(target):
    def order():
        target.picture(ATTACKER, "8192,4096", 600, "&format=exr")

    alone = [timed(target.picture)[1] for _ in range(5)]
    before = target.memory()
    with Victim(target) as victim:
        orders = [threading.Thread(target=order) for _ in range(3)]
        for thread in orders:
            thread.start()
        most = before
        while any(thread.is_alive() for thread in orders):
            time.sleep(0.2)
            most = max(most, target.memory())
    return victim.refused == 0 and max(victim.health) < 5, (
        f"three of 8192 x 4096: another's 96 x 64 at p95 {p95(victim.pictures):.2f} s, alone {p95(alone):.2f} s, "
        f"refused {victim.refused}; health at most {max(victim.health):.2f} s; memory {before}, at most {most} MiB")


class Mover(threading.Thread):
    """A connection whose views move all the time: each frame is acknowledged and answered by another update."""

    def __init__(self, target, views, width, height):
        super().__init__()
        self.picture = wire.picture(target.model, width, height)
        self.frames = 0
        self.session = wire.Session(target.connect())
        for view in range(1, views + 1):
            self.session.send(view, wire.OPEN_VIEW, wire.field(1, self.picture))
            self.move(view, 1)

    def move(self, view, update):
        background = wire.field(9, wire.field(1, update % 255))
        self.session.send(view, wire.UPDATE_VIEW,
                          wire.field(1, update) + wire.field(2, self.picture + background) + wire.field(3, 1))

    def run(self):
        while True:
            try:
                answer = self.session.receive()
            except OSError:
                return
            if wire.VIEW_FRAME not in answer:
                continue
            frame = wire.fields(answer[wire.VIEW_FRAME])
            self.session.send(answer[1], wire.FRAME_PAINTED, wire.field(1, frame[1]))
            self.frames += 1
            self.move(answer[1], self.frames + 1)


def moving_views(target):
    bound = 2 * max(timed(target.picture)[1] for _ in range(10)) + 0.25
    movers = [Mover(target, 8, 4096, 2160) for _ in range(8)]
    with Victim(target) as victim:
        for mover in movers:
            mover.start()
        time.sleep(20)
    for mover in movers:
        mover.session.connection.shutdown(socket.SHUT_RDWR)
        mover.join()
    frames = sum(mover.frames for mover in movers)
    return victim.refused == 0 and max(victim.pictures) < bound, (
        f"8 connections with 8 views of 4096 x 2160 each in motion, {frames} frames: another's 96 x 64 at most "
        f"{max(victim.pictures):.2f} s, p95 {p95(victim.pictures):.2f}, bound {bound:.2f}; refused {victim.refused}")


def silent_views(target):
    """Views at rest that acknowledge nothing. Memory counts in the server: the worker that draws has its own."""
    before = target.memory()
    sessions = [wire.Session(target.connect()) for _ in range(3)]
    for session in sessions:
        for view in range(1, 9):
            picture = wire.picture(target.model, 3840, 2160)
            session.send(view, wire.OPEN_VIEW, wire.field(1, picture))
    most, end = before, time.monotonic() + 40
    while time.monotonic() < end:
        time.sleep(0.2)
        most = max(most, target.memory())
    for session in sessions:
        session.connection.close()
    return most - before < 1.1 * PICTURE_MEMORY, (
        f"3 connections with 8 silent views of 3840 x 2160 each: memory {before}, at most {most} MiB")


def rebinding(target):
    name = "attacker.example"
    wrong = [status(target.get("/api/models", host=name)), status(target.get("/metrics", host=name)),
             status(target.ask(f"GET /ws HTTP/1.1\r\nHost: {name}\r\nOrigin: http://{name}\r\n{UPGRADE}\r\n".encode()))]
    image = target.get(f"/api/models/{target.model}/image", headers="Sec-Fetch-Site: cross-site\r\n")
    own = f"127.0.0.1:{target.port}"
    origin = target.ask(f"GET /ws HTTP/1.1\r\nHost: {own}\r\nOrigin: https://{own}\r\n{UPGRADE}\r\n".encode())
    held = wrong == [421] * 3 and status(image) == 403 and status(origin) == 403
    return held, f"foreign Host {wrong}, cross-site {status(image)}, another scheme {status(origin)}"


def smuggling(target):
    second = b"GET /metrics HTTP/1.1\r\nHost: 127.0.0.1\r\nConnection: close\r\n\r\n"
    counts = []
    for encoding in ["gzip", "identity", "xchunked", '"chunked"', "chunked, gzip"]:
        head = f"GET /healthz HTTP/1.1\r\nHost: 127.0.0.1\r\nTransfer-Encoding: {encoding}\r\n\r\n"
        answer = target.ask(head.encode() + second)
        counts.append((status(answer), answer.count(b"HTTP/1.1 ")))
    hosts = [status(target.ask(b"GET /healthz HTTP/1.1\r\n\r\n")),
             status(target.ask(b"GET /healthz HTTP/1.1\r\nHost: 127.0.0.1\r\nHost: 127.0.0.1\r\n\r\n"))]
    return counts == [(400, 1)] * 5 and hosts == [400, 400], f"status and answers {counts}; no Host, two: {hosts}"


def slow_requests(target):
    connection = target.connect(timeout=20)
    connection.sendall(b"GET /healthz HTTP/1.1\r\nHost: 127.0.0.1\r\n\r\n")
    connection.recv(4096)
    connection.sendall(b"GET /hea")
    try:
        ended, seconds = timed(lambda: connection.recv(10) == b"")
    except OSError:
        ended, seconds = isinstance(sys.exc_info()[1], ConnectionError), 20
    return ended, f"half of a second request: ended after {seconds:.1f} s"


def wide_picks(target):
    answer, seconds = timed(
        lambda: target.get(f"/api/models/{target.model}/pick?resolution=1,1&pixel=0,0&view_angle=179.9"))
    return status(answer) in (200, 400), f"a pixel as wide as the model: {status(answer)} after {seconds:.3f} s"


def vanishing_clients(target):
    for _ in range(50):
        with target.connect() as connection:
            path = f"/api/models/{target.model}/image?resolution=4096,4096"
            connection.sendall(f"GET {path} HTTP/1.1\r\nHost: 127.0.0.1\r\n\r\nG".encode())
    answer, seconds = timed(target.picture)
    return status(answer) == 200, f"50 orders of clients that are gone: another's picture after {seconds:.2f} s"


ATTACKS = [all_connections, unread_answers, nonsense, largest_pictures, moving_views, silent_views, rebinding, smuggling,
           slow_requests, wide_picks, vanishing_clients]


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("program")
    parser.add_argument("model")
    parser.add_argument("--only", nargs="*", default=[attack.__name__ for attack in ATTACKS])
    parser.add_argument("--json", help="write the results to this file")
    arguments = parser.parse_args()
    target = Target(arguments.program, arguments.model, ["--picture-memory", f"{PICTURE_MEMORY}M"])
    target.picture()  # what happens once has happened
    results = []
    for attack in ATTACKS:
        if attack.__name__ not in arguments.only:
            continue
        held, words = attack(target)
        held = held and target.lives()
        results.append({"attack": attack.__name__, "held": held, "result": words})
        print(f"{'held' if held else 'NOT HELD':9}{attack.__name__}: {words}", flush=True)
        if not target.lives():
            break
    target.process.send_signal(signal.SIGTERM)
    target.process.wait(30)
    if arguments.json:
        with open(arguments.json, "w") as file:
            json.dump(results, file, indent=2)
    return 0 if all(result["held"] for result in results) else 1


if __name__ == "__main__":
    sys.exit(main())
