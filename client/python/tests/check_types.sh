#!/bin/sh
# check_types.sh PYTHON PACKAGE CONFIGURATION CACHE: checks the types of PACKAGE, the folder that is installed, and of
# the tests.
set -eu
cd "$(dirname "$0")"
export MYPYPATH="$2"
"$1" -m mypy --config-file "$3" --cache-dir "$4" -p surfcast
"$1" -m mypy --config-file "$3" --cache-dir "$4" ./*.py
