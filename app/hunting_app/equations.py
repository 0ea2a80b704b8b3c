"""The equations, the misprints and the sources, for the Model page. Data only."""

from __future__ import annotations

from typing import NamedTuple


class Equation(NamedTuple):
    """A formula in the notation of formula.py, with the paper's number."""

    number: str
    name: str
    formula: str
    note: str = ""


MOTION = (
    Equation(
        "1",
        "lateral motion of the wheelset",
        r"m_w y'' = -\frac{2 f_{11}}{V}(s y' - V ψ) - \frac{2 f_{12}}{V} ψ' - \frac{W_A λ}{d} y"
        r" + F_{sy} - F_T(y), \quad s = 1 + \frac{r_0 λ}{d}",
    ),
    Equation(
        "2",
        "lateral force of the primary suspension",
        r"F_{sy} = -2 K_y (y - z) - 2 C_y (y' - z')",
    ),
    Equation(
        "3",
        "flange force, a spring behind a dead band",
        r"F_T(y) = K_r (y ∓ δ) \text{ for } |y| > δ, \quad 0 \text{ else}",
    ),
    Equation(
        "4",
        "yaw motion of the wheelset",
        r"I_{wx} ψ'' = -\frac{I_{wy} V λ}{r_0 d} y' - \frac{2 d λ f_{33}}{r_0} y"
        r" + \frac{2 f_{12}}{V}(s y' - V ψ) - \frac{2}{V}(d^2 f_{33} + f_{22}) ψ'"
        r" + d W_A λ ψ + M_{sψ}",
    ),
    Equation(
        "5",
        "yaw moment of springs and yaw dampers",
        r"M_{sψ} = -2 K_ψ b^2 ψ - 2 b F_d(b ψ')",
    ),
    Equation(
        "6",
        "force of one yaw damper at the velocity v",
        r"F_d(v) = C_1 v + C_2 v|v| + C_3 v^3 + C_4 v^3|v|",
    ),
    Equation(
        "7",
        "lateral motion of the frame (bogie only; for the wheelset z = 0)",
        r"m_B z'' = -2 K_y (z - y) - 2 C_y (z' - y')",
    ),
)

METHOD = (
    Equation(
        "",
        "all of it as a Lur'e system: a linear part and two scalar nonlinearities",
        r"x' = A(V) x + b_1 φ_1(c_1 x) + b_2 φ_2(c_2 x),"
        r" \quad A(V) = A_0 + \frac{1}{V} A_1 + V A_2",
        "At a Hopf point V<sub>c</sub> a pair of eigenvalues of A is ± iω, "
        "with right and left eigenvectors r and l, l r = 1.",
    ),
    Equation(
        "11, 12",
        "slowly varying amplitude and phase",
        r"x = a \text{ Re}(r e^{i φ}), \quad \frac{da}{dt} = A_1(a, V),"
        r" \quad \frac{dφ}{dt} = ω + B_1(a, V)",
    ),
    Equation(
        "13",
        "the averages over one period, in closed form",
        r"A_1 = a \text{ Re}[l A'(V_c) r (V - V_c) + l N(a) r],"
        r" \quad B_1 = \text{Im}[l A'(V_c) r (V - V_c) + l N(a) r]",
        "N(a) is made of the describing functions of the flange and of the yaw damper:",
    ),
    Equation(
        "",
        "describing function of the flange at the amplitude Y > δ",
        r"N_T = K_r [1 - \frac{2}{π}(\asin ρ + ρ \sqrt{1 - ρ^2})], \quad ρ = \frac{δ}{Y}",
    ),
    Equation(
        "",
        "describing function of the damper at the velocity amplitude v",
        r"N_d = C_1 + \frac{8 C_2}{3 π} v + \frac{3}{4} C_3 v^2 + \frac{32 C_4}{15 π} v^3",
    ),
    Equation(
        "",
        "the branch of limit cycles, where the amplitude rests",
        r"V(a) = V_c - \frac{\text{Re}[l N(a) r]}{\text{Re}[l A'(V_c) r]}",
        "A cycle is stable where dA<sub>1</sub>/da &lt; 0. The lowest V on a branch that begins "
        "towards lower speeds is the fold: the nonlinear critical speed.",
    ),
)


