#!/usr/bin/env python3
"""affected_tests_test.py SOURCE BUILD: files of every kind are seen by the tests that depend on them."""

import os
import pathlib
import sys

source, build = pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2])
sys.path.insert(0, str(source / "cmake"))
import affected_tests  # noqa: E402

# A file, and programs or scripts of tests that must see it, and some that cannot.
EXPECTED = [
    ("shaders/splat.comp", {"render_gl_test", "shader_validation_test", "serve_test"}, {"scan_test", "laz_test"}),
    ("shaders/shared/kernel.h", {"render_gl_test", "reference_test"}, {"laz_test"}),
    ("server/formats/scan/lzf.cpp", {"scan_test", "serve_test"}, {"laz_test"}),
    ("server/draw/picture/picture.h", {"render_gl_test", "net_test", "view_test"}, {"laz_test"}),
    ("protocol/surfcast.proto", {"protocol_test", "net_test", "client_test"}, {"laz_test"}),
    ("client/web/src/state/place.ts", {"run_tests.sh"}, {"scan_test"}),
    ("client/python/surfcast/camera_path.py", {"run_tests.sh"}, {"scan_test"}),
    ("tests/data/lion.drc", {"simplify_gl_test"}, {"base_test"}),
    ("docs/settings.md", {"cmd_test"}, {"scan_test"}),
]


def main():
    graph = affected_tests.BuildGraph(build)
    tests = affected_tests.read_tests(graph)
    programs = {os.path.basename(test.program) for test in tests}
    wrong = []
    for path, seen_by, not_seen_by in EXPECTED:
        if not (source / path).exists():
            wrong.append(f"there is no {path}")
            continue
        distances = graph.distances([path])
        seen = {os.path.basename(test.program) for test in tests if test.distance(distances, [path]) is not None}
        wrong += [f"{path} is not seen by {name}" for name in sorted((seen_by & programs) - seen)]
        wrong += [f"{path} is seen by {name}" for name in sorted(not_seen_by & seen)]
        wrong += [f"there is no test {name}" for name in sorted(seen_by - programs - {"run_tests.sh"})]
    script = source / "cmake/affected_tests.py"
    printed = affected_tests.output_of(script, build, "--base", "HEAD", "--programs", "no_such_label")
    if printed:  # not even an empty line, which would be a target
        wrong.append(f"{printed!r} are programs with a label that there is not")
    print("\n".join(wrong) or "as expected")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
