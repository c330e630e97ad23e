#!/usr/bin/env bash
# run_tests.sh PRESET BUILD ARGUMENTS...: runs the tests of a preset, with arguments of ctest, and notes those that pass
# with what they are made of. With SURFCAST_NEW_TESTS=1, tests that have passed with the same inputs before are left out.
set -euo pipefail
cd "$(dirname "$0")/.."
preset=$1
build=$2
shift 2

# How many tests ctest selects.
count() { ctest --preset "$preset" --show-only "$@" | sed -n 's/^Total Tests: //p'; }

results=$PWD/$build/test_results.xml
rm -f "$results" "$build/test_keys.json"
# What is known to have passed only saves time: without it all tests run.
passed=$(cmake/passed_tests.py "$build" select) || passed=
selection=("$@")
left_out=0
if [ "${SURFCAST_NEW_TESTS:-0}" = 1 ] && [ -n "$passed" ]; then
  selection+=(--exclude-regex "^($passed)\$")
  new=$(count "${selection[@]}")
  left_out=$(($(count "$@") - new))
  if [ "$new" = 0 ]; then
    echo "all $left_out tests have passed with the same inputs before"
    exit 0
  fi
fi
code=0
ctest --preset "$preset" --output-junit "$results" "${selection[@]}" || code=$?
[ ! -e "$results" ] || cmake/passed_tests.py "$build" record "$results" || echo "what has passed cannot be noted" >&2
[ "$left_out" = 0 ] || echo "$left_out more tests have passed with the same inputs before"
exit "$code"
