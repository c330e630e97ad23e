#!/bin/sh
# run_tests.sh NPM PAGE SCRIPT [OPTION...]: runs the tests of package.json's SCRIPT with options of vitest, or skips them
# (77) where the viewer was not built.
set -eu
if [ ! -e "$2" ]; then
  echo "skipped: the viewer is not built, as npm could not install what it needs"
  exit 77
fi
cd "$(dirname "$0")"
npm=$1
script=$3
shift 3
exec "$npm" run --silent "$script" -- "$@"
