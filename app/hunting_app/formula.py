r"""Formulas in plain HTML, from a little of TeX's notation.

Browsers draw MathML well only where a font for it is installed; this looks the same everywhere.
Understood: ``\frac{}{}``, ``\sqrt{}``, ``\text{}``, ``\quad``, ``_`` and ``^`` with one character
or braces, ``\name`` for upright names; everything else is itself.
"""

from __future__ import annotations

import re
from html import escape
from pathlib import Path

STYLE = (Path(__file__).parent / "formula.css").read_text(encoding="utf-8")
_TOKEN = re.compile(r"\\text\{[^}]*\}|\\[a-zA-Z]+|[0-9][0-9.]*|\S")
_RELATION = frozenset("=+-<>∓≤≥")


def formula(source: str) -> str:
    """Return a formula as HTML that is read aloud as its source.

    Examples
    --------
    >>> print(formula("K_y z"))
    <span class="formula" role="math" aria-label="K_y z"><i>K</i><sub><i>y</i></sub><i>z</i></span>
    """
    tokens = _TOKEN.findall(source)
    drawn = _row(tokens)
    if tokens:
        raise ValueError(f"a closing brace too many in {source!r}")
    return f'<span class="formula" role="math" aria-label="{_spoken(source)}">{drawn}</span>'


def _row(tokens: list[str]) -> str:
    """Draw up to the end or a closing brace."""
    drawn: list[str] = []
    while tokens and tokens[0] != "}":
        token = tokens.pop(0)
        if token in _RELATION:
            unary = not drawn or drawn[-1].endswith((" ", "(", "["))
            sign = escape(token.replace("-", "−"))
            drawn.append(sign if unary else f" {sign} ")
        else:
            drawn.append(_atom(token, tokens))
    return "".join(drawn)


def _atom(token: str, tokens: list[str]) -> str:
    match token:
        case "\\frac":
            above, below = _group(tokens), _group(tokens)
            return f'<span class="fraction"><span>{above}</span><span>{below}</span></span>'
        case "\\sqrt":
            return f'√<span class="root">{_group(tokens)}</span>'
        case "_":
            return f"<sub>{_group(tokens)}</sub>"
        case "^":
            return f"<sup>{_group(tokens)}</sup>"
        case "'":
            return "′"
        case "\\quad":
            return '<span class="quad"></span>'
        case ",":
            return ", "
    if token.startswith("\\text{"):
        return escape(token[6:-1])
    if token.startswith("\\"):
        return f"{token[1:]} "
    return f"<i>{token}</i>" if token.isalpha() else escape(token)


def _group(tokens: list[str]) -> str:
    token = tokens.pop(0)
    if token != "{":
        return _atom(token, tokens)
    drawn = _row(tokens)
    tokens.pop(0)
    return drawn


def _spoken(source: str) -> str:
    plain = re.sub(r"\\frac\{([^}]*)\}\{([^}]*)\}", r"(\1)/(\2)", source)
    plain = re.sub(r"\\text\{([^}]*)\}", r"\1", plain).replace("\\quad", " ")
    return escape(re.sub(r"[\\{}]", "", plain))


def with_subscripts(text: str) -> str:
    """Return plain words as HTML in which ``K_y`` has its subscript.

    Examples
    --------
    >>> with_subscripts("2 K_y b²")
    '2 K<sub>y</sub> b²'
    """
    return re.sub(r"(?<=[^\W_])_(\w+)", r"<sub>\1</sub>", escape(text))
