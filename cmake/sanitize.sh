#!/usr/bin/env bash
# sanitize.sh PRESET TARGET LABELS [--nightly | --base REVISION]: builds TARGET with the sanitizers of PRESET and runs the
# tests whose labels match LABELS. --nightly: also those that run in `make nightly` alone. --base: only the programs that
# can see what differs from REVISION; the build of the preset `release` knows which these are.
set -euo pipefail
cd "$(dirname "$0")/.."
preset=$1
target=$2
labels=$3
shift 3

# The thread sanitizer of clang 14 fails on kernels that randomize more than 28 bits of addresses, so randomization is
# switched off where the system allows that.
fixed=()
if [ "$preset" = tsan ] && setarch --addr-no-randomize true 2>/dev/null; then
  fixed=(setarch --addr-no-randomize)
fi

cmake --preset "$preset" >/dev/null
targets=("$target")
selection=(--label-exclude nightly)
if [ "${1:-}" = --nightly ]; then
  selection=()
elif [ $# -gt 0 ]; then
  mapfile -t targets < <(cmake/affected_tests.py build "$@" --programs "$labels")
  if [ ${#targets[@]} = 0 ]; then
    echo "no test with these labels sees the change"
    exit 0
  fi
  # A further test of a program has the program's name and a word or a number.
  selection+=(--tests-regex "^($(IFS='|' && echo "${targets[*]}"))(_[a-z]+|_[0-9]+)?$")
fi
"${fixed[@]}" cmake --build --preset "$preset" --target "${targets[@]}"
"${fixed[@]}" cmake/run_tests.sh "$preset" "build-$preset" "-j$(nproc)" --label-regex "$labels" "${selection[@]}"
