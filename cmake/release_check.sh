#!/usr/bin/env bash
# release_check.sh [version] [build] [packages FOLDER] [image]: checks a release as its users meet it; without arguments
# all of it, in this order.
#   version          the version, its section of CHANGELOG.md and the tag of HEAD agree
#   build            make package
#   packages FOLDER  the .deb files in FOLDER install on a bare Debian 12, where a served scan is drawn
#   image            the container image builds and draws
# A bare Debian 12 is a container where docker or podman answers, and otherwise a system that debootstrap makes, for
# which the script must be root. The image needs docker or podman.
set -euo pipefail
folder=$(cd "$(dirname "$0")/.." && pwd)
debian=debian:12
image=surfcast:release-check
# A picture of the lion has many times these bytes, and one of nothing but background fewer.
least_bytes=50000

fail() {
  echo "release check: $*" >&2
  exit 1
}

say() { echo "release check: $*"; }

version_of_source() { sed -n 's/^project(surfcast VERSION \([0-9.]*\) .*/\1/p' "$folder/CMakeLists.txt"; }

tag_of_head() { git -C "$folder" describe --tags --exact-match --match 'v*' 2>/dev/null || true; }

# The first of docker and podman whose engine answers, or nothing.
engine() {
  local name
  for name in docker podman; do
    if command -v "$name" >/dev/null && timeout 30 "$name" ps >/dev/null 2>&1; then
      echo "$name"
      return
    fi
  done
}

check_picture() {
  local bytes
  [ "$(head -c 8 "$1" | od -An -tx1 | tr -d ' ')" = 89504e470d0a1a0a ] || fail "$1 is no PNG"
  bytes=$(wc -c <"$1")
  [ "$bytes" -ge "$least_bytes" ] || fail "$1 has $bytes bytes, which are too few for a picture of the scan"
}

check_version() {
  local version tag
  version=$(version_of_source)
  [ -n "$version" ] || fail "CMakeLists.txt states no version"
  "$folder/tests/structure/version_test.sh" "$folder" "$version" || fail "the version is not stated as it should be"

  tag=$(tag_of_head)
  if [ -n "$tag" ]; then
    [ "$tag" = "v$version" ] || fail "HEAD is tagged $tag, and CMakeLists.txt states $version"
    git -C "$folder" diff --quiet HEAD || fail "files differ from those of $tag"
    say "version $version, tagged $tag"
  elif git -C "$folder" rev-parse --quiet --verify "refs/tags/v$version" >/dev/null; then
    fail "v$version is another commit: CMakeLists.txt and CHANGELOG.md need the next version"
  else
    say "version $version; HEAD is not tagged"
  fi
}

