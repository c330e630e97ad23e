#!/usr/bin/env bash
# Everything that the check of a change leaves out. SURFCAST_NIGHTLY_RUNS: how often the whole suite runs under load.
set -euo pipefail
cd "$(dirname "$0")/.."
# shellcheck source=cmake/parts.sh
. cmake/parts.sh

# Inputs that are checked in full rather than by a sample.
export SURFCAST_DAMAGED_INPUTS=10000
export SURFCAST_STOPPED_BUILDS=40
export SURFCAST_SOAK_SECONDS=60

runs=${SURFCAST_NIGHTLY_RUNS:-20}
load=${SURFCAST_NIGHTLY_LOAD:-4}

# The whole suite while `load` processes compute. A test that fails once has failed.
under_load() {
  local busy=() failed=0 run i
  for ((i = 0; i < load; ++i)); do
    (while :; do :; done) &
    busy+=($!)
  done
  for ((run = 1; run <= runs; ++run)); do
    echo "run $run of $runs under a load of $load"
    make test ALL=1 || failed=$((failed + 1))
  done
  kill "${busy[@]}"
  echo "$failed of $runs runs under a load of $load failed"
  [ "$failed" = 0 ]
}

part 'packages' make packages lint-packages sanitizer-packages
part 'format' make format-check
part 'release build' make build
part 'benchmarks' make benchmarks
part 'tests' tests ALL=1
part 'address and undefined behaviour sanitizers' make asan-all
part 'thread sanitizer' make tsan-all
part 'clang-tidy' make tidy
part 'fuzzing' make fuzz
part 'tests under load' under_load
