#!/bin/sh
# run_tests.sh PYTHON PACKAGE CONFIGURATION TEST...: runs tests of the Python client against PACKAGE, the folder that is
# installed. CONFIGURATION is its pyproject.toml.
set -eu
python=$1
package=$2
configuration=$3
shift 3
cd "$(dirname "$0")"
PYTHONPATH=$package PYTHONDONTWRITEBYTECODE=1 exec "$python" -m pytest -q -p no:cacheprovider -c "$configuration" \
  --rootdir "$PWD" "$@"
