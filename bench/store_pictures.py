#!/usr/bin/env python3
"""First pictures of a model over ranges against those of the file: store_pictures.py BIN MODEL [--rtt MS] [--mbit N]

BIN is the folder of the programs (surfcastd, link_relay). nginx serves the folder of MODEL behind a relay that adds the
round-trip time and bounds the rate of each connection. Prints for the file, the store, the store without what is read
between blocks, and the store with a filled block cache: seconds of the program, milliseconds that the picture waits for
blocks, blocks, requests and bytes.
"""
import argparse
import json
import os
import re
import socket
import statistics
import subprocess
import tempfile
import time

NGINX = """
daemon off; pid {folder}/pid; error_log {folder}/error.log; worker_processes 2;
events {{ worker_connections 256; }}
http {{
  log_format ranges '$status $body_bytes_sent';
  access_log {folder}/access.log ranges;
  client_body_temp_path {folder}; proxy_temp_path {folder}; fastcgi_temp_path {folder};
  uwsgi_temp_path {folder}; scgi_temp_path {folder};
  server {{ listen 127.0.0.1:{port}; root {root}; sendfile on; }}
}}
"""


def free_port():
    with socket.socket() as listener:
        listener.bind(("127.0.0.1", 0))
        return listener.getsockname()[1]


def wait_for(port):
    for _ in range(200):
        try:
            socket.create_connection(("127.0.0.1", port), timeout=1).close()
            return
        except OSError:
            time.sleep(0.05)
    raise SystemExit(f"nothing listens on port {port}")


def forget_pages(path):
    """The next read comes from the disk."""
    with open(path, "rb") as file:
        os.posix_fadvise(file.fileno(), 0, 0, os.POSIX_FADV_DONTNEED)


def taken(log):
    """Requests and bytes in nginx's log, which is emptied."""
    with open(log, encoding="utf-8") as file:
        sizes = [int(line.split()[1]) for line in file if re.match(r"20[06] ", line)]
    os.truncate(log, 0)
    return len(sizes), sum(sizes)


def draw(options, model, folder, *flags):
    stats = os.path.join(folder, "stats.json")
    command = [os.path.join(options.bin, "surfcastd"), "render", model, "--resolution", options.resolution, "--spacing",
               options.spacing, "--output", os.path.join(folder, "picture.png"), "--stats", stats, "--cache", folder,
               *flags]
    begin = time.monotonic()
    subprocess.run(command, check=True, stderr=subprocess.DEVNULL)
    seconds = time.monotonic() - begin
    with open(stats, encoding="utf-8") as file:
        return seconds, json.load(file)


class Way:
    """A way to the model, and what its runs took."""

    def __init__(self, name, model, *flags):
        self.name, self.model, self.flags = name, model, flags
        self.seconds, self.loading, self.requests, self.bytes = [], [], [], []

    def run(self, options, folder, log):
        forget_pages(options.model)
        seconds, stats = draw(options, self.model, folder, *self.flags)
        requests, sent = taken(log)
        self.seconds.append(seconds)
        self.loading.append(stats["milliseconds"]["load"])
        self.requests.append(requests)
        self.bytes.append(sent)
        self.blocks = stats["blocks_waited_for"]

    def text(self):
        middle = statistics.median
        return (f"{self.name:14} {middle(self.seconds):7.2f} s {middle(self.loading):7.0f} ms loading "
                f"{self.blocks:6} blocks {middle(self.requests):5.0f} requests {middle(self.bytes) / 1e6:8.2f} MB")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("bin")
    parser.add_argument("model")
    parser.add_argument("--rtt", default="20", help="milliseconds (default 20)")
    parser.add_argument("--mbit", default="1000", help="of each connection (default 1000)")
    parser.add_argument("--resolution", default="1280,720")
    parser.add_argument("--spacing", default="1")
    parser.add_argument("--runs", type=int, default=5)
    options = parser.parse_args()
    options.model = os.path.abspath(options.model)
    with tempfile.TemporaryDirectory() as folder:
        os.chmod(folder, 0o755)
        origin, link = free_port(), free_port()
        config = os.path.join(folder, "nginx.conf")
        with open(config, "w", encoding="utf-8") as file:
            file.write(NGINX.format(folder=folder, port=origin, root=os.path.dirname(options.model)))
        nginx = subprocess.Popen(["nginx", "-c", config])
        relay = subprocess.Popen([os.path.join(options.bin, "link_relay"), str(link), str(origin), options.mbit,
                                  options.rtt])
        try:
            wait_for(origin)
            wait_for(link)
            log = os.path.join(folder, "access.log")
            url = f"http://127.0.0.1:{link}/{os.path.basename(options.model)}"
            ways = [Way("file", options.model), Way("store", url),
                    Way("store, no gaps", url, "--store-gap", "0", "--store-waste", "0"),
                    Way("store, cached", url, "--block-cache", "10G")]
            draw(options, url, folder, *ways[-1].flags)
            taken(log)
            for _ in range(options.runs):  # in turns, as other work on the machine comes and goes
                for way in ways:
                    way.run(options, folder, log)
            for way in ways:
                print(way.text())
        finally:
            relay.terminate()
            nginx.terminate()
            relay.wait()
            nginx.wait()


main()
