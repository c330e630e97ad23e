#!/usr/bin/env python3
"""Measures what a service goes through: service.py SURFCASTD MODEL [--only NAME ...] [--waits SECONDS ...]

Starts a server for each figure, and stops it afterwards. The exit code is 1 if a figure was missed.

resume:   a view whose connection is cut, for each of --waits; the time from connecting again to the first frame.
reload:   50 encrypted connections draw coarse pictures while the certificate is replaced five times; none may be lost.
drain:    eight viewers and a client of pictures while the server is told to stop; the time until it has ended.
workers:  four views whose picture changes while the process that draws is killed 100 times; the time from each kill to
          the last view's next frame, and the sessions lost.
health:   the time of /healthz while one client of 16 connections orders pictures, views and nonsense.
"""
import argparse
import os
import signal
import socket
import ssl
import subprocess
import sys
import tempfile
import threading
import time

import wire


class Server:
    def __init__(self, program, model, *flags):
        self.model = os.path.splitext(os.path.basename(model))[0]
        self.log = tempfile.TemporaryFile()
        command = [program, "serve", model, "--listen", "127.0.0.1:0", *flags]
        self.process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=self.log)
        self.port = int(self.process.stdout.readline().decode().rsplit(":", 1)[1].strip().rstrip("/"))

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.process.kill()
        self.process.wait()

    def connect(self, context=None):
        plain = socket.create_connection(("127.0.0.1", self.port), timeout=30)
        return wire.Session(context.wrap_socket(plain, server_hostname="localhost") if context else plain)

    def get(self, path):
        try:
            with socket.create_connection(("127.0.0.1", self.port), timeout=30) as connection:
                connection.sendall(f"GET {path} HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n\r\n".encode())
                answer = b""
                while part := connection.recv(65536):
                    answer += part
                return int(answer[9:12] or 0)
        except OSError:
            return 0


def open_view(server, session, number=5):
    content = wire.field(1, wire.picture(server.model, 320, 240))
    session.send(number, wire.OPEN_VIEW, content)
    session.await_kind(wire.VIEW_FRAME)


def resume(arguments):
    told, good = [], True
    with Server(arguments.program, arguments.model) as server:
        for wait in arguments.waits:
            session = server.connect()
            session.send(1, wire.RESUME)
            secret = wire.fields(session.await_kind(wire.RESUMED)[wire.RESUMED])[1]
            open_view(server, session)
            session.connection.close()
            time.sleep(wait)
            begin = time.monotonic()
            session = server.connect()
            session.send(1, wire.RESUME, wire.field(1, secret))
            goes_on = 3 in wire.fields(session.await_kind(wire.RESUMED)[wire.RESUMED])
            if goes_on:
                session.await_kind(wire.VIEW_FRAME)
            milliseconds = 1000 * (time.monotonic() - begin)
            good = good and goes_on == (wait <= 180) and milliseconds < 300
            told.append(f"{wait} s: {'goes on' if goes_on else 'anew'} after {milliseconds:.0f} ms")
    return good, ", ".join(told)


def make_certificate(folder):
    subprocess.run(["openssl", "req", "-x509", "-newkey", "ec", "-pkeyopt", "ec_paramgen_curve:P-256", "-nodes",
                    "-days", "2", "-subj", "/CN=localhost", "-addext", "subjectAltName=DNS:localhost", "-keyout",
                    folder + "/new.key", "-out", folder + "/new.crt"], check=True, capture_output=True)
    os.replace(folder + "/new.key", folder + "/tls.key")
    os.replace(folder + "/new.crt", folder + "/tls.crt")


def reload(arguments):
    context = ssl._create_unverified_context()
    with tempfile.TemporaryDirectory() as folder:
        make_certificate(folder)
        with Server(arguments.program, arguments.model, "--tls-certificate", folder) as server:
            over, drawn, lost = threading.Event(), [0] * 50, [0]

            def draw(place):
                try:
                    session = server.connect(context)
                    while not over.is_set():
                        session.send(1, wire.DRAW_PICTURE, wire.picture(server.model, 48, 32, spacing=4))
                        session.await_kind(wire.PICTURE)
                        drawn[place] += 1
                except OSError:
                    lost[0] += 1

            threads = [threading.Thread(target=draw, args=(i,)) for i in range(50)]
            for thread in threads:
                thread.start()
            while min(drawn) == 0 and lost[0] == 0:
                time.sleep(0.1)
            delays = []
            for _ in range(5):
                make_certificate(folder)
                begin = time.monotonic()
                with open(folder + "/tls.crt") as file:
                    wanted = file.read().strip()
                while ssl.get_server_certificate(("127.0.0.1", server.port)).strip() != wanted:
                    time.sleep(0.05)
                delays.append(time.monotonic() - begin)
            before = sum(drawn)
            while sum(drawn) < before + 100 and lost[0] == 0:
                time.sleep(0.1)
            over.set()
            for thread in threads:
                thread.join()
    return lost[0] == 0 and max(delays) < 5, (
        f"{lost[0]} of 50 connections lost, {sum(drawn)} pictures; in use after {max(delays):.2f} s at most")


