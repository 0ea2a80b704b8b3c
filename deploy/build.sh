#!/bin/sh
# Build the image of the web demo and check it: build.sh ENGINE
set -eu
engine=$1
image=bogie-hunting
port=5096
version=$(sed -n 's/^version = "\(.*\)"/\1/p' pyproject.toml)
revision=$(git rev-parse HEAD 2>/dev/null || echo unknown)

"$engine" build --tag "$image" --build-arg VERSION="$version" --build-arg REVISION="$revision" .

container=$("$engine" run --detach --read-only --cap-drop ALL --security-opt no-new-privileges \
    --memory 512m --publish "127.0.0.1:$port:5006" "$image")
trap '"$engine" rm --force "$container" >/dev/null' EXIT
for _ in $(seq 60); do
    "$engine" exec "$container" python -m demo.health 2>/dev/null && break
    sleep 1
done
"$engine" exec "$container" python -m demo.health
python3 deploy/hostile.py "http://127.0.0.1:$port"
"$engine" stop --time 5 "$container" >/dev/null
code=$("$engine" inspect --format '{{.State.ExitCode}}' "$container")
[ "$code" = 0 ] || { echo "error: it did not end by itself within 5 s (exit code $code)" >&2; exit 1; }
echo "==> $image: $("$engine" image inspect --format '{{.Size}}' "$image" | awk '{ printf "%.0f MB", $1 / 1e6 }')"
