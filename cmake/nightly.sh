#!/usr/bin/env bash
# Everything that the check of a change leaves out. SURFCAST_NIGHTLY_RUNS: how often the whole suite runs under load.
# SURFCAST_NIGHTLY_LOAD: how many tests are run at once on each processor for that.
set -euo pipefail
cd "$(dirname "$0")/.."
# shellcheck source=cmake/parts.sh
. cmake/parts.sh

# Inputs that are checked in full rather than by a sample.
in_full=(SURFCAST_DAMAGED_INPUTS=10000 SURFCAST_MUTATIONS=1000000 SURFCAST_STOPPED_BUILDS=40 SURFCAST_SOAK_SECONDS=60
  SURFCAST_SIMULATED_SECONDS=200000)
export "${in_full[@]}"

runs=${SURFCAST_NIGHTLY_RUNS:-20}
load=${SURFCAST_NIGHTLY_LOAD:-4}

# The whole suite many times, with `load` tests at once on each processor: the tests are each other's load. ctest
# repeats each until it fails. Inputs are sampled, as in `make test`.
under_load() (
  unset "${in_full[@]%=*}"
  ctest --preset release "-j$(($(nproc) * load))" --repeat "until-fail:$runs"
)

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
