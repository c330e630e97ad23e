#!/bin/sh
# install_packages.sh PURPOSE...: installs the packages that cmake/debian-packages.txt lists under these purposes.
# Installs missing packages only, so that a second run needs neither network nor root.
set -eu
list=$(dirname "$0")/debian-packages.txt

if ! command -v dpkg-query >/dev/null; then
  echo "$0: this is not a Debian system; install what $list names (see README.md)" >&2
  exit 0
fi

missing=
for purpose in "$@"; do
  for entry in $(awk -v purpose="$purpose" '$1 == purpose { print $2 ":" $3 }' "$list"); do
    package=${entry%:*}
    program=${entry#*:}
    [ -z "$program" ] || ! command -v "$program" >/dev/null || continue
    status=$(dpkg-query --show --showformat '${db:Status-Status}' "$package" 2>/dev/null || true)
    [ "$status" = installed ] || missing="$missing $package"
  done
done
[ -n "$missing" ] || exit 0

echo "installing:$missing"
as_root=
[ "$(id -u)" = 0 ] || as_root=sudo
# Quiet, so that apt's output does not hide the output of later programs.
$as_root env DEBIAN_FRONTEND=noninteractive apt-get -qq update
$as_root env DEBIAN_FRONTEND=noninteractive apt-get -qq -o=Dpkg::Use-Pty=0 install --no-install-recommends $missing \
  >/dev/null
