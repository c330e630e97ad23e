#!/usr/bin/env bash
# demo.sh PROGRAMS FOLDER: builds a model of the scan in tests/data, serves it, and fetches a picture of it with the
# thin client over TCP into FOLDER. On a terminal it then serves until Ctrl-C.
set -euo pipefail
programs=$1
folder=$2
scan=$(dirname "$0")/../tests/data/lion.drc
ready=$folder/ready.txt
mkdir -p "$folder"

echo "demo 3/4: model of $(basename "$scan")"
"$programs/surfcastd" build "$scan" --output "$folder/lion.surf"

echo 'demo 4/4: picture'
port=7600
if (: >"/dev/tcp/127.0.0.1/$port") 2>/dev/null; then
  port=0 # the port is in use: take any free one
fi
: >"$ready" # removes the output of an earlier run
"$programs/surfcastd" serve "$folder/lion.surf" --listen "127.0.0.1:$port" >"$ready" &
server=$!
trap 'kill "$server" 2>/dev/null || true' EXIT

# The server prints one line with its URL on standard output once it is ready. If it fails, the reason is on stderr.
until grep --quiet http "$ready"; do
  kill -0 "$server" 2>/dev/null || exit 1
  sleep 0.1
done
url=$(grep --only-matching 'http://.*' "$ready")
address=$(echo "$url" | cut --delimiter=/ --fields=3)

"$programs/surfcast" render "$address/lion" --output "$folder/lion.png" --background 28,32,40 \
  --camera-position 1.5,-3,2.5 --camera-focal-point -2.85,3.4,-1.25 --camera-view-angle 37

echo "picture: $PWD/$folder/lion.png"
echo "server:  $url"
if [ -t 1 ]; then
  echo "serving until Ctrl-C"
  trap : INT # the server receives Ctrl-C as well and stops by itself
else
  kill "$server"
fi
wait "$server" || wait "$server" # a signal interrupts the first wait
