#!/usr/bin/env python3
"""documented_headers_test.py SOURCE: headers that documents name as `module/header.h` are there.

Prints every name that is not, with its document.
"""

import pathlib
import re
import sys

FOLDERS = ("server", "client", "protocol", "shaders", "bench", "tests")


def headers(source):
    """The last two parts of the paths of all headers: "protocol/hello.h" of protocol/hello.h."""
    return {"/".join(path.parts[-2:]) for folder in FOLDERS for path in (source / folder).rglob("*.h")}


def documents(source):
    for folder in (*FOLDERS, "docs"):
        yield from (path for path in (source / folder).rglob("*.md") if "node_modules" not in path.parts)
    yield from source.glob("*.md")


def main():
    source = pathlib.Path(sys.argv[1])
    known = headers(source)
    missing = [
        f"{path.relative_to(source)}: {name}"
        for path in sorted(documents(source))
        for name in re.findall(r"`(?:server/)?(?:\w+/)*(\w+/\w+\.h)`", path.read_text())
        if name not in known
    ]
    print("\n".join(missing))
    return 1 if missing else 0


if __name__ == "__main__":
    sys.exit(main())
