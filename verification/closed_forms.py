"""Limits that can be written down: Klingel's wavelength, and the critical speed at stiff creep.

A wheelset without dampers, spin creep, gyroscopic coupling and gravity stiffness obeys, with
s = 1 + r0 lambda/d, K = 2 K_psi b^2 and K_y' = 2 K_y::

    m y''    = -(2 f11/V)(s y' - V psi) - K_y' y
    I psi''  = -(2 d lambda f33/r0) y - (2 d^2 f33/V) psi' - K psi

Its characteristic equation at i w gives, for any creep,

    w^2   = (s f11 K + d^2 f33 K_y')/(s f11 I + d^2 f33 m)
    V_c^2 = d^2 s w^2/(d lambda/r0 + (K_y' - m w^2)(K - I w^2)/(4 f11 f33))

and with stiff creep V_c^2 -> (r0 d s/lambda) w^2. The textbook forms have s = 1. Here s - 1 is
3.7 %; with r0 and lambda both k times as small it is k^2 times that, and all else stays.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from hunting import RECONSTRUCTED, Parameters, eigenvalues, hopf_points, wheelset
from verification.row import Row

BARE = RECONSTRUCTED.replace(
    **dict.fromkeys(["Cy", "C1", "C2", "C3", "C4", "f12", "f22", "I_wy", "W_A"], 0.0)
)
LOOSE = BARE.replace(Ky=1e-6, Kpsi=0.0)
SLIM = 1e-4  # k: wheel radius and conicity of the textbook's wheelset over Table 1's


def rows() -> Iterator[Row]:
    """Compare with the closed forms, creep growing from line to line."""
    for creep in (0.1, 1, 10, 100):
        p = _scaled(LOOSE, creep, SLIM)
        yield Row(
            f"Klingel's wavelength 2π√(r0 d/λ) at 36 km/h, creep × {creep} [m]",
            _wavelength(p, 10.0),
            _klingel(p),
            1e-5 / creep**2,
        )
    p = _scaled(LOOSE, 100, 1)
    yield Row(
        "the same with Table 1's conicity: 2π√(s r0 d/λ), creep × 100 [m]",
        _wavelength(p, 10.0),
        np.sqrt(_s(p)) * _klingel(p),
        1e-7,
    )
    for creep in (0.1, 1, 10, 100):
        p = _scaled(BARE, creep, SLIM)
        yield Row(
            f"V_c at stiff creep, (r0 d/λ)(K f11 + K_y' d² f33)/(I f11 + m d² f33), "
            f"creep × {creep} [km/h]",
            3.6 * _critical_speed(p),
            3.6 * _stiff_creep(p),
            5e-5 / creep**2,
        )
    for creep in (1, 0.1):
        p = _scaled(BARE, creep, 1)
        yield Row(
            f"V_c at any creep with s = 1 + r0 λ/d, creep × {creep} [km/h]",
            3.6 * _critical_speed(p),
            3.6 * _finite_creep(p),
            1e-10,
        )


def _scaled(p: Parameters, creep: float, slim: float) -> Parameters:
    return p.replace(f11=p.f11 * creep, f33=p.f33 * creep, r0=p.r0 * slim, lam=p.lam * slim)


def _s(p: Parameters) -> float:
    return float(1 + p.r0 * p.lam / p.d)


def _wavelength(p: Parameters, V: float) -> float:
    """Return the wavelength of the least damped oscillation [m]."""
    values = eigenvalues(wheelset(p), V)
    hunting = values[values.imag > 0]
    return float(2 * np.pi * V / hunting[np.argmax(hunting.real)].imag)


def _klingel(p: Parameters) -> float:
    return float(2 * np.pi * np.sqrt(p.r0 * p.d / p.lam))


def _critical_speed(p: Parameters) -> float:
    (speed,) = hopf_points(wheelset(p)).speed
    return float(speed)


def _frequency_squared(p: Parameters, s: float) -> float:
    lateral, yaw = 2 * p.Ky, 2 * p.Kpsi * p.b**2
    sideways, forwards = s * p.f11, p.d**2 * p.f33
    return float((sideways * yaw + forwards * lateral) / (sideways * p.I_wx + forwards * p.m_w))


def _stiff_creep(p: Parameters) -> float:
    return float(np.sqrt(p.r0 * p.d / p.lam * _frequency_squared(p, 1.0)))


def _finite_creep(p: Parameters) -> float:
    s = _s(p)
    square = _frequency_squared(p, s)
    lateral, yaw = 2 * p.Ky - p.m_w * square, 2 * p.Kpsi * p.b**2 - p.I_wx * square
    steering = p.d * p.lam / p.r0 + lateral * yaw / (4 * p.f11 * p.f33)
    return float(np.sqrt(p.d**2 * s * square / steering))
