#!/usr/bin/env python3
"""Measures servers behind proxies: cluster.py BIN MODEL [--only NAME ...]

BIN is the folder of surfcastd and surfcast; MODEL is served under many names. Three servers run behind HAProxy with
deploy/haproxy/haproxy.cfg, or one behind nginx with deploy/nginx/nginx.conf, with other ports. The exit code is 1 if a
figure was missed.

affinity:  pictures of 12 models by the framed protocol, WebSockets and HTTP; for each model the share of the server
           that drew most of them.
change:    the models that move to another server when one of three ends, of 200, and when it comes back.
kill:      a server is killed under views of its model by the framed protocol, and while pictures are drawn by HTTP; the
           time until each view has frames again, and the pictures that failed.
hot:       16 clients draw one model by HTTP from servers in which 10 pictures may wait; failures, and the servers that
           drew. HAProxy tries the next server and the first one in turns, so a model has two servers at most.
nginx:     pictures by the three protocols, and whose connections the server counts.
restart:   each server in turn is told to stop and started again while pictures are drawn by HTTP and a view moves.
"""
import argparse
import collections
import http.client
import os
import re
import signal
import socket
import subprocess
import sys
import tempfile
import threading
import time

import wire

NAMES = "abc"
DEPLOY = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "deploy")


def free_port():
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return probe.getsockname()[1]


class Cluster:
    """Three servers and a proxy before them."""

    def __init__(self, programs, model, names, *flags):
        self.folder = tempfile.TemporaryDirectory()
        self.programs = programs
        self.flags = ["--host", "*", "--trusted-proxy", "127.0.0.1/32", "--grace-time", "5", "--leave-time", "8",
                      "--gpu-memory", "256M", "--host-memory", "512M", *flags]
        self.models = os.path.join(self.folder.name, "models")
        os.mkdir(self.models)
        for name in names:
            os.symlink(os.path.abspath(model), os.path.join(self.models, name + ".surf"))
        self.ports = {name: free_port() for name in NAMES}
        self.port = free_port()
        self.servers = {}
        for name in NAMES:
            self.start(name)
        self.proxy = subprocess.Popen(["haproxy", "-q", "-f", self.configuration()])
        while not os.path.exists(self.folder.name + "/stats"):
            time.sleep(0.05)
        self.await_health(NAMES)

    def configuration(self):
        """The deployed file, with the ports of this cluster and a socket for its counters."""
        with open(DEPLOY + "/haproxy/haproxy.cfg") as file:
            text = file.read()
        text = text.replace("bind :7600", f"bind 127.0.0.1:{self.port}")
        text = re.sub(r"server ([abc]) \S+", lambda found: f"server {found[1]} 127.0.0.1:{self.ports[found[1]]}", text)
        text = text.replace("global\n", f"global\n  stats socket {self.folder.name}/stats mode 600\n", 1)
        path = os.path.join(self.folder.name, "haproxy.cfg")
        with open(path, "w") as file:
            file.write(text)
        return path

    def start(self, name):
        command = [self.programs + "/surfcastd", "serve", self.models, "--listen", f"127.0.0.1:{self.ports[name]}"]
        with open(os.path.join(self.folder.name, name + ".log"), "a") as log:
            self.servers[name] = subprocess.Popen(command + self.flags, stdout=subprocess.PIPE, stderr=log)
        self.servers[name].stdout.readline()

    def stop(self, name, number):
        self.servers[name].send_signal(number)
        self.servers[name].wait()

    def counters(self, column, proxy="web"):
        """A column of HAProxy's statistics, by server."""
        with socket.socket(socket.AF_UNIX) as connection:
            connection.connect(self.folder.name + "/stats")
            connection.sendall(b"show stat\n")
            text = b""
            while part := connection.recv(65536):
                text += part
        head, *rows = [line.split(",") for line in text.decode().lstrip("# ").splitlines() if line]
        rows = [dict(zip(head, row)) for row in rows]
        return {row["svname"]: row[column] for row in rows if row["pxname"] == proxy and row["svname"] in NAMES}

    def await_health(self, names):
        while {name for name, state in self.counters("status").items() if state == "UP"} != set(names):
            time.sleep(0.05)

    def get(self, path):
        """The status of a request through the proxy."""
        connection = http.client.HTTPConnection("127.0.0.1", self.port, timeout=60)
        try:
            connection.request("GET", path)
            answer = connection.getresponse()
            answer.read()
            return answer.status
        except (OSError, http.client.HTTPException):
            return 0
        finally:
            connection.close()

    def draw(self, model, size="96,64"):
        return self.get(f"/api/models/{model}/image?resolution={size}")

    def command(self, scheme, model):
        """A picture by the thin client."""
        target = f"{scheme}127.0.0.1:{self.port}/{model}"
        return subprocess.run([self.programs + "/surfcast", "render", target, "--resolution", "96,64", "--output",
                               self.folder.name + "/picture.png"], capture_output=True).returncode

    def drawn(self):
        """Connections and requests that went to each server."""
        web, framed = self.counters("stot"), self.counters("stot", "framed")
        return collections.Counter({name: int(web[name]) + int(framed[name]) for name in NAMES})

    def view(self, model):
        """A session with an open view, after its first frame."""
        connection = socket.create_connection(("127.0.0.1", self.port), timeout=60)
        session = wire.Session(connection, f"bench 1 model={model}")
        session.send(5, wire.OPEN_VIEW, wire.field(1, wire.picture(model, 320, 240)))
        session.await_kind(wire.VIEW_FRAME)
        return session

    def __enter__(self):
        return self

    def __exit__(self, *_):
        for process in [self.proxy, *self.servers.values()]:
            process.kill()
            process.wait()
        self.folder.cleanup()


