#!/usr/bin/env bash
# run.sh BUILD SECONDS: every fuzz target for so many seconds, two at a time, from the corpora beside this file. Inputs
# that stop a target are left in BUILD/findings; a finding fails the run. New inputs of interest stay in BUILD/corpus.
set -euo pipefail
build=$1 seconds=$2
corpora=$(cd "$(dirname "$0")" && pwd)/corpus
mkdir -p "$build/findings"

fuzz() {
  local name=$1
  mkdir -p "$build/corpus/$name"
  if ! "$build/bin/fuzz_$name" -max_total_time="$seconds" -timeout=10 -rss_limit_mb=2048 -max_len=65536 \
      -artifact_prefix="$build/findings/$name-" -print_final_stats=1 \
      "$build/corpus/$name" "$corpora/$name" > "$build/findings/$name.log" 2>&1; then
    echo "$name: FAILED, see $build/findings/$name.log"
    return 1
  fi
  sed -n "s/^stat::number_of_executed_units: */$name: inputs /p" "$build/findings/$name.log"
}
export -f fuzz
export build seconds corpora

ls "$corpora" | xargs -P 2 -I NAME bash -c 'fuzz NAME'