def drain(arguments):
    flags = ["--grace-time", "5", "--leave-time", "8", "--drain-timeout", "10"]
    with Server(arguments.program, arguments.model, *flags) as server:
        ended, failed, pictures = [], [0], [0]

        def watch():
            session = server.connect()
            open_view(server, session)
            try:
                while True:
                    session.await_kind(wire.VIEW_FRAME)
            except OSError:
                ended.append(time.monotonic())

        def order():
            while server.get("/readyz") == 200:
                failed[0] += server.get(f"/api/models/{server.model}/image?resolution=96,64") != 200
                pictures[0] += 1

        threads = [threading.Thread(target=watch) for _ in range(8)] + [threading.Thread(target=order)]
        for thread in threads:
            thread.start()
        time.sleep(3)
        begin = time.monotonic()
        server.process.send_signal(signal.SIGTERM)
        server.process.wait(60)
        seconds = time.monotonic() - begin
        for thread in threads:
            thread.join()
    return seconds < 25 and failed[0] == 0 and server.process.returncode == 0, (
        f"ended {seconds:.1f} s after the signal, {failed[0]} of {pictures[0]} pictures failed; eight viewers left "
        f"between {min(ended) - begin:.1f} and {max(ended) - begin:.1f} s")


def health(arguments):
    with Server(arguments.program, arguments.model) as server:
        over = threading.Event()

        def attack(place):
            while not over.is_set():
                try:
                    session = server.connect()
                    for view in range(4):
                        session.send(10 + view, wire.OPEN_VIEW, wire.field(1, wire.picture(server.model, 2048, 1080)))
                    session.send(1, wire.DRAW_PICTURE, wire.picture(server.model, 4096, 4096))
                    for update in range(1, 1000):
                        moved = wire.picture(server.model, 2048 - update % 7, 1080)
                        session.send(10 + update % 4, wire.UPDATE_VIEW,
                                     wire.field(1, update) + wire.field(2, moved) + wire.field(3, 1))
                        session.send(2 + update, wire.PING)
                except OSError:
                    pass

        threads = [threading.Thread(target=attack, args=(i,), daemon=True) for i in range(16)]
        for thread in threads:
            thread.start()
        times, wrong = [], 0
        for _ in range(100):
            begin = time.monotonic()
            wrong += server.get("/healthz") != 200
            times.append(time.monotonic() - begin)
            time.sleep(0.1)
        over.set()
    return wrong == 0 and max(times) < 1, f"{wrong} of 100 not answered, the slowest after {max(times):.2f} s"


def worker_of(server):
    """The process that draws for a server."""
    listed = subprocess.run(["pgrep", "--parent", str(server.process.pid), "--full", "render-worker"],
                            capture_output=True, text=True).stdout.split()
    return int(listed[0]) if listed else None


def frame_of(session, update):
    """Waits for a frame that shows an update or a later one."""
    while True:
        frame = wire.fields(session.await_kind(wire.VIEW_FRAME)[wire.VIEW_FRAME])
        if frame.get(2, 0) >= update:
            return


def workers(arguments):
    times, lost = [], 0
    with Server(arguments.program, arguments.model) as server:
        sessions = [server.connect() for _ in range(4)]
        for session in sessions:
            open_view(server, session)
        for kill in range(1, 101):
            worker = worker_of(server)
            begin = time.monotonic()
            if worker:
                os.kill(worker, signal.SIGKILL)
            changed = wire.field(1, kill) + wire.field(2, wire.picture(server.model, 320, 240 + kill % 7))
            for session in sessions:
                session.send(5, wire.UPDATE_VIEW, changed + wire.field(3, 1))
            for session in list(sessions):
                try:
                    frame_of(session, kill)
                except OSError:
                    sessions.remove(session)
                    lost += 1
            times.append(time.monotonic() - begin)
    times.sort()
    return lost == 0 and times[-1] < 5, (
        f"{lost} of 4 sessions lost, frames again after {times[50]:.2f} s in the median and {times[-1]:.2f} s at most")


FIGURES = [resume, reload, drain, workers, health]


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("program")
    parser.add_argument("model")
    parser.add_argument("--only", nargs="*", default=[figure.__name__ for figure in FIGURES])
    parser.add_argument("--waits", nargs="*", type=float, default=[1, 60, 170, 190])
    arguments = parser.parse_args()
    missed = 0
    for figure in FIGURES:
        if figure.__name__ not in arguments.only:
            continue
        good, words = figure(arguments)
        missed += not good
        print(f"{'good' if good else 'MISSED':8}{figure.__name__}: {words}", flush=True)
    return 1 if missed else 0


if __name__ == "__main__":
    sys.exit(main())
