#!/bin/sh
# Make or update the virtual environment: environment.sh run|test
#
#   VENV    where it lives (default .venv)
#   PYTHON  the interpreter to make it with (default: the first Python >= 3.11 found)
#
# Nothing is done when the environment is there and pyproject.toml has not changed since.
set -eu
what=$1
venv=${VENV:-.venv}
python=$venv/bin/python

say() { echo "==> $*"; }
fail() { echo "error: $*" >&2; exit 1; }
is_new_enough() { "$1" -c 'import sys; sys.exit(sys.version_info < (3, 11))' 2>/dev/null; }
has_pip() { [ -x "$python" ] && is_new_enough "$python" && "$python" -m pip --version >/dev/null 2>&1; }

find_python() {
    if [ -n "${PYTHON:-}" ]; then
        is_new_enough "$PYTHON" || fail "PYTHON=$PYTHON is not a Python 3.11 or newer."
        echo "$PYTHON"
        return
    fi
    for candidate in python3 python3.13 python3.12 python3.11 python3.14; do
        if is_new_enough "$candidate"; then echo "$candidate"; return; fi
    done
    fail "no Python 3.11 or newer found. Install one, or name it: make PYTHON=/path/to/python3 ..."
}

# Debian and Ubuntu ship Python without the part that makes virtual environments.
need_venv_module() {
    "$1" -c 'import ensurepip, venv' 2>/dev/null && return
    package=$("$1" -c 'import sys; print("python%d.%d-venv" % sys.version_info[:2])')
    if [ "$(id -u)" = 0 ] && command -v apt-get >/dev/null; then
        say "installing $package, which $1 needs to make a virtual environment"
        apt-get update -qq && DEBIAN_FRONTEND=noninteractive apt-get install -y -qq "$package" >/dev/null || true
        "$1" -c 'import ensurepip, venv' 2>/dev/null && return
    fi
    fail "$1 cannot make a virtual environment: its venv or ensurepip module is missing.
       On Debian and Ubuntu: sudo apt-get install $package"
}

if ! has_pip; then
    base=$(find_python)
    need_venv_module "$base"
    say "making the virtual environment $venv with $("$base" --version)"
    "$base" -m venv --clear "$venv"
elif [ -n "${PYTHON:-}" ]; then
    version='import sys; print("%d.%d.%d" % sys.version_info[:3])'
    is_new_enough "$PYTHON" || fail "PYTHON=$PYTHON is not a Python 3.11 or newer."
    if [ "$("$PYTHON" -c "$version")" != "$("$python" -c "$version")" ]; then
        say "making the virtual environment $venv again, with $("$PYTHON" --version)"
        need_venv_module "$PYTHON"
        "$PYTHON" -m venv --clear "$venv"
    fi
fi

# The stamps hold what was installed: from which pyproject.toml, and where the clone was.
wanted="$(cksum <pyproject.toml) $PWD"
installed() { [ "$(cat "$venv/.installed-$1" 2>/dev/null)" = "$wanted" ]; }

if installed "$what" || { [ "$what" = run ] && installed test; }; then
    say "environment: $venv is up to date ($("$python" --version))"
    exit
fi

quiet=--quiet
[ -t 1 ] && quiet=
case $what in
    run) say "installing bogie-hunting and what it needs into $venv (a few minutes the first time)"
         target=. ;;
    test) say "installing bogie-hunting and its test tools into $venv (a few minutes the first time)"
          target=.[test] ;;
    *) fail "unknown environment '$what'" ;;
esac
"$python" -m pip install --disable-pip-version-check $quiet --editable "$target"
echo "$wanted" >"$venv/.installed-$what"
