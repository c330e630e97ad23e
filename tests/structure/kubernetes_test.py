#!/usr/bin/python3
"""kubernetes_test.py FOLDER: the manifests are YAML, their patches fit, and what they say of each other is true."""

import sys
from pathlib import Path
from typing import Any

import yaml

Objects = dict[tuple[str, str], Any]


def read(path: Path) -> Any:
    return yaml.safe_load(path.read_text(encoding="utf-8"))


def keys_of(pointer: str) -> list[str]:
    return [part.replace("~1", "/").replace("~0", "~") for part in pointer.split("/")[1:]]


def key_within(parent: Any, key: str) -> Any:
    return int(key) if isinstance(parent, list) and key != "-" else key


def patch(document: Any, operation: dict[str, Any]) -> None:
    """An operation of a JSON patch (RFC 6902)."""
    *path, last = keys_of(operation["path"])
    parent = document
    for key in path:
        parent = parent[key_within(parent, key)]
    if isinstance(parent, list) and last == "-":
        parent.append(operation["value"])
        return
    key = key_within(parent, last)
    if operation["op"] != "add":
        parent[key]  # what is replaced or removed has to be there
    if operation["op"] == "remove":
        del parent[key]
    else:
        parent[key] = operation["value"]


def build(folder: Path, objects: Objects) -> Objects:
    """What kustomize makes of a folder, added to the objects."""
    kustomization = read(folder / "kustomization.yaml")
    for name in kustomization.get("resources", []):
        path = folder / name
        if path.is_dir():
            build(path, objects)
            continue
        resource = read(path)
        objects[resource["kind"], resource["metadata"]["name"]] = resource
    for entry in kustomization.get("patches", []):
        target = objects[entry["target"]["kind"], entry["target"]["name"]]
        for operation in yaml.safe_load(entry["patch"]):
            patch(target, operation)
    return objects


def test_base(folder: Path) -> None:
    objects = build(folder / "base", {})
    assert objects["NetworkPolicy", "surfcast"]["spec"]["egress"] == []
    labels = objects["Deployment", "surfcast"]["spec"]["template"]["metadata"]["labels"]
    assert objects["Service", "surfcast"]["spec"]["selector"].items() <= labels.items()
    assert build(folder / "gpu", {}).keys() == objects.keys()


def test_components(folder: Path) -> None:
    for first in ("base", "gpu"):
        objects = build(folder / first, {})
        build(folder / "stores", objects)
        build(folder / "autoscale", objects)
        rules = objects["NetworkPolicy", "surfcast"]["spec"]["egress"]
        assert {port["port"] for rule in rules for port in rule["ports"]} == {53, 443}
        deployment = objects["Deployment", "surfcast"]
        assert "replicas" not in deployment["spec"], "the autoscaler would be overruled"
        scaled = objects["HorizontalPodAutoscaler", "surfcast"]["spec"]["scaleTargetRef"]
        assert (deployment["apiVersion"], deployment["kind"]) == (scaled["apiVersion"], scaled["kind"])
        container = deployment["spec"]["template"]["spec"]["containers"][0]
        assert "cpu" in container["resources"]["requests"], "shares of it are what the autoscaler goes by"


test_base(Path(sys.argv[1]))
test_components(Path(sys.argv[1]))
