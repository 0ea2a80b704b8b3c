"""Compare the program with all yardsticks: one table, printed and written to docs/verification.md.

The exit code is 1 if a line fails.
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from pathlib import Path

from verification import (
    against_auto,
    against_radau,
    against_reference,
    auto_07p,
    closed_forms,
)
from verification.row import Row

PAGE = Path(__file__).parent.parent / "docs" / "verification.md"
YARDSTICKS: dict[str, Callable[[], Iterator[Row]]] = {
    "Closed forms": closed_forms.rows,
    "Reference solutions": against_reference.rows,
    "AUTO-07p": against_auto.rows,
    "SciPy's Radau": against_radau.rows,
}
INTRODUCTION = {
    "Closed forms": """\
A wheelset with its dampers, spin creep, gyroscopic coupling and gravity stiffness taken away. Creep
coefficients are those of the reconstruction times the stated number; the difference falls a
hundredfold with each tenfold creep, as the first neglected term does. The textbook forms leave out
the factor s = 1 + r0 λ/d, 1.037 here: for them r0 and λ are both taken ten thousand times as small,
which leaves everything else as it is.""",
    "Reference solutions": """\
All cases of `tests/model/reference.json`; where the numbers come from is told beside it.""",
    "AUTO-07p": """\
AUTO follows the branch by orthogonal collocation on equations written separately
(`verification/hunting.f90`), with the corners of the dead band rounded by 1e-6 m. The rounding
moves its Hopf speed by 1e-7, cycles in contact by 7e-6 and a fold at the clearance by 2e-5; the
allowed differences are that, and little more. Two lines show that it is the rounding: with its
stiffness at rest added to our equations the Hopf points agree to 1e-11, and rounded by 1e-7 m
AUTO's folds come thirty times nearer.

With ordinary step limits AUTO puts the wheelset's fold at 144.17 km/h or stalls at the clearance.
What resolves it is that arclength is counted in lateral displacement alone - weights 1e6 for y
(`THU`) and 0 for V and the period (`THL`) - with steps of at most 0.14 mm (`DSMAX` 0.1), `DSMIN`
1e-9, `ITNW` 9, tolerances of 1e-9 and `NTST` 800: at 200 mesh intervals the corners still cost AUTO
4e-5 in contact.""",
    "SciPy's Radau": """\
`solve_ivp` on equations of its own, rtol 1e-10, stopped and started again at every contact and at
every turn of the damper. It starts on the program's cycles and comes back to the same peak one
period later; its multipliers are central differences of that period. Then it starts beside the
unstable cycle.""",
}


def main() -> int:
    """Print and write the table; return 1 if a line of it fails."""
    left_out = {"AUTO-07p": auto_07p.missing()}
    tables: dict[str, list[Row]] = {}
    for name, rows_of in YARDSTICKS.items():
        say(f"\n{name}")
        if reason := left_out.get(name):
            say(f"  left out: {reason}")
            continue
        tables[name] = []
        for row in rows_of():
            tables[name].append(row)
            say(as_text(row))
    rows = [row for table in tables.values() for row in table]
    agreeing = sum(row.passes for row in rows)
    say(f"\n{agreeing} of {len(rows)} lines agree")
    if any(left_out.values()):
        say(f"{PAGE.name} stays as it is, as something was left out")
    else:
        PAGE.parent.mkdir(exist_ok=True)
        PAGE.write_text(as_page(tables, f"{agreeing} of {len(rows)} lines agree"), encoding="utf-8")
        say(f"written to {PAGE}")
    return 0 if agreeing == len(rows) else 1


def as_page(tables: dict[str, list[Row]], verdict: str) -> str:
    """Return the tables as a page."""
    sections = [
        "\n".join([f"## {name}\n\n{INTRODUCTION[name]}\n", *HEADER, *map(as_markdown, table)])
        for name, table in tables.items()
    ]
    return "\n\n".join([TITLE.format(verdict=verdict).strip(), *sections]) + "\n"


TITLE = """\
# The program against independent programs

Written by `make verify`: {verdict}. Differences are relative, those of multipliers and counts
absolute. A group of points is shown by its worst.
"""
HEADER = ("| what | ours | theirs | difference | allowed | |", "|---|---:|---:|---:|---:|---|")


def as_text(row: Row) -> str:
    """Return a row for the terminal."""
    return (
        f"  {row.what:<112} {row.ours:>14.9g} {row.theirs:>14.9g} "
        f"{row.difference:>8.1e} {row.allowed:>8.0e}  {verdict_of(row)}"
    )


def as_markdown(row: Row) -> str:
    """Return a row of the page's table."""
    return (
        f"| {row.what.replace('|', '&#124;')} | {row.ours:.9g} | {row.theirs:.9g} | "
        f"{row.difference:.1e} | {row.allowed:.0e} | {verdict_of(row)} |"
    )


def verdict_of(row: Row) -> str:
    """Return whether a row passes, in a word."""
    return "agrees" if row.passes else "FAILS"


def say(line: str) -> None:
    """Print a line at once, so that a long run can be watched."""
    sys.stdout.write(line + "\n")
    sys.stdout.flush()


if __name__ == "__main__":
    sys.exit(main())
