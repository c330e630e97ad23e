#!/usr/bin/env python3
"""compile_commands.py BUILD [--output FILE]: the compile command of each source of a build folder, for editors and tools.

CMake's own compile_commands.json lists files that include several sources (surfcast_join_sources). Here each source has
an entry, without the precompiled headers, which only GCC reads.
"""

import argparse
import json
import os
import pathlib
import re

JOINED_FILE = re.compile(r"_joined/part_\d+\.cpp$")
JOINED = re.compile(r'#include "(.*\.cpp)"')


def without_precompiled_headers(command):
    command = re.sub(r"-include \S*cmake_pch\.hxx ?", "", command)
    return re.sub(r"-(Winvalid-pch|fpch-preprocess) ?", "", command)


def separate_entries(build):
    """One entry for each source, in the order of CMake's; the object of joined sources is that of all of them."""
    for entry in json.loads((build / "compile_commands.json").read_text()):
        if "cmake_pch" in entry["file"]:
            continue
        entry["command"] = without_precompiled_headers(entry["command"])
        if not JOINED_FILE.search(entry["file"]):
            yield entry
            continue
        for member in JOINED.findall(pathlib.Path(entry["file"]).read_text()):
            source = os.path.normpath(os.path.join(os.path.dirname(entry["file"]), member))
            yield {**entry, "file": source, "command": entry["command"].replace(f"-c {entry['file']}", f"-c {source}")}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("build", type=pathlib.Path)
    parser.add_argument("--output", type=pathlib.Path, default=pathlib.Path("compile_commands.json"))
    arguments = parser.parse_args()
    text = json.dumps(list(separate_entries(arguments.build)), indent=1) + "\n"
    if not arguments.output.exists() or arguments.output.read_text() != text:
        arguments.output.write_text(text)


if __name__ == "__main__":
    main()
