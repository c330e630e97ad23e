#!/usr/bin/env python3
"""passed_tests.py BUILD select | record RESULTS: which tests have passed with the same inputs before.

`select` prints the names of these tests, separated by |, and writes the keys of all tests into BUILD/test_keys.json.
`record` reads the results of ctest (JUnit), and notes the keys of the tests that have passed. Notes are empty files in
$SURFCAST_PASSED_TESTS, by default ~/.cache/surfcast/passed-tests; all checkouts share them. Those that were not used for
thirty days are removed.

The key of a test is a hash of the contents of all files that its programs are made of, of its scripts and data, of its
command, of the files of CMake, of the versions of all packages of the system, of the processor and of the graphics
devices, and of the variables that change what tests do. A test of which no program is known has no key and always runs:
it reads sources as it likes. So does one whose files have changed since the build.
"""

import argparse
import functools
import hashlib
import json
import os
import pathlib
import re
import shutil
import sys
import time
import xml.etree.ElementTree

import affected_tests
from affected_tests import ROOT

# Files that no test is known to see count as seen by all, but for these.
SEEN_BY_NONE = re.compile(r"^(bench|deploy|docker|\.ci)/|^cmake/.*\.(py|sh)$|^[^/]+\.md$|^(LICENSE|Makefile|\.[^/]+)$")
# Variables that do not change what a test does.
HARMLESS = {"SURFCAST_CHECK_BASE", "SURFCAST_NEW_TESTS", "SURFCAST_PASSED_TESTS", "SURFCAST_UNSTABLE_TESTS"}
DAYS_KEPT = 30


def notes_folder():
    return pathlib.Path(os.environ.get("SURFCAST_PASSED_TESTS") or pathlib.Path.home() / ".cache/surfcast/passed-tests")


def machine():
    """What a result depends on outside the checkout; None if this system does not tell the versions of its packages."""
    if shutil.which("dpkg-query") is None:
        return None
    packages = affected_tests.output_of("dpkg-query", "--show")
    processor = re.findall("^(?:model name|flags).*", pathlib.Path("/proc/cpuinfo").read_text(), re.MULTILINE)[:2]
    devices = sorted(str(path) for pattern in ("dri/*", "nvidia*") for path in pathlib.Path("/dev").glob(pattern))
    variables = sorted(f"{name}={value}" for name, value in os.environ.items()
                       if name.startswith("SURFCAST_") and name not in HARMLESS)
    return [packages, *processor, str(os.cpu_count()), *devices, *variables]


@functools.cache
def content_of(path):
    """A hash of a file of the checkout, and when it was changed; nothing for what is no file."""
    file = ROOT / path
    if not file.is_file():
        return "", 0
    return hashlib.sha256(file.read_bytes()).hexdigest(), file.stat().st_mtime


class Keys:
    def __init__(self, build):
        self.inside = os.path.relpath(build, ROOT) + "/"
        self.graph = affected_tests.BuildGraph(build)
        self.tests = affected_tests.read_tests(self.graph)
        self.tracked = affected_tests.output_of("git", "ls-files").splitlines()
        self.machine = machine()
        self.built = (build / ".ninja_log").stat().st_mtime
        self.seen = {test.name: self.files_of(test) for test in self.tests}
        seen = set().union(*self.seen.values())
        self.common = {path for path in self.tracked if path not in seen and not SEEN_BY_NONE.match(path)}

    def files_of(self, test):
        made_of = self.graph.made_of(test.seen)
        beside = {path for path in self.tracked if test.is_beside(path)}
        return {path for path in made_of if not path.startswith(("..", self.inside))} | beside

    def key(self, test):
        """None if what the test sees is not known, or not built."""
        if self.machine is None or not any(path.startswith(self.inside + "bin/") for path in test.seen):
            return None
        files = sorted(self.seen[test.name] | self.common)
        if any(content_of(path)[1] > self.built for path in files):
            return None
        lines = [test.name, self.inside, *(word.replace(str(ROOT), "") for word in test.command), *self.machine]
        lines += [f"{path} {content_of(path)[0]}" for path in files]
        return hashlib.sha256("\n".join(lines).encode()).hexdigest()


def select(build):
    keys = Keys(build)
    known = {test.name: key for test in keys.tests if (key := keys.key(test))}
    (build / "test_keys.json").write_text(json.dumps(known))
    passed = [name for name, key in known.items() if (notes_folder() / key).exists()]
    for name in passed:
        (notes_folder() / known[name]).touch()
    print("|".join(sorted(passed)))


def passed_names(results):
    """The tests that ran, and did not fail."""
    return [case.get("name") for case in xml.etree.ElementTree.parse(results).iter("testcase")
            if case.get("status") == "run" and case.find("failure") is None and case.find("skipped") is None]


def record(build, results):
    keys = json.loads((build / "test_keys.json").read_text())
    notes = notes_folder()
    notes.mkdir(parents=True, exist_ok=True)
    for name in passed_names(results):
        if name in keys:
            (notes / keys[name]).touch()
    for note in notes.iterdir():
        if note.stat().st_mtime < time.time() - DAYS_KEPT * 86400:
            note.unlink(missing_ok=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("build", type=pathlib.Path)
    parser.add_argument("action", choices=["select", "record"])
    parser.add_argument("results", type=pathlib.Path, nargs="?")
    arguments = parser.parse_args()
    build = arguments.build.resolve()
    if arguments.action == "record" and arguments.results is None:
        parser.error("record needs the results of ctest")
    try:
        if arguments.action == "select":
            select(build)
        else:
            record(build, arguments.results)
    except OSError as error:
        return f"passed_tests.py: {error}"
    return 0


if __name__ == "__main__":
    sys.exit(main())
