#!/usr/bin/env python3
"""tidy.py BUILD [--minutes M] [--others M] [--base REVISION] [--seed TEXT]: clang-tidy over a build folder's sources.

Results are cached by content: a file without a finding is not checked again until something changes that its result
depends on: its own text, any header it includes, its compiler flags, .clang-tidy, or clang-tidy itself. The cache is
SURFCAST_TIDY_CACHE, or surfcast-tidy beside the user's other caches. The build must have been made: Ninja knows then
which headers a file includes.

With --minutes, no further file is begun after that time. What differs from --base, by default the last commits, is
checked first; the rest follows in an order that --seed decides, so that runs with other seeds check other files. With
--others, none of the rest is begun after that shorter time. A finding fails the run, a file that was not reached does
not.

--folders limits the check to some folders, separated by |. The gate leaves tests and benchmarks out: the macros of the
test framework make them take five times as long.
"""

import argparse
import concurrent.futures
import hashlib
import json
import os
import pathlib
import re
import subprocess
import sys
import time

from compile_commands import separate_entries

ROOT = pathlib.Path(__file__).resolve().parent.parent
RECENT_COMMITS = 30


def output_of(*command):
    return subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False).stdout


def read_entries(build, folders):
    """The sources to check: file relative to the root, compile command, object file; and a database without others."""
    entries = {}
    checked = re.compile(rf"({folders})/.*\.cpp$")
    for entry in separate_entries(build):
        file = os.path.relpath(entry["file"], ROOT)
        if not checked.match(file):
            continue
        entries.setdefault(file, entry)
    folder = build / "tidy"
    folder.mkdir(exist_ok=True)
    (folder / "compile_commands.json").write_text(json.dumps(list(entries.values())))
    return entries, folder


def read_headers(build):
    """The files that each object was made of, by its path in the build folder."""
    headers, current = {}, None
    for line in output_of("ninja", "-C", str(build), "-t", "deps").splitlines():
        if line.startswith("    "):
            current.append(line.strip())
        elif ": #deps" in line:
            current = headers.setdefault(line.split(": #deps")[0], [])
    return headers


class Fingerprints:
    """What stands for a file: its content; of the system's headers, which come in packages, size and time."""

    def __init__(self, build):
        self.build = build
        self.known = {}

    def of(self, name):
        path = os.path.normpath(os.path.join(self.build, name))
        if path not in self.known:
            self.known[path] = self.read(path)
        return self.known[path]

    @staticmethod
    def read(path):
        try:
            if path.startswith(str(ROOT)):
                content = hashlib.sha256(pathlib.Path(path).read_bytes()).hexdigest()
                return f"{os.path.relpath(path, ROOT)} {content}"
            status = os.stat(path)
            return f"{path} {status.st_size} {int(status.st_mtime)}"
        except OSError:
            return f"{path} missing"


def key_of(entry, tool, headers, fingerprints):
    """None where Ninja does not know what the file includes."""
    command = entry["command"]
    made_of = headers.get(re.search(r" -o (\S+)", command).group(1))
    if made_of is None:
        return None
    parts = [tool, command.replace(str(ROOT), "."), fingerprints.of(entry["file"])]
    parts += sorted(fingerprints.of(name) for name in made_of if "cmake_pch" not in name and not joined(name))
    return hashlib.sha256("\n".join(parts).encode()).hexdigest()


def joined(name):
    """Another source of those that were joined."""
    return name.endswith((".cpp", ".cxx"))


def changed_since(base):
    return set(output_of("git", "diff", "--name-only", base or f"HEAD~{RECENT_COMMITS}").splitlines())


def order_of(files, changed, seed):
    return sorted(files, key=lambda file: (file not in changed, hashlib.sha256((seed + file).encode()).digest()))


def check(file, database, deadline):
    """Findings; none where all is well; None where the time is over."""
    if time.monotonic() > deadline:
        return None
    command = ["clang-tidy", "-quiet", "-p", str(database)]
    result = subprocess.run([*command, str(ROOT / file)], capture_output=True, text=True, check=False)
    return "" if result.returncode == 0 else result.stdout + result.stderr


def parse_arguments():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("build", type=pathlib.Path)
    parser.add_argument("--minutes", type=float, default=float("inf"))
    parser.add_argument("--others", type=float, default=float("inf"))
    parser.add_argument("--base", default="")
    parser.add_argument("--seed", default="")
    parser.add_argument("--folders", default="server|client|protocol|tests|bench")
    return parser.parse_args()


def main():
    arguments = parse_arguments()
    build = arguments.build.resolve()
    default_cache = pathlib.Path(os.environ.get("XDG_CACHE_HOME", pathlib.Path.home() / ".cache")) / "surfcast-tidy"
    cache = pathlib.Path(os.environ.get("SURFCAST_TIDY_CACHE", default_cache))
    cache.mkdir(parents=True, exist_ok=True)

    entries, database = read_entries(build, arguments.folders)
    version = output_of("clang-tidy", "--version")
    tool = version + (ROOT / ".clang-tidy").read_text() + pathlib.Path(__file__).read_text()
    headers, fingerprints = read_headers(build), Fingerprints(build)
    keys = {file: key_of(entry, tool, headers, fingerprints) for file, entry in entries.items()}
    wanted = [file for file, key in keys.items() if key is None or not (cache / key).exists()]

    begin = time.monotonic()
    changed = changed_since(arguments.base)
    order = order_of(wanted, changed, arguments.seed)

    def check_in_time(file):
        minutes = arguments.minutes if file in changed else min(arguments.minutes, arguments.others)
        return check(file, database, begin + 60 * minutes)

    checked = failed = 0
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        for file, findings in zip(order, pool.map(check_in_time, order)):
            if findings is None:
                continue
            checked += 1
            if findings:
                failed += 1
                print(f"{file}:\n{findings}", flush=True)
            elif keys[file]:
                (cache / keys[file]).touch()
    left = len(wanted) - checked
    print(f"clang-tidy: {len(entries)} files, {len(entries) - len(wanted)} known to be clean, {checked} checked, "
          f"{failed} with findings, {left} left for want of time")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
