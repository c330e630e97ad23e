#!/bin/sh
# precompile.sh COMMAND...: runs a compiler. For a precompiled header it writes a checksum beside it, of the command and
# of all headers in it, which ccache takes in place of the file (CCACHE_PCH_EXTSUM): GCC's files are never the same twice,
# those of clang hold paths and times, and no two checkouts would share what is compiled with them.
set -eu
output=
last=
for word in "$@"; do
  [ "$last" != -o ] || output=$word
  last=$word
done
case $output in
  *.gch) ;;
  *.pch) export CCACHE_DISABLE=1 ;;  # clang refuses one that another build has made
  *) exec "$@" ;;
esac

rm -f "$output" "$output.sum"
"$@"
{
  # Whatever the checkout and its build folder are named.
  echo "$*" | sed "s#$PWD/#build/#g; s#$CCACHE_BASEDIR/##g"
  # The list of headers follows the colon, continued over lines.
  sed 's/^[^ ]*:/ /; s/\\$//' "$output.d" | xargs cat
} | sha256sum >"$output.sum"
