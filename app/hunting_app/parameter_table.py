"""Two sets of parameters side by side, as a table of HTML."""

from __future__ import annotations

from collections.abc import Mapping
from html import escape

from hunting import Parameters
from hunting_app.formula import with_subscripts
from hunting_app.numerals import written
from hunting_app.state import FIELDS


def parameter_table(
    columns: Mapping[str, Parameters], remark: str = "", remarks: Mapping[str, str] | None = None
) -> str:
    """Return the table; what differs between the two is marked.

    Parameters
    ----------
    columns : mapping of str to Parameters
        Two sets by their headings.
    remark : str, optional
        Heading of a last column.
    remarks : mapping of str to str, optional
        What that says, by the field's name.
    """
    rows = []
    for field in FIELDS.values():
        values = [float(getattr(p, field.name)) for p in columns.values()]
        symbol, _, subscript = field.symbol.partition("_")
        mark = ' class="changed"' if len(set(values)) > 1 else ""
        said = f"<td>{with_subscripts((remarks or {}).get(field.name, ''))}</td>" if remark else ""
        rows.append(
            f'<tr{mark}><th scope="row"><i>{symbol}</i><sub>{subscript}</sub></th>'
            f"<td>{escape(field.label)}</td>"
            + "".join(f'<td class="number">{written(value)}</td>' for value in values)
            + f"<td>{escape(field.unit)}</td>{said}</tr>"
        )
    headings = ["symbol", "parameter", *columns, "unit", *([remark] if remark else [])]
    head = "".join(f'<th scope="col">{escape(heading)}</th>' for heading in headings)
    return f"<table><thead><tr>{head}</tr></thead><tbody>{''.join(rows)}</tbody></table>"
