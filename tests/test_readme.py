"""What the README shows is what happens."""

from __future__ import annotations

import re
from pathlib import Path

from hunting import RECONSTRUCTED, bogie, critical_speeds, wheelset

README = (Path(__file__).parents[1] / "README.md").read_text(encoding="utf-8")


def test_the_ten_lines_print_what_the_readme_says(capsys):
    code, printed = re.search(r"```python\n(.*?)```.*?```\n(.*?)```", README, re.DOTALL).groups()
    exec(code, {})
    assert capsys.readouterr().out == printed


def test_the_table_of_critical_speeds_is_ours():
    for method, label in (
        ("averaging", "ours, Bogoliubov averaging"),
        ("harmonic_balance", "ours, exact limit cycles"),
    ):
        speeds = [critical_speeds(v(RECONSTRUCTED), method=method) for v in (wheelset, bogie)]
        numbers = [3.6 * s.linear for s in speeds] + [3.6 * s.nonlinear for s in speeds]
        row = f"| {label} | " + " | ".join(f"{n:.2f}" for n in numbers) + " |"
        assert row in README
