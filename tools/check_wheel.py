"""Build the wheel, and check that it holds every tracked file of both packages and imports."""

from __future__ import annotations

import subprocess
import sys
import tempfile
from pathlib import Path
from zipfile import ZipFile

ROOT = Path(__file__).parent.parent
PACKAGES = {"hunting": ROOT / "model", "hunting_app": ROOT / "app"}


def build(folder: Path) -> Path:
    """Build the wheel into `folder`."""
    pip = [sys.executable, "-m", "pip", "--quiet", "--disable-pip-version-check"]
    subprocess.run([*pip, "wheel", "--no-deps", "--wheel-dir", folder, ROOT], check=True)
    (wheel,) = folder.glob("bogie_hunting-*.whl")
    return wheel


def tracked_files() -> set[str]:
    """Names, as the wheel should have them, of the packages' files that git knows."""
    return {
        name
        for package, parent in PACKAGES.items()
        for name in subprocess.run(
            ["git", "ls-files", package], cwd=parent, check=True, capture_output=True, text=True
        ).stdout.splitlines()
    }


def import_alone(site: Path) -> None:
    """Import both packages from `site`, with the clone's copies out of reach."""
    code = (
        f"import sys; sys.path.insert(0, {str(site)!r})\n"
        f"for name in {list(PACKAGES)}:\n"
        f"    assert __import__(name).__file__.startswith({str(site)!r}), name"
    )
    subprocess.run([sys.executable, "-c", code], cwd=site, check=True)


def main() -> None:
    """Check a newly built wheel, and leave nothing behind."""
    with tempfile.TemporaryDirectory() as folder:
        wheel = build(Path(folder))
        with ZipFile(wheel) as archive:
            missing = tracked_files() - set(archive.namelist())
            archive.extractall(site := Path(folder, "site"))
        if missing:
            sys.exit(f"{wheel.name} lacks {sorted(missing)}")
        import_alone(site)
        print(f"{wheel.name}: both packages are whole and import")


if __name__ == "__main__":
    main()
