"""What the words on the page mean, shown where one is pointed at or reached by keyboard."""

from __future__ import annotations

import re
from html import escape

GLOSSARY = {
    "nonlinear critical speed": "Below it every motion dies out, whatever the disturbance; "
    "low-speed windows apart.",
    "linear critical speed": "Above it the vehicle hunts by itself: the centred motion is "
    "unstable.",
    "conditional band": "Between the two critical speeds it depends on the size of the "
    "disturbance.",
    "hunting frequency": "Frequency of the motion at V_lin.",
    "wavelength": "Distance travelled in one hunting period at V_lin.",
    "subcritical": "Unstable limit cycles branch off downwards in speed: there is hunting below "
    "V_lin, and it sets in with a jump.",
    "supercritical": "Stable limit cycles branch off upwards in speed: hunting sets in softly, at "
    "V_lin; V_nl is the same speed.",
    "exact": "Limit cycles of the full equations, by harmonic balance.",
    "averaged": "Limit cycles by Bogoliubov's averaging to first order, the paper's method.",
    "averaging": "Bogoliubov's method to first order, the paper's.",
    "stable limit cycle": "A periodic motion that neighbouring motions approach: hunting.",
    "unstable limit cycle": "The threshold: larger disturbances grow, smaller ones die out.",
    "Hopf point": "The centred motion loses stability; limit cycles branch off.",
    "fold": "Two limit cycles meet; the lowest speed at which there is one.",
    "flange clearance": "Beyond it the flange touches the rail.",
    "baseline": "The design that was pinned: everything is compared with it.",
    "safe": "Every motion dies out.",
    "conditional": "Small disturbances die out, large ones grow into hunting.",
    "hunting": "Any disturbance grows.",
    "Bifurcation diagram": "The amplitude of every limit cycle over forward speed.",
    "Phase portraits": "Displacement against its rate: a periodic motion is a closed curve.",
    "Damping ratio": "How fast a small motion dies out, as a share of critical damping; below "
    "zero it grows.",
    "Root locus": "The eigenvalues of small motions as the speed rises; right of zero they grow.",
    "low-speed window": "Speeds at which the frame's own sway is excited: primary hunting.",
}
_MARKED = ("low-speed window", "unstable limit cycle", "fold", "averaging")
_WORDS = re.compile(rf"\b({'|'.join(_MARKED)})\b")


def term(word: str, shown: str = "", tag: str = "span", classes: str = "") -> str:
    """Return HTML of a word with its meaning in a bubble; `shown` is what stands for it."""
    return bubbled(shown or word, GLOSSARY[word], tag, classes)


def bubbled(shown: str, text: str, tag: str = "span", classes: str = "") -> str:
    """Return HTML of something with a text that appears with pointer, touch or keyboard."""
    return (
        f'<{tag} class="{f"term {classes}".strip()}" tabindex="0">{shown}'
        f'<span class="bubble" role="tooltip">{escape(text)}</span></{tag}>'
    )


def explained(sentence: str) -> str:
    """Return a sentence as a paragraph in which known terms explain themselves, once each.

    Examples
    --------
    >>> explained("no fold").startswith('<p>no <span class="term')
    True
    """
    met: set[str] = set()

    def mark(found: re.Match[str]) -> str:
        word = found[0]
        if word in met:
            return word
        met.add(word)
        return term(word)

    return f"<p>{_WORDS.sub(mark, escape(sentence, quote=False))}</p>"
