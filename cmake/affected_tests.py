#!/usr/bin/env python3
"""affected_tests.py BUILD [--base REVISION] [--seconds S | --programs LABELS]: the tests that can see a change.

A change is what differs from REVISION (HEAD where nothing is committed yet, else the commit before it), files that git
does not know included. The build says what each program is made of: the statements of build.ninja, the headers that
Ninja noted when it compiled, and the files and folders whose paths are compiled in. A test sees its own program, the
programs that this one starts, and for scripts the files beside them.

Without further options it builds what these tests need and runs them: nearest first, and as many as the costs that
ctest has recorded allow within --seconds. The rest is named. With --programs it prints the affected test programs that
have one of these labels, separated by |, for a build with sanitizers.
"""

import argparse
import collections
import json
import os
import pathlib
import re
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent
# A change of these can change every program.
EVERYTHING = re.compile(r"^(CMakeLists\.txt|CMakePresets\.json|cmake/(?!.*\.(sh|py)$))")


def output_of(*command, cwd=ROOT):
    return subprocess.run(command, cwd=cwd, capture_output=True, text=True, check=True).stdout


def changed_files(base):
    unknown = output_of("git", "ls-files", "--others", "--exclude-standard").splitlines()
    if base is None:
        base = "HEAD" if unknown or output_of("git", "diff", "--name-only", "HEAD") else "HEAD~1"
    return base, output_of("git", "diff", "--name-only", base).splitlines() + unknown


class BuildGraph:
    """Which files each file of a build folder is made of."""

    def __init__(self, build):
        self.build = build
        self.inputs = collections.defaultdict(set)
        self.read_statements()
        self.read_headers()

    def name(self, path):
        """Relative to the root for files of the checkout, links of include folders resolved."""
        return os.path.relpath(os.path.realpath(self.build / path), ROOT)

    def read_statements(self):
        text = (self.build / "build.ninja").read_text().replace("$\n", "").replace("${cmake_ninja_workdir}", "")
        output = None
        for line in text.splitlines():
            if line.startswith("  DEFINES = "):
                self.inputs[output] |= self.files_named_in(line)
            if not line.startswith("build "):
                continue
            outputs, _, rest = line[len("build "):].partition(": ")
            rule, *inputs = re.split(r"(?<!\$) +", rest.strip())
            if rule.startswith("CXX_COMPILER") and "||" in inputs:
                # Only says what must exist before: generated headers, which Ninja notes when they are read.
                inputs = inputs[: inputs.index("||")]
            inputs = {self.name(path.replace("$ ", " ").replace("$:", ":")) for path in inputs if path not in ("|", "||")}
            for path in re.split(r"(?<!\$) +", outputs.strip()):
                if path != "|":
                    output = self.name(path.replace("$ ", " ").replace("$:", ":"))
                    self.inputs[output] |= inputs

    def files_named_in(self, definitions):
        """The files whose paths are compiled in, and those in such folders."""
        files = set()
        for path in re.findall(r'\\"(/[^"\\]+)\\"', definitions):
            files.add(self.name(path))
            files |= {self.name(os.path.join(folder, name)) for folder, _, names in os.walk(path) for name in names}
        return files

    def read_headers(self):
        current = None
        for line in output_of("ninja", "-t", "deps", cwd=self.build).splitlines():
            if line.startswith("    "):
                self.inputs[current].add(self.name(line.strip()))
            elif ": #deps" in line:
                current = self.name(line.split(": #deps")[0])

    def made_of(self, files):
        """The files themselves, and all that they are made of, directly or not."""
        found, left = set(files), list(files)
        while left:
            for path in self.inputs.get(left.pop(), ()):
                if path not in found:
                    found.add(path)
                    left.append(path)
        return found

    def distances(self, files):
        """How many steps each file that is made of one of `files` is away from it."""
        users = collections.defaultdict(list)
        for output, inputs in self.inputs.items():
            for path in inputs:
                users[path].append(output)
        distance = dict.fromkeys(files, 0)
        queue = collections.deque(files)
        while queue:
            path = queue.popleft()
            for user in users[path]:
                if user not in distance:
                    distance[user] = distance[path] + 1
                    queue.append(user)
        return distance


def script_folder(path):
    """Scripts that run tests see the files beside them; those in a folder of tests also those around it."""
    folder = os.path.dirname(path)
    return os.path.dirname(folder) if os.path.basename(folder) == "tests" else folder


