# Sourced by scripts that run one check after another: `part NAME COMMAND...` runs one of them. At the end, or after a
# part that has failed, the minutes of each part are printed, and the closing lines of the tests.
minutes=()
current=
closing=

in_minutes() { awk -v seconds="$1" -v name="$2" 'BEGIN { printf "%6.1f  %s", seconds / 60, name }'; }

part() {
  local begin=$SECONDS
  current=$1
  shift
  printf '\n==== %s: %s\n' "$current" "$*"
  "$@"
  minutes+=("$(in_minutes $((SECONDS - begin)) "$current")")
  current=
}

# The last lines of the output of each test that failed in the last run.
failures() {
  local folder=build/Testing/Temporary name
  [ ! -e "$folder/LastTestsFailed.log" ] || while IFS=: read -r _ name; do
    printf '\n---- %s\n' "$name"
    sed -n "\\,Test: $name\$,,/^<end of output>/p" "$folder/LastTest.log" | tail -n 40
  done <"$folder/LastTestsFailed.log"
}

# How many cases of GoogleTest the last run had, and which it skipped.
cases() {
  local log=build/Testing/Temporary/LastTest.log
  [ -e "$log" ] || return 0
  printf 'cases of GoogleTest: %d passed, %d skipped\n' "$(grep -c '^\[       OK \]' "$log")" \
    "$(grep -c '^\[  SKIPPED \] .* ms)$' "$log")"
  sed -n 's/^\[  SKIPPED \] \(.*\) ([0-9]* ms)$/  skipped: \1/p' "$log"
}

# The tests as the README runs them, with arguments of make. Their closing lines are kept for the end.
tests() {
  local log code=0
  log=$(mktemp)
  rm -f build/Testing/Temporary/LastTestsFailed.log
  make test "$@" 2>&1 | tee "$log" || code=$?
  closing=$(failures && sed -n '/tests passed, .* tests failed out of/,$p' "$log" && cases)
  rm -f "$log"
  return "$code"
}

# The tests of a change. A few that fail beside others may run once more, alone. Those that pass then are named as
# unstable, with the output of their failure, and do not stop the change: `make nightly` counts them as failures.
tests_of_change() {
  local failed=build/Testing/Temporary/LastTestsFailed.log unstable
  ! tests || return 0
  [ -e "$failed" ] && [ "$(wc -l <"$failed")" -le "${SURFCAST_UNSTABLE_TESTS:-3}" ] || return 1
  unstable=$(cut -d: -f2- "$failed")
  ctest --preset release -j1 --rerun-failed || return 1
  closing+=$'\n\n'"unstable, passed alone: ${unstable//$'\n'/ }"
}

report() {
  local code=$?
  printf '\n==== minutes\n'
  [ ${#minutes[@]} = 0 ] || printf '%s\n' "${minutes[@]}"
  printf '%s\n' "$(in_minutes "$SECONDS" 'in all')"
  [ -z "$closing" ] || printf '\n%s\n' "$closing"
  if [ -n "$current" ] && { [ "$current" != tests ] || [ -z "$closing" ]; }; then
    printf '\n%s failed; parts: %d passed, 1 failed\n' "$current" "${#minutes[@]}"
  fi
  exit "$code"
}
trap report EXIT
