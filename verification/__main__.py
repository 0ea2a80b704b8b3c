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

The fold at the clearance is a trap. With AUTO's own weights, which let V swamp y, the run stalls
there on both vehicles, whatever the step limit (`DSMAX` 0.05 to 2) and the mesh (`NTST` 40 or 100);
with y weighted but long steps it passes the corner by, and the slowest point it prints is up to
0.5 % too fast. What resolves it is an arclength of lateral displacement alone - weights 1e6 for y
(`THU`), 0 for V and the period (`THL`) - in steps of at most 0.14 mm (`DSMAX` 0.1) that may
become as small as it takes (`DSMIN` 1e-9), with up to 9 corrections (`ITNW`), tolerances of 1e-9
and a mesh of `NTST` 800: 200 intervals are enough for the folds, but still cost AUTO 4e-5 in
contact.""",
    "SciPy's Radau": """\
`solve_ivp` on equations of its own, rtol 1e-10, stopped and started again at every contact and at
every turn of the damper. It starts on the program's cycles and comes back to the same peak one
period later; its multipliers are central differences of that period. Then it starts beside cycles
of the program and is compared with where the program's branch, and its simulation at the default
tolerance, say that the motion goes.""",
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

Written by `make verify`: {verdict}. Differences are relative, those of multipliers, counts
and shares absolute. A group of points is shown by its worst.
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
