#!/bin/sh
# collect_libraries.sh PROGRAM SYSTEM FOLDER: copies to FOLDER the shared libraries that PROGRAM loads and that SYSTEM,
# a copy of another image's /usr/lib, does not have. OpenImageIO's package alone depends on 300 MB of other things.
set -eu
program=$1
system=$2
folder=$3
mkdir -p "$folder"
ldd "$program" | awk '$2 == "=>" { print $1, $3 }' | while read -r name path; do
  [ -n "$(find "$system" -name "$name" -print -quit)" ] || cp --dereference "$path" "$folder/$name"
done
