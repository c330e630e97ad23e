#!/bin/sh
# viewer_required_test.sh CMAKE SOURCE: builds the viewer with an npm that cannot reach its registry.
set -eu
cmake=$1
source=$2
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
printf '#!/bin/sh\necho "npm error code SELF_SIGNED_CERT_IN_CHAIN" >&2\nexit 1\n' >"$folder/npm"
chmod +x "$folder/npm"
mkdir "$folder/source"
cp "$source/client/web/package-lock.json" "$folder/source"

build_viewer() {
  "$cmake" -D NPM="$folder/npm" -D SOURCE="$folder/source" -D SCHEMA="$source/protocol/surfcast.proto" \
    -D BINARY="$folder" -D REQUIRED="$1" -P "$source/client/web/build_viewer.cmake" >"$folder/log" 2>&1
}

if build_viewer 1; then
  echo "a viewer that is required was not built, and no error told of it" >&2
  exit 1
fi
grep --quiet SELF_SIGNED_CERT_IN_CHAIN "$folder/log"
build_viewer 0
grep --quiet 'warning: the viewer is not built' "$folder/log"