# Runs within the bare Debian 12, where the folder above this script holds copies of what is needed.
check_installed() {
  local version=$1 program said
  cd "$folder"
  export DEBIAN_FRONTEND=noninteractive
  apt-get -qq update
  # Without what is only recommended: the packages must work with what they depend on.
  apt-get -qq -o=Dpkg::Use-Pty=0 install --no-install-recommends "$folder"/packages/*.deb >"$folder/apt.log" 2>&1 || {
    tail -n 30 "$folder/apt.log" >&2
    fail "the packages do not install on a bare Debian 12"
  }

  for program in surfcastd surfcast surfcast-view; do
    said=$("$program" --version || true)
    [ "$said" = "$program $version" ] || fail "$program --version says: $said"
  done
  said=$(python3 -c 'import surfcast; print(surfcast.__version__)' || true)
  [ "$said" = "$version" ] || fail "the Python client says: $said"
  [ -s /usr/share/surfcast/viewer/index.html ] || fail "the viewer is not installed"

  # It serves on if its output is a terminal.
  cmake/demo.sh /usr/bin picture | cat
  chmod --recursive a+rwX picture apt.log
}

in_container() {
  "$1" run --rm --volume "$2:/release" "$debian" bash /release/cmake/release_check.sh installed "$3"
}

# In namespaces of its own, so that its processes and mounts end with it.
in_bare_system() {
  local system=$1/system
  [ "$(id -u)" = 0 ] || fail "neither docker nor podman answers, and debootstrap needs root"
  "$folder/cmake/install_packages.sh" release
  say "making a bare Debian 12 in $system"
  debootstrap --variant=minbase bookworm "$system" >"$1/debootstrap.log" 2>&1 || {
    tail -n 30 "$1/debootstrap.log" >&2
    fail "debootstrap failed"
  }
  mv "$1/release" "$system/release"
  # Only these variables: the system must do without the rest.
  unshare --mount --pid --fork --kill-child --root="$system" --mount-proc \
    env --ignore-environment PATH=/usr/sbin:/usr/bin:/sbin:/bin HOME=/root LC_ALL=C.UTF-8 \
    ${http_proxy:+"http_proxy=$http_proxy"} ${https_proxy:+"https_proxy=$https_proxy"} \
    bash /release/cmake/release_check.sh installed "$2"
  mv "$system/release" "$1/release"
}

check_packages() {
  local packages=$1 version name found
  version=$(version_of_source)
  work=$(mktemp -d)
  trap 'rm -rf --one-file-system "$work"' EXIT
  # A container's user may be another one.
  chmod a+rwx "$work"
  mkdir -p "$work/release/packages" "$work/release/cmake" "$work/release/tests/data" "$work/release/picture"
  # The folder may hold packages of earlier versions.
  for name in surfcast-server surfcast-client surfcast-view python3-surfcast; do
    found=("$packages/${name}_${version}"_*.deb)
    if [ ${#found[@]} != 1 ] || [ ! -f "${found[0]}" ]; then
      fail "$packages does not hold one package $name $version"
    fi
    cp "${found[0]}" "$work/release/packages"
  done
  cp "$folder/cmake/release_check.sh" "$folder/cmake/demo.sh" "$work/release/cmake"
  cp "$folder/tests/data/lion.drc" "$work/release/tests/data"

  with=$(engine)
  if [ -n "$with" ]; then
    in_container "$with" "$work/release" "$version"
  else
    in_bare_system "$work" "$version"
  fi
  check_picture "$work/release/picture/lion.png"
  rm -rf --one-file-system "$work"
  trap - EXIT
  say "the packages of $version draw on a bare Debian 12 (${with:-debootstrap})"
}

# Work, with and container are no locals, because traps use them after functions have ended.
# Ends the container and removes what check_image has made. Removing twice is harmless.
clean_image() {
  [ -z "$container" ] || "$with" rm --force "$container" >/dev/null 2>&1 || true
  "$with" run --rm --user 0 --entrypoint sh --volume "$work:/models" "$image" -c 'rm -f /models/*' >/dev/null 2>&1 || true
  rm -rf "$work"
}

check_image() {
  local version said
  version=$(version_of_source)
  with=$(engine)
  if [ -z "$with" ]; then
    # A release is checked as a whole; before it, the rest is of use on machines without an engine.
    [ -z "$(tag_of_head)" ] || fail "neither docker nor podman answers: the image of a tagged commit is not checked"
    say "THE IMAGE IS NOT CHECKED: neither docker nor podman answers"
    return
  fi
  "$with" build --file "$folder/docker/Dockerfile" --tag "$image" "$folder"
  said=$("$with" run --rm "$image" --version || true)
  [ "$said" = "surfcastd $version" ] || fail "the image says: $said"

  work=$(mktemp -d)
  container=
  trap clean_image EXIT
  chmod a+rwx "$work"
  cp "$folder/tests/data/lion.drc" "$work"
  "$with" run --rm --volume "$work:/models" "$image" build lion.drc --output lion.surf
  container=$("$with" run --detach --volume "$work:/models:ro" "$image")
  # shellcheck disable=SC2016
  timeout 120 bash -c 'until "$1" exec "$2" surfcastd healthcheck >/dev/null 2>&1; do sleep 1; done' - \
    "$with" "$container" || {
    "$with" logs "$container" >&2
    fail "the server in the image does not answer"
  }
  "$with" exec "$container" surfcast render 127.0.0.1:7600/lion --output - --format png >"$work/lion.png"
  check_picture "$work/lion.png"
  clean_image
  trap - EXIT
  say "the image of $version draws ($with)"
}

[ $# -gt 0 ] || set -- version build packages "$folder/build-package" image
while [ $# -gt 0 ]; do
  case $1 in
    version) check_version ;;
    build) make -C "$folder" package ;;
    packages | installed)
      [ $# -ge 2 ] || fail "$1 wants an argument"
      "check_$1" "$2"
      shift
      ;;
    image) check_image ;;
    *) fail "unknown: $1; see the beginning of $0" ;;
  esac
  shift
done
