#!/bin/sh
# version_test.sh SOURCE VERSION: VERSION is the newest one of the changelog, and no file but CMakeLists.txt states it.
set -eu
cd "$1"
version=$2

fail() {
  echo "$*" >&2
  exit 1
}

newest=$(sed -n 's/^## //p' CHANGELOG.md | head -n 1)
[ "$newest" = "$version" ] || fail "CHANGELOG.md begins with version $newest, and CMakeLists.txt states $version"

# npm's lock file and test data state versions of other things.
pattern="(^|[^0-9.])$(echo "$version" | sed 's/\./\\./g')([^0-9.]|\$)"
found=$(grep --recursive --line-number --binary-files=without-match --extended-regexp \
  --exclude-dir=node_modules --exclude-dir=generated --exclude-dir=__pycache__ --exclude-dir=data \
  --exclude=package-lock.json "$pattern" Makefile CMakePresets.json README.md CONTRIBUTING.md \
  bench client cmake deploy docker docs protocol server shaders tests || true)
[ -z "$found" ] || fail "these lines state the version $version; let CMake put it there:
$found"

# The viewer is no package of npm and needs no version.
grep --quiet '"private": true' client/web/package.json || fail "the viewer's package.json is not private"
if grep --quiet '^  "version"' client/web/package.json; then
  fail "the viewer's package.json states a version of its own"
fi