class Misprint(NamedTuple):
    """What the paper prints, why that cannot be meant, and what is computed instead."""

    printed: str
    why: str
    used: str


MISPRINTS = (
    Misprint(
        "Eq. 2: suspension force −2 K_y y − 2 C_y y′",
        "Eq. 7 has the opposite force with y − z, and the paper's matrix has columns for z",
        "K_y (y − z), C_y (y′ − z′)",
    ),
    Misprint(
        "Eq. 4: gyroscopic term I_wy V/(r0 d) ψ′",
        "λ is missing and the velocity is the wrong one; the matrix has both right",
        "I_wy V λ/(r0 d) y′",
    ),
    Misprint("Eq. 4: bracket with f12 on ψ′", "the units do not fit", "(2 f12/V)(s y′ − V ψ)"),
    Misprint("Eq. 4: last term 2 f12/V ψ′", "the units do not fit", "(2 f22/V) ψ′"),
    Misprint("Eq. 5: 2 b C1 ψ′", "the units do not fit; the matrix has b²", "2 b² C1 ψ′"),
    Misprint(
        "C1 in Eq. 5 and once more in F_d",
        "counted twice, averaging would not return V_c as the amplitude goes to 0",
        "counted once",
    ),
    Misprint("matrix entry (4,3): 2 K_y b²", "Eq. 5 has K_ψ there", "2 K_ψ b²"),
    Misprint(
        "matrix entry (2,2): C_y + (2 f11/V) s, times 2/m_w",
        "f11 twice as large as in Eq. 1",
        "C_y + (f11/V) s",
    ),
    Misprint("F_1, row 2, ψ′: f11", "Eq. 1 has f12 there", "f12"),
    Misprint("Eq. 6 for negative velocities: −C3 v³", "the force would not be odd", "+C3 v³"),
    Misprint("Table 1: f13", "the nomenclature and Eq. 4 call it f33", "f33"),
    Misprint("Table 1: no m_B", "Fig. 14 varies it from 15 t to 45 t", "45 t, adjustable"),
    Misprint("Eq. 12: dψ/dt = ω + …", "it is the phase, not the yaw angle", "dφ/dt"),
    Misprint("Section 4.8: “d = 1 m”", "the section is about b", "b = 1 m"),
)

RECONSTRUCTION = {
    "m_w": "fitted: with the printed mass the radius of gyration would exceed the half axle",
    "f11": "exponent: by Kalker's theory f33/f11 is near 1.2, printed it is 12",
    "Kpsi": "exponent: then it equals K_y numerically, as the misprint in the matrix suggests",
    "W_A": "exponent: printed it is an axle load of 1.8 t",
    "C2": "sign, and fitted: only C2 < 0 is subcritical, which Figs. 12 and 13 need",
}

SOURCES = (
    "The paper: “Parameters' changing influence with different lateral stiffnesses on nonlinear "
    "analysis of hunting behavior of a bogie”, received 15 April 2013, accepted 6 December 2013.",
    "N. N. Bogoliubov and Y. A. Mitropolsky, Asymptotic Methods in the Theory of Non-Linear "
    "Oscillations, 1961: the method of averaging.",
    "W. Govaerts, Numerical Methods for Bifurcations of Dynamical Equilibria, SIAM 2000, ch. 5: "
    "Hopf points as an eigenvalue problem, without a grid of speeds.",
    "J. J. Kalker, Three-Dimensional Elastic Bodies in Rolling Contact, 1990: creep coefficients.",
    "M. Okabe and K. Ito, Color Universal Design, 2008: the colours.",
)
