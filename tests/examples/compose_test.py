"""The example of docker compose: what it states of image, server and proxy is so, and the proxy serves all clients."""

from __future__ import annotations

import io
import json
import os
import re
import shutil
import socket
import ssl
import subprocess
import urllib.error
import urllib.request
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml
from PIL import Image

import surfcast
from surfcast.testing import server

SURFCASTD = os.environ["SURFCASTD"]


@pytest.fixture(scope="module")
def compose(examples: Path) -> dict[str, Any]:
    document: dict[str, Any] = yaml.safe_load((examples / "compose/compose.yaml").read_text(encoding="utf-8"))
    return document


@pytest.fixture(scope="module")
def configuration(examples: Path) -> str:
    return (examples / "compose/nginx.conf").read_text(encoding="utf-8")


def mounts(service: dict[str, Any]) -> dict[str, str]:
    """The source of each place in the container."""
    return {volume.split(":")[1]: volume.split(":")[0] for volume in service["volumes"]}


def lies_in(path: str, folders: dict[str, str]) -> bool:
    return any(path == folder or path.startswith(folder + "/") for folder in folders)


def test_the_server_has_what_its_settings_and_its_image_name(
    compose: dict[str, Any], configuration: str, examples: Path
) -> None:
    surfcast_service = compose["services"]["surfcast"]
    dockerfile = (examples.parents[1] / "docker/Dockerfile").read_text(encoding="utf-8")
    help_text = subprocess.run([SURFCASTD, "serve", "--help"], capture_output=True, text=True, check=True).stdout
    known = set(re.findall(r"\(Env:(\w+)\)", help_text))
    assert surfcast_service["environment"].keys() <= known
    folders = mounts(surfcast_service)
    assert lies_in(surfcast_service["environment"]["SURFCAST_TOKENS"], folders)
    assert '"/models"]' in dockerfile and "/models" in folders
    assert "SURFCAST_CACHE=/var/cache/surfcast" in dockerfile and folders["/var/cache/surfcast"] in compose["volumes"]
    assert f"docker build -f docker/Dockerfile -t {surfcast_service['image']} ." in dockerfile
    assert "HEALTHCHECK" in dockerfile, "the proxy waits for it"
    port = re.search(r"^EXPOSE (\d+)$", dockerfile, re.MULTILINE)
    assert port is not None and f"proxy_pass http://surfcast:{port.group(1)};" in configuration
    assert "ports" not in surfcast_service, "only the proxy reaches it"


def test_the_proxy_has_the_files_and_ports_that_its_configuration_names(
    compose: dict[str, Any], configuration: str, examples: Path
) -> None:
    proxy = compose["services"]["proxy"]
    assert proxy["depends_on"].keys() <= compose["services"].keys()
    assert {port.split(":")[1] for port in proxy["ports"]} == set(re.findall(r"listen (\d+)", configuration))
    folders = mounts(proxy)
    for path in re.findall(r"(?:ssl_certificate|ssl_certificate_key|root) (\S+);", configuration):
        assert lies_in(path, folders), path
    assert (examples / "compose" / folders["/etc/nginx/nginx.conf"]).exists()
    assert (examples / "compose" / folders["/pages"] / "tour.html").exists()


def free_port() -> int:
    with socket.socket() as listener:
        listener.bind(("127.0.0.1", 0))
        port: int = listener.getsockname()[1]
        return port


def replaced(text: str, changes: dict[str, str]) -> str:
    for before, after in changes.items():
        assert before in text, before
        text = text.replace(before, after)
    return text


def make_certificate(folder: Path) -> Path:
    """A key and a certificate of 127.0.0.1, which clients trust as its own authority."""
    certificate = folder / "fullchain.pem"
    command = ["openssl", "req", "-x509", "-newkey", "ec", "-pkeyopt", "ec_paramgen_curve:P-256", "-nodes"]
    command += ["-keyout", str(folder / "privkey.pem"), "-out", str(certificate), "-days", "2"]
    command += ["-subj", "/CN=surfcast test", "-addext", "subjectAltName=IP:127.0.0.1"]
    subprocess.run(command, check=True, capture_output=True)
    return certificate


