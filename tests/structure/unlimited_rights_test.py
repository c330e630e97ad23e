#!/usr/bin/env python3
"""unlimited_rights_test.py SOURCE: only these sources give somebody the right to every model.

A handler of requests that did it would pass the gate without a token. Prints every source that is not listed, and every
listed one that no longer does it.
"""

import pathlib
import sys

# Where no tokens are wanted, and programs that whoever runs them points at files of their own.
ALLOWED = {"cmd/pick.cpp", "cmd/render.cpp", "serve/net/gatekeeper.cpp"}


def main():
    server = pathlib.Path(sys.argv[1]) / "server"
    found = {
        str(path.relative_to(server))
        for path in [*server.rglob("*.h"), *server.rglob("*.cpp")]
        if "Rights::unlimited()" in path.read_text()
    }
    for path in sorted(found ^ ALLOWED):
        print(f"server/{path}: {'is not listed' if path in found else 'does not call it'}")
    return 1 if found != ALLOWED else 0


if __name__ == "__main__":
    sys.exit(main())
