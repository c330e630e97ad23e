#!/bin/sh
# collect_libraries.sh SYSTEM FOLDER PROGRAM...: copies to FOLDER the shared libraries that the programs load and that
# SYSTEM, a copy of another image's /usr/lib, lacks. Installing their packages would add files that are not needed.
set -eu
system=$1
folder=$2
shift 2
mkdir -p "$folder"
ldd "$@" | awk '$2 == "=>" { print $1, $3 }' | sort -u | while read -r name path; do
  [ -n "$(find "$system" -name "$name" -print -quit)" ] || cp --dereference "$path" "$folder/$name"
done
