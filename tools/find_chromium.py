"""Find a Chromium for the browser tests, and as a command install Debian's if there is none."""

from __future__ import annotations

import os
import shutil
import subprocess
from pathlib import Path

NAMES = (
    "chromium",
    "chromium-browser",
    "google-chrome",
    "google-chrome-stable",
    "chrome",
    "microsoft-edge",
)
MAC = (
    Path("/Applications/Chromium.app/Contents/MacOS/Chromium"),
    Path("/Applications/Google Chrome.app/Contents/MacOS/Google Chrome"),
)
MISSING = (
    "no Chromium found: install chromium or Google Chrome, or set CHROMIUM to the program's path"
)


def find_chromium() -> str | None:
    """Path of a Chromium: ``$CHROMIUM``, else one on the PATH, else None."""
    if named := os.environ.get("CHROMIUM"):
        return shutil.which(named)
    on_path = (shutil.which(name) for name in NAMES)
    in_applications = (str(path) for path in MAC if path.exists())
    return next((path for path in (*on_path, *in_applications) if path), None)


def install_debian_chromium() -> bool:
    """Install Debian's package if that is possible here; say whether it was."""
    if os.name != "posix" or os.geteuid() != 0 or not shutil.which("apt-get"):
        return False
    print("==> installing Debian's chromium package for the browser tests", flush=True)
    apt = ["apt-get", "-qq", "-o", "DPkg::Lock::Timeout=300"]
    env = os.environ | {"DEBIAN_FRONTEND": "noninteractive"}
    for command in (["update"], ["install", "-y", "--no-install-recommends", "chromium"]):
        if subprocess.run([*apt, *command], env=env, stdout=subprocess.DEVNULL).returncode:
            return False
    return True


def main() -> None:
    """Say in one line which Chromium the browser tests will use, or why they will be skipped."""
    path = find_chromium()
    if path is None and "CHROMIUM" not in os.environ and install_debian_chromium():
        path = find_chromium()
    print(f"==> browser tests: {path}" if path else f"==> browser tests will be skipped: {MISSING}")


if __name__ == "__main__":
    main()
