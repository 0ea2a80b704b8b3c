"""Motion in time: many disturbances at once, whether they die out, and speed ramps."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from hunting.elements import Array
from hunting.lure import LureSystem
from hunting.marching import Crests, March

TOLERANCE = 3e-4
LONGEST_STEP = 0.08  # s
REACH = 1.6  # times the clearance: where the model's range ends
MOST_STEPS = 100_000  # of a motion; some 20 s of work

_FULL_HUNT = 1.05  # times the clearance: where a ramp down begins

_SETTLING = 10  # dwells that a hunt may take to settle before a ramp down
_HELD = 0.9  # share of its envelope that a hunt must be heading for to count as held
_LONGEST_WINDOW = 10.0  # s
_LOOKED_AT = 8  # windows over which an envelope is judged
_SHRINKS = 0.98  # the largest ratio of successive changes of an envelope that settles
_SETTLED = 1e-4  # change still to come, relative to the envelope
_ABATES = 1e-3  # relative fall from window to window of a rate that abates
_STEADY = 1e-7  # relative change from window to window that is none


@dataclass(frozen=True)
class Trajectory:
    """Motions over time; the leading axes are those of systems, speeds and initial states.

    Attributes
    ----------
    time : ndarray, shape (n_times,)
        Time [s], evenly spaced from 0.
    state : ndarray, shape (..., n_times, n)
        States in the order of `LureSystem.states`; NaN once a motion has left the model's range.
    forces : dict of str to ndarray, shape (..., n_times)
        Whole force of each element.
    crest_time, crest : ndarray, shape (..., k)
        Instants [s] and heights [m] of the local extremes of |output|, located between the
        samples too; padded with NaN. They are the envelope of the motion.
    peak_forces : dict of str to float or ndarray, shape (...)
        Largest size of each force: of contacts at the very crests, of the others at the samples.
    ended : float or ndarray, shape (...)
        When the motion was stopped [s]; the last `time` if it was not.
    message : str or ndarray of str, shape (...)
        Why it was stopped, in words; empty if it was not.
    system : LureSystem
        The system that moves.
    """

    time: Array
    state: Array
    forces: dict[str, Array]
    crest_time: Array
    crest: Array
    peak_forces: dict[str, float | Array]
    ended: float | Array
    message: str | Array
    system: LureSystem

    def peak(self, since: float = 0.0) -> float | Array:
        """Return the largest |output| [m] from `since` [s] on, NaN if the motion had ended by then.

        Parameters
        ----------
        since : float, default 0
            Start of the time looked at [s].

        Returns
        -------
        float or ndarray, shape (...)
        """
        sampled = np.abs(self.state[..., self.time >= since, :] @ self.system.output)
        crest = np.where(self.crest_time >= since, self.crest, np.nan)
        highest = np.fmax.reduce(np.concatenate([sampled, crest], axis=-1), axis=-1, initial=-1.0)
        return _plain(np.where(highest < 0, np.nan, highest))


def simulate(
    system: LureSystem,
    speed: ArrayLike,
    initial: ArrayLike,
    duration: float,
    *,
    samples: float = 200.0,
    tolerance: float = TOLERANCE,
    step: float = LONGEST_STEP,
    reach: float = REACH,
    most_steps: int = MOST_STEPS,
) -> Trajectory:
    """Return the motions that start at given states.

    Parameters
    ----------
    system : LureSystem
        One system or a stack of them.
    speed : array_like
        Forward speed [m/s]; broadcasts with the stack.
    initial : array_like, shape (..., n)
        States at time 0; their leading axes broadcast with the stack and the speeds.
    duration : float
        Time simulated [s].
    samples : float, default 200
        Instants per second that are returned. Has no bearing on the accuracy.
    tolerance : float, default 3e-4
        Error of one step in what the damper sees, relative to its recent peak, as estimated from
        the last two of the eight Legendre coefficients of its force; the error of the motion is
        smaller by orders (see Notes).
    step : float, default 0.08
        Longest step [s]. Steps are halved where the tolerance asks for it.
    reach : float, default 1.6
        A motion is stopped where |output| exceeds this multiple of the clearance: the model was
        never made for more.
    most_steps : int, default 100,000
        A motion is stopped where it takes more steps than that: with parameters far beyond any
        vehicle's it may shake a million times a second.

    Returns
    -------
    Trajectory

    Raises
    ------
    ValueError
        If an argument is not finite, not positive, or of the wrong shape.

    Notes
    -----
    Exponential collocation, see `hunting.collocation`: the linear part is propagated exactly,
    whatever its stiffness, the damper's force by a polynomial of degree 7 in each step, and steps
    end where a contact opens or closes or the damper's velocity changes sign. Measured error of
    the peak |y| in the last of 20 s, relative: at most 1.4e-6 for a hundred motions of the bogie
    between 133 and 149 km/h at the default tolerance and 2e-7 at 1e-5; at most 4e-5 for 270
    motions of vehicles drawn at random within a factor of 2.

    Examples
    --------
    >>> from hunting import RECONSTRUCTED, simulate, wheelset
    >>> moved = simulate(wheelset(RECONSTRUCTED), 41.5, [[0.003, 0, 0, 0], [0.008, 0, 0, 0]], 20.0)
    >>> (1e3 * moved.peak(since=19.0)).round(2)  # mm: one has shrunk, one has met the flange
    array([2.38, 9.4 ])
    """
    speed, initial = _motions(system, speed, initial)
    duration, samples, tolerance, step = (
        _positive(name, value, unit)
        for name, value, unit in (
            ("duration", duration, "s"),
            ("samples", samples, "1/s"),
            ("tolerance", tolerance, ""),
            ("step", step, "s"),
        )
    )
    count = max(1, round(duration * samples))
    march = March(
        system,
        speed,
        initial,
        tolerance=tolerance,
        step=step,
        reach=_reach(reach),
        most_steps=_positive("most_steps", most_steps, ""),
        sample=duration / count,
    )
    start = march.state.copy()
    crests, steps = march.run(duration, keep=True)
    states = np.concatenate([start[:, None], march.sampled(steps, count)], axis=1)
    state = states.reshape(*march.shape, count + 1, -1)
    forces = system.with_axes().forces(state)
    crest_time, crest = _padded(crests, duration, march.shape)
    return Trajectory(
        time=np.linspace(0, duration, count + 1),
        state=state,
        forces=forces,
        crest_time=crest_time,
        crest=crest,
        peak_forces=_peak_forces(system, forces, march.contact_peak.reshape(*march.shape, -1)),
        ended=_plain(np.minimum(march.ended, duration).reshape(march.shape)),
        message=_plain(np.array(_endings(march, reach), dtype=np.str_).reshape(march.shape)),
        system=system,
    )


@dataclass(frozen=True)
class Decay:
    """Whether disturbances die out; floats, bools and strings for a single one.

    Attributes
    ----------
    dies_out : bool or ndarray of bool, shape (...)
        Whether the disturbance dies out.
    decided : bool or ndarray of bool, shape (...)
        False where the horizon came before the answer; `dies_out` is False there.
    time : float or ndarray, shape (...)
        When |output| was last above a given share of its peak [s]; NaN unless it dies out within
        the horizon.
    amplitude : float or ndarray, shape (...)
        Envelope of |output| at the end [m]; NaN where the model's range was left.
    message : str or ndarray of str, shape (...)
        The verdict in words.
    """

    dies_out: bool | Array
    decided: bool | Array
    time: float | Array
    amplitude: float | Array
    message: str | Array


def decays(
    system: LureSystem,
    speed: ArrayLike,
    initial: ArrayLike,
    *,
    share: float = 0.01,
    horizon: float = 300.0,
    tolerance: float = TOLERANCE,
    reach: float = REACH,
    most_steps: int = MOST_STEPS,
) -> Decay:
    """Return whether disturbances die out, and how long it takes them.

    Parameters
    ----------
    system : LureSystem
        One system or a stack of them.
    speed : array_like
        Forward speed [m/s]; broadcasts with the stack.
    initial : array_like, shape (..., n)
        States at time 0; their leading axes broadcast with the stack and the speeds.
    share : float, default 0.01
        A disturbance has died out when its envelope is below this share of its peak, the centred
        motion being stable at that speed.
    horizon : float, default 300
        When to give up [s].
    tolerance, reach, most_steps
        As for `simulate`.

    Returns
    -------
    Decay

    Raises
    ------
    ValueError
        As for `simulate`.

    Notes
    -----
    The envelope is the largest |output| in each of a row of windows, two periods of the least
    damped mode long (of the slowest such mode among all the motions). It has settled when it has
    changed less and less over eight windows and what is still to come, summed as a geometric
    series, is below 1e-4 of it. A motion beside an unstable cycle changes more and more, however
    slowly, and has not settled; only one that starts on it to about seven digits is taken for a
    limit cycle. At the horizon a motion is said to die out if the relative rate at which its
    envelope shrinks has not abated over eight windows.

    Examples
    --------
    >>> from hunting import RECONSTRUCTED, decays, wheelset
    >>> y = np.array([0.004, 0.008])
    >>> decays(wheelset(RECONSTRUCTED), 41.0, y[:, None] * [1, 0, 0, 0]).message
    array(['dies out in 197.9 s', 'grows into a limit cycle of 9.36 mm'], dtype='<U35')
    """
    speed, initial = _motions(system, speed, initial)
    share, horizon = _positive("share", share, ""), _positive("horizon", horizon, "s")
    march = March(
        system,
        speed,
        initial,
        tolerance=_positive("tolerance", tolerance, ""),
        step=LONGEST_STEP,
        reach=_reach(reach),
        most_steps=_positive("most_steps", most_steps, ""),
    )
    stable, window = _centred_motion(march)
    N = len(march.time)
    envelope, when = np.abs(march.state @ march.output)[None], np.zeros((1, N))
    highest, last_above = envelope[0], np.zeros(N)
    dies, settled = np.zeros(N, dtype=bool), np.zeros(N, dtype=bool)
    for k in range(1, 1 + max(1, int(horizon / window))):
        going = march.ended == np.inf
        if not going.any():
            break
        crests, _ = march.run(k * window)
        height, time = _highest(march, crests)
        a = np.where(going, height, envelope[-1])
        highest = np.maximum(highest, a)
        tall = crests.height > share * highest[crests.motion]
        np.maximum.at(last_above, crests.motion[tall], crests.time[tall])
        envelope, when = np.vstack([envelope, a]), np.vstack([when, time])
        going = march.ended == np.inf
        dies |= going & stable & (a <= share * highest)
        settled |= going & ~dies & _has_settled(envelope)
        march.ended[dies | settled] = march.time[dies | settled]
    sinks = stable & (march.ended == np.inf) & _sinks(envelope, when)
    return _decay(march, envelope, last_above, dies, sinks, settled, horizon, reach)


@dataclass(frozen=True)
class SpeedRamp:
    """The bifurcation diagram as a test on track finds it.

    Attributes
    ----------
    speed : ndarray, shape (k,)
        Forward speeds [m/s], rising.
    up, down : ndarray, shape (..., k)
        Envelope of |output| at the end of the dwell [m], on the way up and on the way down; NaN
        where the motion left the model's range.
    jump_up : float or ndarray, shape (...)
        The first speed at which hunting is found on the way up [m/s]; NaN if there is none.
    jump_down : float or ndarray, shape (...)
        The last speed at which hunting is still found on the way down [m/s]: it is gone one step
        below. NaN if it is not there at the highest speed or still there at the lowest.
    dwell : float
        Time at each speed [s].
    step : float
        Largest step between speeds [m/s].
    message : str or ndarray of str, shape (...)
        Why a jump is missing, in words; empty if none is.
    """

    speed: Array
    up: Array
    down: Array
    jump_up: float | Array
    jump_down: float | Array
    dwell: float
    step: float
    message: str | Array


def speed_ramp(
    system: LureSystem,
    speeds: ArrayLike,
    *,
    dwell: float = 30.0,
    disturbance: float = 0.01,
    hunting: float = 0.5,
    tolerance: float = TOLERANCE,
    reach: float = REACH,
) -> SpeedRamp:
    """Return what ramping the speed up from a small disturbance and down from a full hunt finds.

    Parameters
    ----------
    system : LureSystem
        One system or a stack of them.
    speeds : array_like, shape (k,)
        Forward speeds [m/s], rising, at least two.
    dwell : float, default 30
        Time at each speed [s]. A ramp passes jumps late: just above the Hopf point disturbances
        grow, and about a smooth fold motions settle, too slowly for any dwell. Steps of 0.25 km/h
        find the folds of the test cases between 0 and 0.25 km/h too high: grazing ones with 20 s
        at each, smooth ones with 60 s.
    disturbance : float, default 0.01
        Lateral displacement that a dwell begins with where there is less, as a multiple of the
        clearance: no track is perfectly straight.
    hunting : float, default 0.5
        Envelope that counts as hunting, as a multiple of the clearance.
    tolerance, reach : float
        As for `simulate`.

    Returns
    -------
    SpeedRamp

    Raises
    ------
    ValueError
        If the speeds are not rising, or an argument is not finite and positive.

    Notes
    -----
    The way down begins at the highest speed with a displacement of 1.05 times the clearance, and
    up to ten dwells for the hunt to settle. Each dwell begins with the state the last one ended
    with. The envelope is that of the last fifth of the dwell. Where it still shrinks, the last
    three fifths tell what it tends to: the hunt is lost if that is less than nine tenths of it,
    as when it shrinks ever faster, beyond the fold. A motion that left the model's range counts
    as hunting.

    Examples
    --------
    >>> from hunting import RECONSTRUCTED, speed_ramp, wheelset
    >>> km_h = np.array([143.5, 144.0, 150.0, 156.0, 162.0])
    >>> found = speed_ramp(wheelset(RECONSTRUCTED), km_h / 3.6, disturbance=0.3)
    >>> round(3.6 * found.jump_up, 2), round(3.6 * found.jump_down, 2)  # hysteresis
    (162.0, 144.0)
    """
    V = np.asarray(speeds, dtype=float)
    if V.ndim != 1 or len(V) < 2 or not (np.isfinite(V).all() and V[0] > 0):
        raise ValueError(f"speeds must be at least two finite speeds > 0 m/s, got {speeds!r}")
    if not (np.diff(V) > 0).all():
        raise ValueError(f"speeds must be rising, got {speeds!r}")
    dwell = _positive("dwell", dwell, "s")
    small, large = (
        _positive(name, value, "") * np.asarray(system.clearance)
        for name, value in (("disturbance", disturbance), ("hunting", hunting))
    )
    tolerance, reach = _positive("tolerance", tolerance, ""), _reach(reach)
    shape = (2, *system.shape)
    aside = system.output / (system.output @ system.output)
    nudge = np.broadcast_to(small[..., None] * aside, (*shape, len(aside)))
    first = nudge.copy()
    first[1] = _FULL_HUNT * np.asarray(system.clearance)[..., None] * aside

    def stay(speed: Array, state: Array) -> tuple[Array, Array, Array]:
        """Return the envelopes after one dwell, whether motions hunt, and their states."""
        march = March(
            system,
            speed,
            state,
            tolerance=tolerance,
            step=LONGEST_STEP,
            reach=reach,
            most_steps=MOST_STEPS,
        )
        march.run(0.4 * dwell)
        fifths = [_highest(march, march.run(part * dwell)[0])[0] for part in (0.6, 0.8, 1.0)]
        envelope = np.reshape(fifths, (3, *march.shape))
        away = (march.ended < np.inf).reshape(march.shape)
        held = np.maximum(large, _HELD * envelope[-1])
        hunts = away | ((envelope[-1] > large) & (_tends_to(envelope) > held))
        return np.where(away, np.nan, envelope[-1]), hunts, march.state.reshape(state.shape)

    for _ in range(_SETTLING):
        envelope, hunts_on, state = stay(V[-1:].reshape((1,) * len(system.shape)), first[1])
        if (hunts_on | ~(envelope > large)).all():
            break
        first[1] = state
    state = first
    found, hunts = np.empty((len(V), *shape)), np.empty((len(V), *shape), dtype=bool)
    for k, pair in enumerate(zip(V, V[::-1], strict=True)):
        speed = np.reshape(pair, (2,) + (1,) * len(system.shape))
        found[k], hunts[k], state = stay(speed, state)
        state = np.where((found[k] < small)[..., None], nudge, state)
        state = np.where(np.isnan(found[k])[..., None], first, state)
    found, hunts = (np.moveaxis(part, 0, -1) for part in (found, hunts))
    return _ramp(V, found[0], found[1, ..., ::-1], hunts[0], hunts[1, ..., ::-1], dwell)


def _motions(system: LureSystem, speed: ArrayLike, initial: ArrayLike) -> tuple[Array, Array]:
    """Return speeds and initial states as arrays, or say what is wrong with them."""
    V = np.asarray(speed, dtype=float)
    x = np.asarray(initial, dtype=float)
    wrong = V[~((V > 0) & np.isfinite(V))]
    if wrong.size:
        raise ValueError(f"speed must be finite and > 0 m/s, got {wrong.flat[0]}")
    symbols = ", ".join(system.symbols)
    n = len(system.states)
    if x.ndim == 0 or x.shape[-1] != n:
        raise ValueError(
            f"initial must have the {n} states {symbols} as its last axis, got shape {x.shape}"
        )
    if not np.isfinite(x).all():
        raise ValueError(f"initial must be finite, got {x[~np.isfinite(x)].flat[0]}")
    try:
        np.broadcast_shapes(system.shape, V.shape, x.shape[:-1])
    except ValueError:
        raise ValueError(
            "the leading axes of system, speed and initial must broadcast, "
            f"got {system.shape}, {V.shape} and {x.shape[:-1]}"
        ) from None
    return V, x


def _positive(name: str, value: float, unit: str) -> float:
    if not 0 < value < np.inf:
        raise ValueError(f"{name} must be finite and > 0 {unit}".rstrip() + f", got {value!r}")
    return float(value)


def _reach(value: float) -> float:
    if not value > 0:
        raise ValueError(f"reach must be > 0 (times the clearance), got {value!r}")
    return float(value)


def _plain(values: Array) -> Any:
    """Return the item of an array without axes, other arrays as they are."""
    return values.item() if values.ndim == 0 else values


def _padded(crests: Crests, until: float, shape: tuple[int, ...]) -> tuple[Array, Array]:
    """Return times and heights of the crests up to `until`, one row for each motion."""
    motion, time, height = (part[crests.time <= until] for part in crests)
    order = np.lexsort((time, motion))
    number = int(np.prod(shape))
    found = np.bincount(motion, minlength=number)
    place = np.arange(len(motion)) - np.repeat(np.cumsum(found) - found, found)
    out = np.full((2, number, found.max(initial=0)), np.nan)
    out[:, motion[order], place] = time[order], height[order]
    rows = out.reshape(2, *shape, -1)
    return rows[0], rows[1]


def _peak_forces(
    system: LureSystem, forces: dict[str, Array], contact_peak: Array
) -> dict[str, float | Array]:
    peaks: dict[str, float | Array] = {}
    start = 0
    for link in system.elements:
        element = link.element
        if element.kink is None:
            highest = np.fmax.reduce(np.abs(forces[element.name]), axis=-1)
        else:
            port = slice(start, start + link.C.shape[-2])
            u = contact_peak[..., port]
            whole = np.asarray(element.linear)[..., None] * u + element.nonlinear(u)
            highest = np.abs(whole).max(axis=-1)
            start = port.stop
        peaks[element.name] = _plain(highest)
    return peaks


def _endings(march: March, reach: float) -> list[str]:
    """Return for each motion why it was stopped, or nothing."""
    return [
        ""
        if ended == np.inf
        else f"left the model's range, {reach:g} times the clearance, after {ended:.2f} s"
        if resolved
        else f"too fast to follow: given up after {ended:.2g} s and {march.most_steps:,.0f} steps"
        if taken > march.most_steps
        else f"could not be resolved beyond {ended:.2f} s: the shortest step is too long"
        for ended, resolved, taken in zip(march.ended, march.resolved, march.taken, strict=True)
    ]


def _centred_motion(march: March) -> tuple[Array, float]:
    """Return whether each centred motion is stable, and two of the longest least damped periods."""
    lam = np.linalg.eigvals(march.A)
    growth = np.where(lam.imag > 0, lam.real, -np.inf)
    least = np.take_along_axis(lam.imag, growth.argmax(axis=-1)[:, None], axis=-1)[:, 0]
    slowest = least[growth.max(axis=-1) > -np.inf].min(initial=np.inf)
    window = np.clip(4 * np.pi / slowest, 10 * LONGEST_STEP, _LONGEST_WINDOW)
    return (lam.real.max(axis=-1) < 0)[march.case], float(window)


def _highest(march: March, crests: Crests) -> tuple[Array, Array]:
    """Return the largest |output| of each motion among crests and present state, and its time."""
    highest, when = np.abs(march.state @ march.output), march.time.copy()
    np.maximum.at(highest, crests.motion, crests.height)
    top = crests.height == highest[crests.motion]
    when[crests.motion[top]] = crests.time[top]
    return highest, when


def _tends_to(envelope: Array) -> Array:
    """Return where three successive envelopes tend to if they shrink, else the last one."""
    before, last = envelope[0] - envelope[1], envelope[1] - envelope[2]
    slows_down = np.maximum(before - last, 0)
    to_come = np.full(last.shape, np.inf)
    np.divide(last**2, slows_down, out=to_come, where=slows_down > 0)
    return envelope[2] - np.where(last > _SETTLED * envelope[2], to_come, 0.0)


def _has_settled(envelope: Array) -> Array:
    """Return whether each column has converged; its rows are the windows."""
    if len(envelope) <= _LOOKED_AT + 1:
        return np.zeros(envelope.shape[1], dtype=bool)
    change = np.abs(np.diff(envelope[-_LOOKED_AT - 1 :], axis=0))
    last = envelope[-1]
    steady = (change <= _STEADY * last).all(axis=0) & (last > 0)
    shrinks = (change[1:] < change[:-1]).all(axis=0)
    ratio = (change[-1] / np.maximum(change[0], np.finfo(float).tiny)) ** (1 / (_LOOKED_AT - 1))
    to_come = change[-1] * ratio / (1 - np.minimum(ratio, _SHRINKS))
    return steady | (shrinks & (ratio < _SHRINKS) & (to_come < _SETTLED * last))


def _sinks(envelope: Array, when: Array) -> Array:
    """Return whether each column shrinks at a relative rate that does not abate."""
    if len(envelope) <= _LOOKED_AT:
        return np.zeros(envelope.shape[1], dtype=bool)
    recent = np.maximum(envelope[-_LOOKED_AT:], np.finfo(float).tiny)
    time = np.diff(when[-_LOOKED_AT:], axis=0)
    rate = -np.diff(np.log(recent), axis=0) / np.where(time > 0, time, np.inf)
    abates = np.diff(rate, axis=0) < -_ABATES * rate[1:]
    return np.logical_and.reduce(rate > 0) & ~np.logical_or.reduce(abates)


def _decay(
    march: March,
    envelope: Array,
    last_above: Array,
    dies: Array,
    sinks: Array,
    settled: Array,
    horizon: float,
    reach: float,
) -> Decay:
    away = (march.ended < np.inf) & ~dies & ~settled
    steps = np.diff(envelope[-_LOOKED_AT:], axis=0)
    grows = np.logical_and.reduce(steps > 0) & (len(steps) == _LOOKED_AT - 1)
    messages = []
    for i, ending in enumerate(_endings(march, reach)):
        size = f"{1e3 * envelope[-1, i]:.2f} mm"
        verb = "grows" if envelope[-1, i] > envelope[:2][-1, i] else "shrinks"
        if dies[i]:
            messages.append(f"dies out in {last_above[i]:.1f} s")
        elif settled[i]:
            messages.append(f"{verb} into a limit cycle of {size}")
        elif away[i]:
            messages.append(ending)
        elif sinks[i]:
            messages.append(f"dies out, but not within {horizon:g} s: {size} are left")
        elif grows[i]:
            messages.append(f"grows, but has not settled within {horizon:g} s: {size}")
        else:
            messages.append(f"undecided after {horizon:g} s: {size} and has not settled")

    def shaped(values: ArrayLike) -> Any:
        return _plain(np.asarray(values).reshape(march.shape))

    return Decay(
        dies_out=shaped(dies | sinks),
        decided=shaped(dies | sinks | settled | away | grows),
        time=shaped(np.where(dies, last_above, np.nan)),
        amplitude=shaped(np.where(away, np.nan, envelope[-1])),
        message=shaped(np.array(messages, dtype=np.str_)),
    )


def _ramp(
    V: Array, up: Array, down: Array, hunts_up: Array, hunts_down: Array, dwell: float
) -> SpeedRamp:
    """Find the jumps."""
    none_up = np.logical_not(hunts_up.any(axis=-1))
    jump_up = np.where(none_up, np.nan, V[hunts_up.argmax(axis=-1)])
    calm = np.logical_not(hunts_down[..., ::-1])
    lowest = len(V) - calm.argmax(axis=-1)  # counted from the highest speed downwards
    never, always = calm[..., 0], hunts_down.all(axis=-1)
    jump_down = np.where(never | always, np.nan, V[np.minimum(lowest, len(V) - 1)])
    message = np.select(
        [never, always, none_up],
        [
            "no hunting at the highest speed",
            "still hunting at the lowest speed",
            "a small disturbance does not grow into hunting at any of the speeds",
        ],
        default="",
    )
    return SpeedRamp(
        speed=V,
        up=up,
        down=down,
        jump_up=_plain(jump_up),
        jump_down=_plain(jump_down),
        dwell=dwell,
        step=float(np.diff(V).max()),
        message=_plain(message),
    )
