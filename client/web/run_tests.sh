#!/bin/sh
# run_tests.sh NPM PAGE SCRIPT: runs the tests of package.json's SCRIPT, or skips them (77) where the viewer was not built.
set -eu
if [ ! -e "$2" ]; then
  echo "skipped: the viewer is not built, as npm could not install what it needs"
  exit 77
fi
cd "$(dirname "$0")"
exec "$1" run --silent "$3"
