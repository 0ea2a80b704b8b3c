"""The equations of motion: parameters in, Lur'e system out.

With s = 1 + r0 lambda/d and forward speed V (Eqs. 1, 4, 5 and 7, misprints corrected)::

    m_w y''    = -(2 f11/V)(s y' - V psi) - (2 f12/V) psi' - W_A (lambda/d) y
                 - 2 K_y (y - z) - 2 C_y (y' - z') - F_T(y)
    I_wx psi'' = -I_wy V lambda/(r0 d) y' - (2 d lambda f33/r0) y + (2 f12/V)(s y' - V psi)
                 - (2/V)(d^2 f33 + f22) psi' + d W_A lambda psi - 2 K_psi b^2 psi - 2 b F_d(b psi')
    m_B z''    = -2 K_y (z - y) - 2 C_y (z' - y')

    F_T(y)     = K_r (y -+ delta) beyond the clearance, else 0                              (Eq. 3)
    F_d(v)     = C1 v + C2 v|v| + C3 v^3 + C4 v^3|v|                                        (Eq. 6)

This is the only file that knows them. ``wheelset`` holds the frame still (z = z' = 0).
"""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np

from hunting.elements import Array, Coefficient, DeadbandSpring, PolynomialDamper
from hunting.lure import Connection, LureSystem, State
from hunting.parameters import Parameters

Vehicle = Callable[[Parameters], LureSystem]
Entries = Mapping[tuple[str, str], Coefficient]

_WHEELSET_STATES = (
    State("lateral displacement", "y", "m"),
    State("lateral velocity", "y'", "m/s"),
    State("yaw angle", "ψ", "rad"),
    State("yaw rate", "ψ'", "rad/s"),
)
_FRAME_STATES = (
    State("frame displacement", "z", "m"),
    State("frame velocity", "z'", "m/s"),
)


def wheelset(p: Parameters) -> LureSystem:
    """Return the wheelset on a frame that is held still: 4 states y, y', psi, psi'.

    Parameters
    ----------
    p : Parameters
        Numbers or arrays; arrays lead the matrix axes of the result.

    Returns
    -------
    LureSystem

    Examples
    --------
    >>> from hunting import RECONSTRUCTED, wheelset
    >>> wheelset(RECONSTRUCTED).matrix(40.0).shape
    (4, 4)
    """
    return _system(p, _WHEELSET_STATES, _wheelset_entries(p))


def bogie(p: Parameters) -> LureSystem:
    """Return the wheelset under a frame free to move sideways: 6 states y, y', psi, psi', z, z'.

    Parameters
    ----------
    p : Parameters
        Numbers or arrays; arrays lead the matrix axes of the result.

    Returns
    -------
    LureSystem

    Examples
    --------
    >>> from hunting import RECONSTRUCTED, bogie
    >>> bogie(RECONSTRUCTED.replace(Ky=[6e4, 8e4, 1e5])).matrix(40.0).shape
    (3, 6, 6)
    """
    A0, A1, A2 = _wheelset_entries(p)
    return _system(p, _WHEELSET_STATES + _FRAME_STATES, ({**A0, **_frame_entries(p)}, A1, A2))


def _wheelset_entries(p: Parameters) -> tuple[Entries, Entries, Entries]:
    """Eqs. 1, 4 and 5 as the entries of A0, A1 and A2 by state symbols."""
    s = 1 + p.r0 * p.lam / p.d
    A0 = {
        ("y", "y'"): 1.0,
        ("y'", "y"): -(p.W_A * p.lam / p.d + 2 * p.Ky) / p.m_w,
        ("y'", "y'"): -2 * p.Cy / p.m_w,
        ("y'", "ψ"): 2 * p.f11 / p.m_w,
        ("ψ", "ψ'"): 1.0,
        ("ψ'", "y"): -2 * p.d * p.lam * p.f33 / p.r0 / p.I_wx,
        ("ψ'", "ψ"): (-2 * p.f12 + p.d * p.W_A * p.lam - 2 * p.Kpsi * p.b**2) / p.I_wx,
        ("ψ'", "ψ'"): -2 * p.b**2 * p.C1 / p.I_wx,
    }
    A1 = {
        ("y'", "y'"): -2 * p.f11 * s / p.m_w,
        ("y'", "ψ'"): -2 * p.f12 / p.m_w,
        ("ψ'", "y'"): 2 * p.f12 * s / p.I_wx,
        ("ψ'", "ψ'"): -2 * (p.d**2 * p.f33 + p.f22) / p.I_wx,
    }
    A2 = {("ψ'", "y'"): -p.I_wy * p.lam / (p.r0 * p.d) / p.I_wx}
    return A0, A1, A2


def _frame_entries(p: Parameters) -> Entries:
    """Eq. 7, and the frame's part of the suspension force in Eq. 2, as entries of A0."""
    return {
        ("y'", "z"): 2 * p.Ky / p.m_w,
        ("y'", "z'"): 2 * p.Cy / p.m_w,
        ("z", "z'"): 1.0,
        ("z'", "y"): 2 * p.Ky / p.m_B,
        ("z'", "y'"): 2 * p.Cy / p.m_B,
        ("z'", "z"): -2 * p.Ky / p.m_B,
        ("z'", "z'"): -2 * p.Cy / p.m_B,
    }


def _system(
    p: Parameters, states: tuple[State, ...], entries: tuple[Entries, Entries, Entries]
) -> LureSystem:
    index = {state.symbol: i for i, state in enumerate(states)}
    n = len(states)

    def matrix(entries: Entries) -> Array:
        M = np.zeros((*p.shape, n, n))
        for (row, column), value in entries.items():
            M[..., index[row], index[column]] = value
        return M

    def unit_row(symbol: str, value: Coefficient = 1.0) -> Array:
        row = np.zeros((*np.shape(value), 1, n))
        row[..., 0, index[symbol]] = value
        return row

    def unit_column(symbol: str, value: Coefficient) -> Array:
        return np.swapaxes(unit_row(symbol, value), -1, -2)

    flange = Connection(
        DeadbandSpring(p.Kr, p.delta), C=unit_row("y"), B=unit_column("y'", -1 / p.m_w)
    )
    damper = Connection(
        PolynomialDamper(p.C1, p.C2, p.C3, p.C4),
        C=unit_row("ψ'", p.b),
        B=unit_column("ψ'", -2 * p.b / p.I_wx),
    )
    A0, A1, A2 = map(matrix, entries)
    return LureSystem(
        A0, A1, A2, (flange, damper), states, output=unit_row("y")[0], clearance=p.delta
    )
