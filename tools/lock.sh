#!/bin/sh
# Write requirements.lock, what the image runs, and deploy/build.lock, what builds its wheel:
# every package with its version and hashes. The versions are those that the oldest Python the
# project supports gets, as that is what the tests have passed with; the hashes are of all Pythons.
set -eu
python=${PYTHON:-python3}
version=$(sed -n 's/^requires-python = ">=\(.*\)"/\1/p' pyproject.toml)
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT

"$python" -m venv "$folder/venv"
"$folder/venv/bin/python" -m pip install --quiet --disable-pip-version-check uv

# uv does not read pip's configuration.
index=$("$python" -m pip config get global.index-url 2>/dev/null || true)
[ -z "$index" ] || export UV_DEFAULT_INDEX="$index"
lock() {
    "$folder/venv/bin/uv" pip compile --quiet --upgrade --generate-hashes --no-annotate \
        --only-binary :all: --python-version "$version" --python-platform linux \
        --no-emit-index-url --custom-compile-command "make lock" --output-file "$2" "$1"
}
lock pyproject.toml requirements.lock
sed -n 's/^requires = \["\(.*\)"\]/\1/p' pyproject.toml >"$folder/build.in"
lock "$folder/build.in" deploy/build.lock
