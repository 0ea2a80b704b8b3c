"""Nonlinear hunting of a railway wheelset and its bogie frame.

From parameters to critical speeds and limit cycles in milliseconds: eigenvalues and Hopf points,
Bogoliubov's averaged amplitude, linear and nonlinear critical speeds. SI units throughout.
"""

from __future__ import annotations

from hunting.bogoliubov import Averaging, averaged_branch, averaging
from hunting.branch import Branch, LimitCycle, Motion
from hunting.cases import Cancelled
from hunting.claims import Claim, claims
from hunting.critical_speeds import CriticalSpeeds, critical_speeds
from hunting.design import Design, design
from hunting.elements import DeadbandSpring, PolynomialDamper
from hunting.limit_cycles import limit_cycles
from hunting.lure import Connection, LureSystem, State
from hunting.parameters import RECONSTRUCTED, TABLE_1, Field, Parameters
from hunting.sensitivity import Sensitivity, sensitivity
from hunting.simulation import Decay, SpeedRamp, Trajectory, decays, simulate, speed_ramp
from hunting.stability import HopfPoints, damping_ratios, eigenvalues, hopf_points
from hunting.study import Figure, figure, figures
from hunting.sweeps import Sweep, sweep, sweeps
from hunting.uncertainty import Indices, Uncertainty, uncertainty
from hunting.vehicles import bogie, wheelset

__all__ = [
    "RECONSTRUCTED",
    "TABLE_1",
    "Averaging",
    "Branch",
    "Cancelled",
    "Claim",
    "Connection",
    "CriticalSpeeds",
    "DeadbandSpring",
    "Decay",
    "Design",
    "Field",
    "Figure",
    "HopfPoints",
    "Indices",
    "LimitCycle",
    "LureSystem",
    "Motion",
    "Parameters",
    "PolynomialDamper",
    "Sensitivity",
    "SpeedRamp",
    "State",
    "Sweep",
    "Trajectory",
    "Uncertainty",
    "averaged_branch",
    "averaging",
    "bogie",
    "claims",
    "critical_speeds",
    "damping_ratios",
    "decays",
    "design",
    "eigenvalues",
    "figure",
    "figures",
    "hopf_points",
    "limit_cycles",
    "sensitivity",
    "simulate",
    "speed_ramp",
    "sweep",
    "sweeps",
    "uncertainty",
    "wheelset",
]
