#!/bin/sh
# install_test.sh CMAKE BUILD VERSION WINDOW DATA PYTHON: installs into a folder of its own and looks at what is there.
# DATA has the models of the tests.
set -eu
cmake=$1
build=$2
version=$3
window=$4
data=$5
python=$6
prefix=$(mktemp -d)
trap 'rm -rf "$prefix"' EXIT

fail() {
  echo "$*" >&2
  exit 1
}

"$cmake" --install "$build" --prefix "$prefix" >"$prefix/log" || fail "$(tail -n 20 "$prefix/log")"

programs="surfcastd surfcast"
[ "$window" = OFF ] || programs="$programs surfcast-view"
for program in $programs; do
  said=$("$prefix/bin/$program" --version)
  [ "$said" = "$program $version" ] || fail "$program --version says: $said"

  page=$prefix/share/man/man1/$program.1.gz
  [ -s "$page" ] || fail "there is no $page"
  if command -v groff >/dev/null; then
    complaints=$(gunzip -c "$page" | groff -man -ww -Tutf8 -z 2>&1)
    [ -z "$complaints" ] || fail "$page: $complaints"
  fi
  # Every flag of --help is in the manual, in which a dash is written \-.
  manual=$(gunzip -c "$page")
  commands=$("$prefix/bin/$program" --help | sed '1,/^Subcommands:/d' | awk '$1 != "view" { print $1 }')
  for command in "" $commands; do
    "$prefix/bin/$program" $command --help | grep --only-matching -- '--[a-z][a-z-]*' | sort -u | sed 's/-/\\-/g' |
      while read -r flag; do
        case $manual in *"$flag"*) ;; *) fail "$page lacks $flag of $command" ;; esac
      done
  done

  script=$prefix/share/bash-completion/completions/$program
  bash -n "$script" || fail "$script is no script of bash"
  grep --quiet "complete .* $program\$" "$script" || fail "$script completes nothing"
  [ -s "$prefix/share/zsh/site-functions/_$program" ] || fail "there is no completion for zsh"
  [ -s "$prefix/share/fish/vendor_completions.d/$program.fish" ] || fail "there is no completion for fish"
done

[ -s "$prefix/lib/surfcast/http_client.so" ] || fail "there is no module for stores"

# The server finds its module of image codecs where both are installed.
[ -s "$prefix/lib/surfcast/image_codecs.so" ] || fail "there is no module of image codecs"
[ -s "$prefix/lib/surfcast/image_decoders.so" ] || fail "there is no module of image decoders"
[ -s "$prefix/lib/surfcast/video_codec.so" ] || fail "there is no module of the video codec"
for format in png jpg webp exr; do
  "$prefix/bin/surfcastd" render "$data/sphere-and-grid-v2.surf" --resolution 32,24 --output "$prefix/picture.$format"
  [ -s "$prefix/picture.$format" ] || fail "the installed server wrote no picture in $format"
done

# The program with the window is found beside the client, and the viewer beside the server.
if [ "$window" != OFF ]; then
  "$prefix/bin/surfcast" view --help | grep --quiet 'surfcast view' || fail "surfcast view finds no surfcast-view"
fi
if [ -e "$build/client/web/dist/index.html" ]; then
  cmp "$build/client/web/dist/index.html" "$prefix/share/surfcast/viewer/index.html"
fi

# The Python client is installed where its wheel was built.
if [ -d "$build/client/python/wheel" ]; then
  said=$(PYTHONPATH=$(echo "$prefix"/lib/python3*/dist-packages) "$python" -c 'import surfcast as s; print(s.__version__)')
  [ "$said" = "$version" ] || fail "the Python client says: $said"
fi

unit=$prefix/lib/systemd/system/surfcastd.service
grep --quiet '^ExecStart=.*/bin/surfcastd serve' "$unit" || fail "the unit starts no server"
settings=$(sed -n 's/^EnvironmentFile=-.*\(\/etc\/default\/.*\)$/\1/p' "$unit")
[ -f "$prefix$settings" ] || fail "the unit reads $settings, which is not installed"
# serve does not read SURFCAST_MODELS: the unit passes it as an argument.
help=$("$prefix/bin/surfcastd" serve --help)
for variable in $(sed -n 's/^#\(SURFCAST_[A-Z_]*\)=.*/\1/p' "$prefix$settings"); do
  case "$help Env:SURFCAST_MODELS" in
    *"Env:$variable"*) ;;
    *) fail "$settings names $variable, which serve does not know" ;;
  esac
done
