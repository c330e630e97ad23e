"""Connections that are encrypted, need a token, or go through a WebSocket; scans that are being built."""

from __future__ import annotations

import itertools
import subprocess
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from sample_models import SURFCASTD, Scan, write_las

import surfcast
from surfcast import aio
from surfcast.testing import RunningServer, server

SIZE = (64, 48)


def test_a_websocket_carries_the_same(running: RunningServer, field: surfcast.Model) -> None:
    with surfcast.connect(f"ws://{running.address}") as client:
        assert client["field"].render(resolution=SIZE).data == field.render(resolution=SIZE).data


def test_the_client_speaks_the_protocol_of_its_build(client: surfcast.Server) -> None:
    from surfcast._build import PROTOCOL

    assert client.protocol == PROTOCOL
    assert client.version.startswith("surfcastd ")
    assert client.ping() > 0


def make_certificate(folder: Path) -> Path:
    command = ["openssl", "req", "-x509", "-newkey", "ec", "-pkeyopt", "ec_paramgen_curve:prime256v1", "-nodes"]
    command += ["-keyout", f"{folder}/privkey.pem", "-out", f"{folder}/fullchain.pem", "-days", "2"]
    command += ["-subj", "/CN=localhost", "-addext", "subjectAltName=IP:127.0.0.1"]
    subprocess.run(command, check=True, capture_output=True)
    return folder / "fullchain.pem"


def test_a_server_with_a_certificate_and_tokens(tmp_path: Path, models: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path / "config"))
    ca = make_certificate(tmp_path)
    tokens = tmp_path / "tokens.json"
    add = [SURFCASTD, "token", "add", "alice", "--tokens", str(tokens), "--models", "fi*"]
    secret = subprocess.run(add, check=True, capture_output=True, text=True).stdout.split()[-1]
    with server(models, arguments=["--tls-certificate", str(tmp_path), "--tokens", str(tokens)]) as running:
        assert running.address.startswith("tcps://")
        with pytest.raises(surfcast.ConnectionLost, match="certificate"):
            running.connect(token=secret)
        with running.connect(ca=str(ca), token=secret) as client:
            assert client.models() == ["field"]
            assert client["field"].render(resolution=SIZE).converged
        with pytest.raises(surfcast.Denied):
            running.connect(ca=str(ca), token="wrong")
        with running.connect(ca=str(ca), token="") as client, pytest.raises(surfcast.Denied):
            client.models()
        monkeypatch.setenv("SURFCAST_TOKEN", secret)
        monkeypatch.setenv("SURFCAST_CA", str(ca))
        with surfcast.connect(running.address.replace("tcps", "wss")) as client:
            assert client.models() == ["field"]


def test_a_scan_is_sent_and_built(tmp_path: Path, models: Path, scan: Scan) -> None:
    write_las(scan, tmp_path / "sent.las")
    (tmp_path / "notes.doc").write_text("no scan")
    taken = tmp_path / "taken"
    taken.mkdir()
    with server(models, arguments=["--uploads", str(taken)]) as running, running.connect() as client:
        uploads = client.uploads()
        assert uploads is not None and ".las" in uploads.extensions and uploads.max_bytes > 0
        model = client.upload(tmp_path / "sent.las", "other name.las")
        assert model is not None and model.name == "other name"
        model.wait_complete()
        assert model.surfels == len(scan.xyz)
        with pytest.raises(surfcast.Unsupported):
            client.upload(tmp_path / "notes.doc")
        with pytest.raises(surfcast.InvalidInput):
            client.upload(tmp_path / "sent.las", "other name.las")


def test_annotations_are_kept_beside_the_model(tmp_path: Path, models: Path) -> None:
    gate = surfcast.SavedView("Gate", {"position": "1,2,3", "focal_point": "0,0,0"})
    crack = surfcast.Annotation("A crack", np.array((1.5, -2.0, 300.0)), gate.parameters)
    with server(models, arguments=["--annotations", str(tmp_path)]) as running, running.connect() as client:
        field = client["field"]
        before = field.annotations()
        assert before.writable and before.views == () and before.annotations == ()
        after = field.write_annotations(replace(before, views=(gate,), annotations=(crack,)))
        assert after.views == (gate,) and after.edition != before.edition
        (read,) = field.annotations().annotations
        assert read.text == crack.text and read.parameters == crack.parameters
        np.testing.assert_array_equal(read.position, crack.position)
        with pytest.raises(surfcast.Unavailable, match="changed"):
            field.write_annotations(before)
        with pytest.raises(surfcast.InvalidInput, match="view 1"):
            field.write_annotations(surfcast.Annotations(views=(surfcast.SavedView("", {}),)))
        assert [path.name for path in tmp_path.iterdir()] == ["field.json"]


def test_a_server_that_keeps_no_annotations_says_so(field: surfcast.Model) -> None:
    with pytest.raises(surfcast.Unsupported, match="--annotations"):
        field.annotations()


def test_a_server_that_takes_no_scans_says_so(tmp_path: Path, client: surfcast.Server, scan: Scan) -> None:
    write_las(scan, tmp_path / "sent.las")
    assert client.uploads() is None
    with pytest.raises(surfcast.Unsupported):
        client.upload(tmp_path / "sent.las")


def test_a_scan_is_waited_for(tmp_path: Path, scan: Scan) -> None:
    write_las(scan, tmp_path / "later.las")
    (tmp_path / "broken.las").write_bytes(b"LASF" + bytes(300))
    with server([tmp_path / "later.las", tmp_path / "broken.las"]) as running, running.connect() as client:
        later = client["later"]
        later.wait_complete()
        assert later.surfels == len(scan.xyz)
        assert not later.render(resolution=SIZE).preview
        with pytest.raises(surfcast.ServerFault, match="broken"):
            client["broken"].wait_complete()
        (failed,) = client.scans()
        assert failed.model == "broken" and failed.state == "failed" and failed.problem


def test_a_build_may_take_longer_than_an_answer(running: RunningServer, monkeypatch: pytest.MonkeyPatch) -> None:
    building = surfcast.Scan("field", "building", 0.5, None, "", False)
    states = iter([building] * 3)

    async def state(_: aio.Model) -> surfcast.Scan | None:
        return next(states, None)

    monkeypatch.setattr(aio.Model, "_scan", state)
    with running.connect(timeout=0.4) as client:
        client["field"].wait_complete()  # three pauses of 0.2 s
        states = itertools.repeat(building)
        with pytest.raises(surfcast.Timeout, match="wait_complete"):
            client["field"].wait_complete(timeout=0.1)