@contextmanager
def nginx(configuration: str, folder: Path, port: int) -> Iterator[None]:
    """nginx with the configuration, until the end of the block. It listens once it is entered."""
    program = shutil.which("nginx", path=os.environ["PATH"] + ":/usr/sbin")
    assert program is not None, "nginx is one of the packages of the tests"
    # As one process, it needs no other user, who would have to read the folder of the test.
    head = f"daemon off; master_process off; pid {folder}/pid; error_log stderr;"
    temporary = " ".join(f"{name}_temp_path {folder}/{name};" for name in ("fastcgi", "uwsgi", "scgi", "proxy"))
    within = f"http {{ access_log off; client_body_temp_path {folder}/body; {temporary}"
    path = folder / "nginx.conf"
    path.write_text(f"{head}\n{replaced(configuration, {'http {': within})}", encoding="utf-8")
    command = [program, "-c", str(path), "-e", "stderr"]
    checked = subprocess.run([*command, "-t"], capture_output=True, text=True)
    assert checked.returncode == 0, checked.stderr
    process = subprocess.Popen(command)
    try:
        while process.poll() is None:
            try:
                socket.create_connection(("127.0.0.1", port)).close()
                break
            except ConnectionRefusedError:
                continue
        assert process.poll() is None
        yield
    finally:
        process.terminate()
        process.wait()


class NoRedirect(urllib.request.HTTPRedirectHandler):
    def redirect_request(self, *_: Any) -> None:
        return None


def test_the_proxy_serves_pages_pictures_and_websockets_to_those_with_a_token(
    examples: Path, configuration: str, lion: Path, tmp_path: Path
) -> None:
    certificate = make_certificate(tmp_path)
    plain, secure, behind = free_port(), free_port(), free_port()
    changed = replaced(
        configuration,
        {
            "listen 80;": f"listen 127.0.0.1:{plain};",
            "listen 443 ssl;": f"listen 127.0.0.1:{secure} ssl;",
            "surfcast:7600": f"127.0.0.1:{behind}",
            " /cert/": f" {tmp_path}/",
            " /pages;": f" {examples / 'embedding'};",
        },
    )
    tokens = tmp_path / "tokens.json"
    command = [SURFCASTD, "token", "add", "alice", "--tokens", str(tokens), "--models", "lion"]
    token = subprocess.run(command, check=True, capture_output=True, text=True).stdout.strip()
    flags = ["--tokens", str(tokens), "--max-connections-per-client", "0", "--host", "scans.example.org"]
    trusting = ssl.create_default_context(cafile=str(certificate))
    opener = urllib.request.build_opener(urllib.request.HTTPSHandler(context=trusting), NoRedirect)

    def get(url: str, **headers: str) -> tuple[int, Any, bytes]:
        try:
            with opener.open(urllib.request.Request(url, headers=headers)) as answer:
                return answer.status, answer.headers, answer.read()
        except urllib.error.HTTPError as error:
            return error.code, error.headers, error.read()

    https = f"https://127.0.0.1:{secure}"
    bearer = {"Authorization": f"Bearer {token}"}
    with server(lion, listen=f"127.0.0.1:{behind}", arguments=flags), nginx(changed, tmp_path, secure):
        status, headers, _ = get(f"http://127.0.0.1:{plain}/api/models")
        assert (status, headers["Location"]) == (301, "https://127.0.0.1/api/models")
        assert get(f"{https}/api/models")[0] == 401
        assert get(f"{https}/api/models", Host="stranger.example", **bearer)[0] == 421
        status, _, models = get(f"{https}/api/models", Host="scans.example.org", **bearer)
        assert status == 200 and "lion" in json.dumps(json.loads(models))
        assert get(f"{https}/tour.html")[2] == (examples / "embedding/tour.html").read_bytes()
        status, _, picture = get(f"{https}/api/models/lion/image?resolution=96,64&format=png", **bearer)
        assert status == 200

        login = urllib.request.Request(f"{https}/api/login", data=f"token={token}".encode(), headers={"Origin": https})
        with pytest.raises(urllib.error.HTTPError) as redirected:
            opener.open(login)
        assert redirected.value.code == 303
        assert "Secure" in redirected.value.headers["Set-Cookie"], "the server knows that the client has TLS"

        address = f"wss://127.0.0.1:{secure}"
        with surfcast.connect(address, token=token, ca=str(certificate)) as client:
            drawn = client["lion"].render(resolution=(96, 64))
        np.testing.assert_array_equal(drawn.array, np.asarray(Image.open(io.BytesIO(picture)).convert("RGB")))
