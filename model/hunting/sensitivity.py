"""What each parameter does to the critical speeds: d ln V/d ln p, by implicit differentiation.

The linear critical speed keeps an eigenvalue on the imaginary axis. With its left and right
eigenvectors l and r, l r = 1::

    dV_lin/dp = -Re(l dA/dp r)/Re(l dA/dV r)

The nonlinear one is a minimum of the speed V(Y, p) over the amplitude Y of limit cycles, so that
its derivative is that of V at given amplitude, whatever the amplitude itself does. With the
equations of harmonic balance R(u, p) = 0, in which Y is given and V one of the unknowns u::

    dV_nl/dp = dV/dp = -(dR/du)^-1 dR/dp, the row of V

A grazing fold sits just beyond the clearance, where the force bends sharply with Y and delta, but
smoothly with delta at given Y/delta. As speed is stationary, either may be held.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from scipy.optimize import root_scalar

from hunting.bogoliubov import Averaging, averaging
from hunting.cases import Vehicle
from hunting.critical_speeds import critical_speeds
from hunting.elements import Array
from hunting.harmonic_balance import Balance, Cycles, at_amplitude, solve
from hunting.limit_cycles import limit_cycles
from hunting.lure import LureSystem
from hunting.parameters import Parameters, check_one_design
from hunting.ports import Ports
from hunting.stability import hopf_points

_STEP = 1e-3  # relative; matrices and forces are rational in p, the error below 1e-11
_NODES = _STEP * np.array([-2, -1, 1, 2])
_SAME = 1e-3  # relative difference of speed up to which a cycle counts as that of the fold


@dataclass(frozen=True)
class Sensitivity:
    """Relative change of the critical speeds over that of each parameter.

    Attributes
    ----------
    names : tuple of str
        The 22 fields of the parameters.
    linear, nonlinear : ndarray, shape (22,)
        d ln V_lin/d ln p and d ln V_nl/d ln p: by how many percent a speed rises with one percent
        more of p. NaN where there is no such speed.
    V_linear, V_nonlinear : float
        The speeds themselves [m/s].
    message : str
        Why values are missing; empty if none is.
    """

    names: tuple[str, ...]
    linear: Array
    nonlinear: Array
    V_linear: float
    V_nonlinear: float
    message: str

    def of(self, name: str) -> tuple[float, float]:
        """Return d ln V_lin/d ln p and d ln V_nl/d ln p of one parameter."""
        k = self.names.index(name)
        return float(self.linear[k]), float(self.nonlinear[k])


def sensitivity(vehicle: Vehicle, parameters: Parameters) -> Sensitivity:
    """Return d ln V/d ln p of the linear and the nonlinear critical speed for all 22 parameters.

    Parameters
    ----------
    vehicle : callable
        `wheelset` or `bogie`.
    parameters : Parameters
        The design, as numbers.

    Returns
    -------
    Sensitivity

    Raises
    ------
    ValueError
        If the parameters are arrays.

    Notes
    -----
    Limit cycles are those of harmonic balance. A parameter that is zero has no relative change;
    its entry is zero.

    Examples
    --------
    >>> from hunting import RECONSTRUCTED, bogie, sensitivity
    >>> linear, nonlinear = sensitivity(bogie, RECONSTRUCTED).of("delta")
    >>> round(linear, 3), round(nonlinear, 3)
    (0.0, -0.084)
    """
    check_one_design(parameters)
    names = tuple(f.name for f in Parameters.fields())
    system = vehicle(parameters)
    points = hopf_points(system)
    speeds = critical_speeds(system, points=points)
    linear, nonlinear = np.full((2, len(names)), np.nan)
    message = str(speeds.message)
    if np.isfinite(speeds.linear):
        hopf, nearby = averaging(system, points), _nearby(vehicle, parameters)
        linear = _of_hopf_point(hopf, nearby)
        if speeds.criticality == "supercritical":
            nonlinear = linear
        elif np.isfinite(speeds.nonlinear):
            balance, cycle = _cycle(hopf, system, float(speeds.amplitude))
            if abs(cycle.V[0] / speeds.nonlinear - 1) < _SAME:
                nonlinear = _of_cycle(balance, cycle, nearby)
            else:
                message = "the limit cycle at the nonlinear critical speed was not found"
    return Sensitivity(
        names,
        linear,
        nonlinear,
        float(speeds.linear),
        float(speeds.nonlinear),
        message,
    )


def _nearby(vehicle: Vehicle, parameters: Parameters) -> LureSystem:
    """Return systems with one parameter changed each, a little less and a little more.

    Returns
    -------
    LureSystem
        A stack of 22 times 4.
    """
    fields = Parameters.fields()
    changes = 1 + np.eye(len(fields))[:, :, None] * _NODES
    values = {
        f.name: getattr(parameters, f.name) * change
        for f, change in zip(fields, changes, strict=True)
    }
    return vehicle(Parameters(**values))


def _of_hopf_point(hopf: Averaging, nearby: LureSystem) -> Array:
    r, l, V = hopf.right[0], hopf.left[0], hopf.speed[0]
    grows = np.einsum("i,pij,j->p", l, _slope(nearby.matrix(V)), r).real
    return -grows / hopf.growth[0].real / V


def _slope(values: Array) -> Array:
    """Return the derivative with ln p of values of shape (22, 4, ...); exactly 0 if all agree."""
    far, near = values[:, 3] - values[:, 0], values[:, 2] - values[:, 1]
    return (8 * near - far) / (12 * _STEP)


def _of_cycle(balance: Balance, cycle: Cycles, nearby: LureSystem) -> Array:
    """Differentiate the speed at the fold, which is near `cycle`."""
    delta = float(balance.ports.system.clearance)
    cycle = _at_fold(balance, cycle, delta)
    _, J = balance.newton_system(cycle, at_amplitude(cycle.Y))
    speed_row = np.zeros(J.shape[-1])
    speed_row[-3] = 1.0  # unknowns end with V, omega and Y
    adjoint = np.linalg.solve(J[0].T, speed_row)

    count = int(np.prod(nearby.shape))
    around = nearby.take(np.arange(count))
    relative = np.asarray(around.clearance) / delta
    cycles = cycle[np.zeros(count, dtype=int)]
    if cycle.Y[0] > (1 + 2 * _NODES[0]) * delta:  # else none of them touches
        cycles = replace(cycles, Y=cycles.Y * relative)
    shared = replace(balance, ports=Ports.of(around))
    residual, _ = shared.newton_system(cycles, at_amplitude(cycles.Y))
    return -_slope(residual.reshape(*nearby.shape, -1)) @ adjoint / cycle.V[0]


def _cycle(hopf: Averaging, system: LureSystem, Y: float) -> tuple[Balance, Cycles]:
    """Return the limit cycle of amplitude Y with all its harmonics as unknowns."""
    right, left = hopf.right[0], hopf.left[0]
    branch = limit_cycles(system, [Y])
    X = branch.harmonics[-1:] / Y
    balance = Balance(Ports.of(system), right, left, np.array(branch.orders))
    guess = Cycles(
        U=balance.seen(X),
        kappa=X[:, 0] @ left,
        V=branch.speed[-1:],
        omega=branch.frequency[-1:],
        Y=branch.amplitude[-1:],
        tail=X[:, :0],
    )
    return balance, solve(balance, guess, at_amplitude(guess.Y), tolerance=1e-10).cycles


def _at_fold(balance: Balance, cycle: Cycles, delta: float) -> Cycles:
    """Return the cycle at which dV/dY = 0 to rounding, given one close by.

    Critical speeds need no more than the speed, which hardly depends on the amplitude there; but
    what the rail stiffness does depends on how far the flange is pressed. Beyond the clearance,
    dV/dY is next to linear in w = sqrt(Y/delta - 1), below it in Y itself.
    """
    Y = float(cycle.Y[0])
    pressed = delta < Y
    near = cycle

    def at(s: float) -> Cycles:
        amplitude = np.array([delta * (1 + s**2 if pressed else s)])
        return replace(near, Y=amplitude)

    def slope(s: float) -> float:
        nonlocal near
        found = solve(balance, at(s), at_amplitude(at(s).Y), tolerance=1e-9)
        if found.converged[0]:
            near = found.cycles
        return float(found.V_slope[0])

    start = np.sqrt(Y / delta - 1) if pressed else Y / delta
    root = root_scalar(slope, x0=start, x1=1.01 * start, rtol=1e-9, maxiter=12)
    return near if root.converged and abs(root.root / start - 1) < 0.5 else cycle