class Pictures:
    """Draws by HTTP in a thread until it is told to end."""

    def __init__(self, cluster, models):
        self.statuses, self.over = collections.Counter(), threading.Event()

        def draw():
            while not self.over.is_set():
                for model in models:
                    self.statuses[cluster.draw(model)] += 1

        self.thread = threading.Thread(target=draw)
        self.thread.start()

    def end(self):
        """The number of pictures, and of those that failed."""
        self.over.set()
        self.thread.join()
        return sum(self.statuses.values()), sum(self.statuses.values()) - self.statuses[200]


def server_of(cluster, model):
    before = cluster.drawn()
    assert cluster.get(f"/api/models/{model}") == 200
    (name, _), = (cluster.drawn() - before).items()
    return name


def affinity(arguments):
    names = [f"model{i}" for i in range(11)] + ["old church"]
    shares, failed = [], 0
    with Cluster(arguments.programs, arguments.model, names) as cluster:
        for name in names:
            before = cluster.drawn()
            for _ in range(4):
                failed += cluster.draw(name.replace(" ", "%20")) != 200
                failed += cluster.command("", name) != 0
                failed += cluster.command("ws://", name) != 0
            after = cluster.drawn() - before
            shares.append(max(after.values()) / sum(after.values()))
    return min(shares) >= 0.95 and failed == 0, (
        f"{100 * min(shares):.0f} % of a model's 12 requests at one server, at least; {failed} failed")


def change(arguments):
    names = [f"scan-{i}" for i in range(200)]
    with Cluster(arguments.programs, arguments.model, names) as cluster:
        three = {name: server_of(cluster, name) for name in names}
        cluster.stop("c", signal.SIGKILL)
        cluster.await_health("ab")
        two = {name: server_of(cluster, name) for name in names}
        cluster.start("c")
        cluster.await_health("abc")
        again = {name: server_of(cluster, name) for name in names}
    moved = sum(three[name] != two[name] for name in names)
    needless = sum(three[name] != two[name] and three[name] != "c" for name in names)
    held = collections.Counter(three.values())
    return moved <= (1 / 3 + 0.1) * len(names) and needless == 0 and again == three, (
        f"{moved} of {len(names)} models moved, {needless} of them needlessly; "
        f"{'all' if again == three else 'not all'} came back; {sorted(held.values())} models on three servers")


def reopened(cluster, model, begin):
    """Opens a view as often as it takes; the seconds since `begin`."""
    while True:
        try:
            cluster.view(model)
            return time.monotonic() - begin
        except OSError:
            time.sleep(0.1)


def kill(arguments):
    with Cluster(arguments.programs, arguments.model, ["church"]) as cluster:
        times, counts = [], [0, 0]
        for _ in range(5):
            victim = server_of(cluster, "church")
            sessions = [cluster.view("church") for _ in range(4)]
            pictures = Pictures(cluster, ["church"])
            time.sleep(1)
            begin = time.monotonic()
            cluster.stop(victim, signal.SIGKILL)
            for session in sessions:
                try:
                    while True:
                        session.receive()
                except OSError:
                    times.append(reopened(cluster, "church", begin))
            time.sleep(1)
            counts = [a + b for a, b in zip(counts, pictures.end())]
            cluster.start(victim)
            cluster.await_health(NAMES)
    return max(times) < 5 and counts[1] == 0, (
        f"5 servers killed: {len(times)} views with frames again after {max(times):.2f} s at most, {counts[1]} of "
        f"{counts[0]} pictures failed")


