#!/usr/bin/env python3
"""groups_test.py SOURCE: no module of server/ includes one of a later group, and no modules include each other in a circle.

server/CMakeLists.txt has the order of the groups. Prints every arrow that is wrong.
"""

import graphlib
import pathlib
import re
import sys


def modules_of(server):
    """Module to (position of its group, folder). A group without folders is a module itself."""
    groups = re.findall(r"^add_subdirectory\((\w+)\)", (server / "CMakeLists.txt").read_text(), re.MULTILINE)
    found = {}
    for position, group in enumerate(groups):
        folders = [path for path in (server / group).iterdir() if (path / "CMakeLists.txt").exists()]
        found |= {folder.name: (position, folder) for folder in folders or [server / group]}
    return groups, found


def includes_of(folder):
    for path in sorted([*folder.rglob("*.h"), *folder.rglob("*.cpp")]):
        for module in re.findall(r'^#include "(\w+)/', path.read_text(), re.MULTILINE):
            yield path, module


def main():
    server = pathlib.Path(sys.argv[1]) / "server"
    groups, modules = modules_of(server)
    wrong = []
    seen = {}
    for module, (position, folder) in modules.items():
        seen[module] = set()
        for path, other in includes_of(folder):
            if other == module or other not in modules:
                continue
            seen[module].add(other)
            if modules[other][0] > position:
                wrong.append(f"{path.relative_to(server)} includes {groups[modules[other][0]]}/{other}")
    try:
        graphlib.TopologicalSorter(seen).prepare()
    except graphlib.CycleError as error:
        wrong.append("a circle: " + " <- ".join(error.args[1]))
    arrows = sum(len(others) for others in seen.values())
    print("\n".join(wrong) or f"{len(modules)} modules in {len(groups)} groups, {arrows} arrows, none of them wrong")
    return 1 if wrong or len(modules) < 30 else 0


sys.exit(main())