class Test:
    def __init__(self, graph, number, entry):
        self.number = number  # by which ctest selects it
        self.name = entry["name"]
        properties = {p["name"]: p["value"] for p in entry.get("properties", [])}
        self.labels = "|".join(properties.get("LABELS", []))
        self.estimated_cost = float(properties.get("COST", 1))  # seconds
        self.command = entry.get("command", []) + properties.get("ENVIRONMENT", [])
        words = entry.get("command", []) + [word.partition("=")[2] for word in properties.get("ENVIRONMENT", [])]
        files = [graph.name(word) for word in words if os.path.isabs(word) and os.path.isfile(word)]
        own = [path for path in files if not path.startswith("..")]
        self.program = own[0] if own else ""
        self.seen = set(own)
        self.folders = {script_folder(path) + "/" for path in own if not path.startswith(graph.name("."))}

    def is_beside(self, path):
        """Whether a file lies where the test's scripts read files."""
        return any(path.startswith(folder) for folder in self.folders)

    def distance(self, distances, changed):
        found = [distances[path] for path in self.seen if path in distances]
        found += [1 for path in changed if self.is_beside(path)]
        return min(found, default=None)


def read_tests(graph):
    # From a folder of its own, because ctest empties the log of the last run in the folder where it lists tests.
    with tempfile.TemporaryDirectory() as folder:
        pathlib.Path(folder, "CTestTestfile.cmake").write_text(f'subdirs("{graph.build}")\n')
        listed = json.loads(output_of("ctest", "--test-dir", folder, "--show-only=json-v1"))
    return [Test(graph, number, entry) for number, entry in enumerate(listed["tests"], 1)]


def recorded_costs(build):
    """Seconds of each test, as ctest measured them; none for a test that has not run."""
    path = build / "Testing/Temporary/CTestCostData.txt"
    costs = {}
    for line in path.read_text().splitlines() if path.exists() else []:
        words = line.split()
        if len(words) == 3:
            costs[words[0]] = float(words[2])
    return costs


def affected(build, base):
    """(test, distance), nearest first, and whether the change can reach everything."""
    base, changed = changed_files(base)
    graph = BuildGraph(build)
    tests = read_tests(graph)
    everything = [path for path in changed if EVERYTHING.match(path)]
    print(f"{len(changed)} files differ from {base}" + (f", {everything[0]} can change everything" if everything else ""),
          file=sys.stderr)
    distances = graph.distances(changed)
    near_folders = {os.path.basename(os.path.dirname(path)) for path in changed}
    found = []
    for test in tests:
        distance = test.distance(distances, changed)
        if distance is None and not everything:
            continue
        own_module = any(f"/tests/{folder}/" in f"/{path}" for folder in near_folders
                         for path in graph.inputs.get(test.program, ()))
        found.append((not own_module, distance or 0, test))
    return [(test, distance) for _, distance, test in sorted(found, key=lambda row: row[:2])], tests


def run(build, base, seconds):
    chosen, left, spent = [], [], 0.0
    costs = recorded_costs(build)
    rows, tests = affected(build, base)
    for test, _ in rows:
        if "nightly" in test.labels:
            continue
        cost = costs.get(test.name, test.estimated_cost)
        fits = spent + cost <= seconds * os.cpu_count()
        (chosen if fits else left).append(test)
        spent += cost if fits else 0
    print(f"{len(rows)} of {len(tests)} tests can see the change, {len(chosen)} are run", file=sys.stderr)
    if left:
        print(f"left for `make test`: {', '.join(sorted({os.path.basename(test.program) for test in left}))}", file=sys.stderr)
    if not chosen:
        return 0
    # First, last and step of a range, and then single numbers.
    first, *others = [str(test.number) for test in chosen]
    numbers = build / "affected_tests.txt"
    numbers.write_text(",".join([first, first, "1", *others]) + "\n")
    return subprocess.run(["ctest", "--preset", "release", f"-j{os.cpu_count()}", "--tests-information", str(numbers)],
                          cwd=ROOT, check=False).returncode


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("build", type=pathlib.Path)
    parser.add_argument("--base")
    parser.add_argument("--seconds", type=float, default=60)
    parser.add_argument("--programs", metavar="LABELS")
    arguments = parser.parse_args()
    build = arguments.build.resolve()
    if arguments.programs is None:
        return run(build, arguments.base, arguments.seconds)
    wanted = set(arguments.programs.split("|"))
    rows, _ = affected(build, arguments.base)
    for program in sorted({os.path.basename(test.program) for test, _ in rows
                           if wanted & set(re.split("[-|]", test.labels))}):
        print(program)
    return 0


if __name__ == "__main__":
    sys.exit(main())