def hot(arguments):
    with Cluster(arguments.programs, arguments.model, ["church"], "--max-queue", "10") as cluster:
        home, before = server_of(cluster, "church"), cluster.drawn()
        crowd = [Pictures(cluster, ["church"]) for _ in range(16)]
        time.sleep(15)
        counts = [sum(column) for column in zip(*[pictures.end() for pictures in crowd])]
        drew = cluster.drawn() - before
    spread = ", ".join(f"{count} at {'home' if name == home else name}" for name, count in sorted(drew.items()))
    return counts[1] == 0 and len(drew) > 1, f"{counts[1]} of {counts[0]} pictures failed; requests: {spread}"


def restart(arguments):
    with Cluster(arguments.programs, arguments.model, ["church", "tower", "gate", "wall"]) as cluster:
        pictures = Pictures(cluster, ["church", "tower", "gate", "wall"])
        slowest, over, gaps = [0.0], threading.Event(), []

        def watch():
            while not over.is_set():
                begin = time.monotonic()
                try:
                    session = cluster.view("church")
                    gaps.append(time.monotonic() - begin)
                    update = 0
                    while not over.is_set():
                        update += 1
                        moved = wire.picture("church", 320, 240 + update % 2)
                        session.send(5, wire.UPDATE_VIEW, wire.field(1, update) + wire.field(2, moved))
                        session.await_kind(wire.VIEW_FRAME)
                        time.sleep(0.05)
                except OSError:
                    pass

        thread = threading.Thread(target=watch)
        thread.start()
        for name in NAMES:
            begin = time.monotonic()
            cluster.stop(name, signal.SIGTERM)
            slowest[0] = max(slowest[0], time.monotonic() - begin)
            cluster.start(name)
            cluster.await_health(NAMES)
        over.set()
        thread.join()
        counts = pictures.end()
    return counts[1] == 0 and slowest[0] < 25 and max(gaps) < 5, (
        f"three servers restarted, each ended within {slowest[0]:.1f} s; {counts[1]} of {counts[0]} pictures failed; "
        f"the view was opened {len(gaps)} times, with a frame after {max(gaps):.2f} s at most")


def nginx(arguments):
    with tempfile.TemporaryDirectory() as folder:
        port, behind = free_port(), free_port()
        with open(DEPLOY + "/nginx/nginx.conf") as file:
            text = file.read().replace("listen 7600;", f"listen 127.0.0.1:{port};").replace(":7601", f":{behind}")
        with open(folder + "/nginx.conf", "w") as file:
            file.write(f"pid {folder}/pid;\nerror_log stderr;\ndaemon off;\n" + text)
        model = os.path.splitext(os.path.basename(arguments.model))[0]
        server = subprocess.Popen(
            [arguments.programs + "/surfcastd", "serve", arguments.model, "--listen", f"127.0.0.1:{behind}",
             "--trusted-proxy", "127.0.0.1", "--max-connections-per-client", "2"],
            stdout=subprocess.PIPE, stderr=subprocess.DEVNULL)
        server.stdout.readline()
        proxy = subprocess.Popen(["nginx", "-c", folder + "/nginx.conf"])

        def status(client):
            try:
                with socket.create_connection(("127.0.0.1", port), 30, (client, 0)) as connection:
                    connection.sendall(b"GET /api/models HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n\r\n")
                    return int(connection.recv(4096)[9:12] or 0)
            except OSError:
                return 0

        try:
            while status("127.0.0.1") != 200:
                time.sleep(0.05)
            client = [arguments.programs + "/surfcast", "render", "--resolution", "96,64", "--output",
                      folder + "/picture.png"]
            failed = sum(subprocess.run([*client, f"{scheme}127.0.0.1:{port}/{model}"]).returncode != 0
                         for scheme in ("", "ws://"))
            held = [wire.Session(socket.create_connection(("127.0.0.1", port), 30, ("127.0.0.2", 0)))
                    for _ in range(2)]
            same, other = status("127.0.0.2"), status("127.0.0.3")
            for session in held:
                session.connection.close()
        finally:
            for process in (proxy, server):
                process.terminate()
                process.wait()
    return failed == 0 and same == 503 and other == 200, (
        f"{failed} of 2 pictures failed; a client with two connections got {same}, another client {other}")


FIGURES = [affinity, change, kill, hot, restart, nginx]


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("programs")
    parser.add_argument("model")
    parser.add_argument("--only", nargs="*", default=[figure.__name__ for figure in FIGURES])
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
