"""Find what the browser tests need; as a command, install what is missing where Debian has it."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
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
NO_CHROMIUM = (
    "no Chromium found: install chromium or Google Chrome, or set CHROMIUM to the program's path"
)
NO_DRIVER = "Playwright's driver does not start (on Debian it needs the package libatomic1)"


def find_chromium() -> str | None:
    """Path of a Chromium: ``$CHROMIUM``, else one on the PATH, else None."""
    if named := os.environ.get("CHROMIUM"):
        return shutil.which(named)
    on_path = (shutil.which(name) for name in NAMES)
    in_applications = (str(path) for path in MAC if path.exists())
    return next((path for path in (*on_path, *in_applications) if path), None)


def driver_starts() -> bool:
    """Say whether the Node.js that Playwright brings along runs on this system."""
    version = [sys.executable, "-m", "playwright", "--version"]
    return subprocess.run(version, capture_output=True).returncode == 0


def obstacle() -> str | None:
    """Why no browser test can run here, or None."""
    if find_chromium() is None:
        return NO_CHROMIUM
    return None if driver_starts() else NO_DRIVER


def install_from_debian(packages: list[str]) -> None:
    """Install Debian's packages where that is possible."""
    if os.name != "posix" or os.geteuid() != 0 or not shutil.which("apt-get"):
        return
    print(f"==> installing Debian's {' and '.join(packages)} for the browser tests", flush=True)
    apt = ["apt-get", "-qq", "-o", "DPkg::Lock::Timeout=300"]
    env = os.environ | {"DEBIAN_FRONTEND": "noninteractive"}
    for command in (["update"], ["install", "-y", "--no-install-recommends", *packages]):
        subprocess.run([*apt, *command], env=env, stdout=subprocess.DEVNULL, check=False)


def main() -> None:
    """Say in one line which Chromium the browser tests will use, or why they will be skipped."""
    missing = []
    if find_chromium() is None and "CHROMIUM" not in os.environ:
        missing.append("chromium")
    if not driver_starts():
        missing.append("libatomic1")
    if missing:
        install_from_debian(missing)
    reason = obstacle()
    print(f"==> browser tests: {reason or find_chromium()}{', so skipped' if reason else ''}")


if __name__ == "__main__":
    main()
