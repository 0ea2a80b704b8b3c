"""Many motions at once through time, each by its own clock.

Every pass takes each motion one step further: a full step of `collocation`, or less where a force
has a kink within it, because a contact opens or closes or the damper changes direction. The
polynomial of the step already knows the motion at that instant, so nothing is solved twice and no
motion waits for another; the number of passes is that of the busiest motion.
"""

from __future__ import annotations

from copy import copy
from math import prod
from typing import NamedTuple, Self

import numpy as np

from hunting.collocation import (
    GAUSS,
    GRID,
    STAGES,
    Modes,
    Operators,
    SortedPorts,
    forces,
    lagrange,
    smooth_elements,
    states_in_step,
    step_map,
)
from hunting.crossings import cubic, first_crossing, turning_point
from hunting.elements import Array
from hunting.lure import LureSystem

_WIDTH = np.diff(GRID)
_ANGLE = 1.5  # longest step times the fastest oscillation; keeps GRID fine enough to see it
_HALVINGS = 20
_NEWTON = 8
_POLISHED = 2e-4  # of a step: the first-order shift to a contact that needs no second look
_ON_KINK = 1e-12  # of the clearance
_SAME = 1e-7  # of a step or sample interval: the same instant
_FORGET = 0.8  # how fast the size that errors are relative to may fall from step to step
_EASY, _PATIENCE = 300, 4  # when a step is doubled; doubling multiplies its error by about 2^8
_FEW = 8  # motions that are not worth separating from those that have arrived
_FIXED = ["member", "case", "limit", "kink", "bend", "preload", "highest"]  # by motion
_CHANGING = [
    "state",
    "time",
    "ended",
    "resolved",
    "contact_peak",
    "piece",
    "level",
    "patience",
    "scale",
    "taken",
]
_TINY = np.finfo(float).tiny


class Steps(NamedTuple):
    """What a pass leaves behind for whoever wants its motions at more instants.

    Attributes
    ----------
    motion, regime, level : ndarray of int, shape (s,)
        Which motion, which contacts are closed, which step length.
    time, used : ndarray, shape (s,)
        When the step began and how much of it was used [s].
    z : ndarray, shape (s, n + c + STAGES * p)
        State at the start, preloads, forces of the smooth elements at the stages.
    """

    motion: Array
    regime: Array
    level: Array
    time: Array
    used: Array
    z: Array

    def only(self, i: Array) -> Steps:
        """Return the steps `i`, by index or mask."""
        return Steps(*(values[i] for values in self))


class Turns(NamedTuple):
    """Where the output, or what a contact sees, has a local extreme.

    Attributes
    ----------
    step : Steps
        The steps in which it turns, used up to there.
    row : ndarray of int, shape (s,)
        The contact that sees the turn; for the output not less than their number.
    height : ndarray, shape (s,)
        Its size, roughly.
    """

    step: Steps
    row: Array
    height: Array


class Crests(NamedTuple):
    """Local extremes of |output|: the envelope of the motions.

    Attributes
    ----------
    motion : ndarray of int, shape (k,)
    time, height : ndarray, shape (k,)
        Instants [s] and |output| there.
    """

    motion: Array
    time: Array
    height: Array


class March:
    """Motions of a system, each with its own state, speed and clock.

    Parameters
    ----------
    system : LureSystem
        One system or a stack of them.
    speed : ndarray
        Forward speeds [m/s]; broadcast with the stack.
    initial : ndarray, shape (..., n)
        States at time 0; leading axes broadcast with the stack and the speeds.
    tolerance : float
        Error allowed in what the smooth elements see over one step, relative to its own size.
    step : float
        Longest step [s].
    reach : float
        A motion ends where |output| exceeds this multiple of the clearance.
    most_steps : float
        A motion ends where it takes more steps, those that were too long included.
    sample : float, optional
        Steps begin at multiples of this interval [s] where they can.

    Attributes
    ----------
    state : ndarray, shape (N, n)
        State of each motion at its own `time` (N,); of a motion that has ended, its last.
    ended : ndarray, shape (N,)
        When a motion left the range or could not be resolved; infinity while it has not.
    resolved : ndarray of bool, shape (N,)
        False where even the shortest step was too long, or there were too many of them.
    contact_peak : ndarray, shape (N, c)
        Largest |input| of each contact so far.
    """

    def __init__(
        self,
        system: LureSystem,
        speed: Array,
        initial: Array,
        *,
        tolerance: float,
        step: float,
        reach: float,
        most_steps: float,
        sample: float | None = None,
    ) -> None:
        cases = np.broadcast_shapes(system.shape, speed.shape)
        self.shape = np.broadcast_shapes(cases, initial.shape[:-1])
        n = initial.shape[-1]
        self.ports = SortedPorts.of(system, cases)
        self.A = np.broadcast_to(system.matrix(speed), (*cases, n, n)).reshape(-1, n, n)

        def place_in(stack: tuple[int, ...]) -> Array:
            return np.broadcast_to(np.arange(prod(stack)).reshape(stack), self.shape).ravel()

        self.system = system
        self.member, self.case = place_in(system.shape), place_in(cases)
        self.smooth = smooth_elements(system, self.member)
        N = len(self.case)

        self.output = system.output
        self.limit = reach * np.broadcast_to(system.clearance, self.shape).ravel()
        self.tolerance, self.most_steps = tolerance, most_steps
        self.kink = self.ports.kink[self.case]
        self.bend = self.ports.bend[self.case]
        self.preload = self.ports.preload[self.case]
        self.n, self.p, self.c = n, self.ports.C.shape[-2], self.ports.contact_C.shape[-2]

        self.state = np.array(np.broadcast_to(initial, (*self.shape, n)).reshape(N, n))
        self.time = np.zeros(N)
        self.ended = np.where(np.abs(self.state @ self.output) > self.limit, 0.0, np.inf)
        self.resolved = np.ones(N, dtype=bool)
        seen = (self.ports.watched[self.case] @ self.state[..., None])[..., 0]
        self.contact_peak = np.abs(seen[:, : self.c])
        self.piece = np.sign(seen) * (np.abs(seen) > self.kink)
        self.piece[(self.piece == 0) & (self.kink == 0)] = 1.0

        self._modes: dict[int, Modes] = {}
        self._operators: dict[tuple[int, int], Operators] = {}
        self.sample = sample
        self.base = step if sample is None else sample
        longest = np.minimum(step, _ANGLE / np.maximum(self._fastest(), _TINY))
        self.highest = np.floor(np.log2(longest / self.base) + _SAME).astype(int)[self.case]
        self.level = self.highest.copy()
        self.patience, self.taken = np.zeros((2, N), dtype=int)
        self.scale = np.full((N, self.p), _TINY)
        self._hold_nothing()

    def _hold_nothing(self) -> None:
        """Make room for the operators of every motion's next step."""
        N, x_f, m = len(self.case), self.n + self.c, STAGES * self.p
        rows = self.n + 2 * (self.c + self.p + 1) * len(GRID) + 2 * self.p
        self._held = np.full((N, 2), np.iinfo(int).min)
        self._now = Operators(
            np.empty((N, m, x_f)), np.empty((N, m, m)), np.empty((N, rows, x_f + m))
        )

    def _only(self, i: Array) -> Self:
        """Return a march of the motions `i` alone."""
        few = copy(self)
        for name in _FIXED + _CHANGING:
            setattr(few, name, getattr(self, name)[i])
        few.smooth = smooth_elements(self.system, few.member)
        few._hold_nothing()
        return few

    def run(self, until: float, keep: bool = False) -> tuple[Crests, list[Steps]]:
        """Take every motion to `until` [s], or a part of a step beyond.

        Returns
        -------
        crests : Crests
            Extremes met on the way.
        steps : list of Steps
            One for each pass if `keep`, else empty.
        """
        crests: list[Crests] = []
        steps: list[Steps] = []
        turns: list[Turns] = []
        with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
            while True:
                going = (self.time < until - _SAME * self.base) & (self.ended == np.inf)
                if not going.any():
                    break
                if len(going) > _FEW and 2 * going.sum() < len(going):
                    self._leave_the_others(np.flatnonzero(going), until, keep, crests, steps)
                    break
                step, turn = self._pass(going)
                turns.append(turn)
                if keep:
                    steps.append(step)
        crests.append(self._crests(turns))
        seen = (self.ports.contact_C[self.case] @ self.state[..., None])[..., 0]
        self.contact_peak = np.maximum(self.contact_peak, np.abs(seen))
        return Crests(*map(np.concatenate, zip(*crests, strict=True))), steps

    def _leave_the_others(
        self, i: Array, until: float, keep: bool, crests: list[Crests], steps: list[Steps]
    ) -> None:
        """Let the motions `i` run on their own, as the others need no more steps."""
        few = self._only(i)
        crest, step = few.run(until, keep)
        for name in _CHANGING:
            getattr(self, name)[i] = getattr(few, name)
        crests.append(crest._replace(motion=i[crest.motion]))
        steps.extend(part._replace(motion=i[part.motion]) for part in step)

    def _pass(self, going: Array) -> tuple[Steps, Turns]:
        """Take every motion that is `going` one step further, or mark its step as too long."""
        H = self.base * 2.0**self.level
        side = self.piece[:, : self.c]
        regime = (side != 0) @ (1 << np.arange(self.c))
        operators = self._fetch(regime)
        start = np.concatenate([self.state, side * self.preload], axis=1) * going[:, None]
        w, converged = self._stages(operators, start)
        z = np.concatenate([start, w], axis=1)
        end, seen, rates, error = self._view(operators, z)
        good = going & converged & (error <= self.tolerance)

        used, port = self._until_kink(self._until_sample(H), seen, rates, H, good)
        step = Steps(np.arange(len(good)), regime, self.level.copy(), self.time.copy(), used, z)
        part = np.flatnonzero(good & (used < H * (1 - _SAME)))
        if len(part):
            end[part], used[part] = self._within(step.only(part), port[part])
        turns = self._turns(step, seen, rates, H, good)
        self._switch(np.flatnonzero(good & (port >= 0)), port, end)
        self._advance(good, end, used, turns)
        self._adapt(going, good, error)
        return step.only(good), turns

    def modes(self, regime: int) -> Modes:
        """Return the modes while the contacts in the bits of `regime` are closed."""
        if regime not in self._modes:
            contact = np.arange(self.c)
            closed = (regime >> contact) & 1
            stiffness = self.ports.stiffness[:, closed, contact]
            springs = self.ports.contact_B @ (stiffness[..., None] * self.ports.contact_C)
            self._modes[regime] = Modes.of(self.A + springs, self.ports)
        return self._modes[regime]

    def _fetch(self, regime: Array) -> Operators:
        """Return the operators of every motion; only those that changed are copied."""
        held = np.stack([self.level, regime], axis=1)
        changed = np.flatnonzero((held != self._held).any(axis=1))
        if len(changed):
            for key in set(map(tuple, held[changed].tolist())):
                if key not in self._operators:
                    H = self.base * 2.0 ** key[0]
                    modes = self.modes(key[1])
                    self._operators[key] = Operators.of(modes, self.ports, self.output, H)
                i = changed[(held[changed] == key).all(axis=1)]
                source = self._operators[key]
                for name in ("free", "kernel", "view"):
                    getattr(self._now, name)[i] = getattr(source, name)[self.case[i]]
            self._held = held
        return self._now

    def _stages(self, operators: Operators, start: Array) -> tuple[Array, Array]:
        """Solve u = free (x, f) + kernel phi(u) by Newton's method; return w = phi(u)."""
        u = base = (operators.free @ start[..., None])[..., 0]
        N, m = u.shape
        converged = np.full(N, m == 0)
        if m == 0:
            return u, converged
        half = self.piece[:, self.c :]

        def phi(u: Array) -> tuple[Array, Array]:
            w, slope = forces(self.smooth, u.reshape(N, STAGES, self.p), half, self.bend)
            return w.reshape(N, m), slope.reshape(N, m)

        one = np.eye(m)
        for _ in range(_NEWTON):
            w, slope = phi(u)
            residual = base + (operators.kernel @ w[..., None])[..., 0] - u
            jacobian = one - operators.kernel * slope[:, None]
            change = np.linalg.solve(jacobian, residual[..., None])[..., 0]
            u = np.where(converged[:, None], u, u + change)  # no motion depends on the others
            size = np.maximum(np.abs(u).max(axis=1), _TINY)
            # The error left is of the order of the square of the last relative change.
            converged |= np.abs(change).max(axis=1) <= np.sqrt(0.01 * self.tolerance) * size
            if converged.all():
                break
        size = np.abs(u.reshape(N, STAGES, self.p)).max(axis=1)
        self.scale = np.fmax(_FORGET * self.scale, size)
        return phi(u)[0], converged

    def _view(self, operators: Operators, z: Array) -> tuple[Array, Array, Array, Array]:
        """Return the end of each step, what is seen on GRID with its rates, and the error."""
        view = (operators.view @ z[..., None])[..., 0]
        N, watched = len(view), self.c + self.p + 1
        rows = watched * len(GRID)
        end, seen, rates, error = np.split(view, np.cumsum([self.n, rows, rows]), axis=1)
        error = (np.abs(error) / np.tile(self.scale, 2)).max(axis=1, initial=0)
        grid = (N, watched, len(GRID))
        return end, seen.reshape(grid), rates.reshape(grid), error

    def _until_sample(self, H: Array) -> Array:
        """Return how much of each step to use so that later ones begin at a sample."""
        if self.sample is None:
            return H.copy()
        begin = self.time / self.sample
        aligned = np.abs(begin - np.round(begin)) < _SAME
        begin = np.where(aligned, np.round(begin), begin)
        last = np.floor(begin + H / self.sample + _SAME)
        full = (aligned & (self.level >= 0)) | (last <= begin)
        return np.where(full, H, (last - begin) * self.sample)

    def _until_kink(
        self, used: Array, seen: Array, rates: Array, H: Array, good: Array
    ) -> tuple[Array, Array]:
        """Shorten `used` to where a port meets a kink of its law; return it and which, or -1."""
        port = np.full(len(used), -1)
        if self.piece.shape[1] == 0:
            return used, port
        u, slope = seen[:, :-1], rates[:, :-1] * H[:, None, None]
        piece, kink = self.piece[..., None], self.kink[..., None]
        sign = np.where(piece == 0, np.sign(u), -piece)
        beyond = np.where(piece == 0, -kink, kink) + sign * u
        slope = sign * slope
        near = (beyond + _WIDTH.max() * np.abs(slope) / 4 > 0)[..., 1:]
        i = np.flatnonzero(near.any(axis=(1, 2)) & good)
        if len(i):
            y, dy = (part[i].reshape(-1, len(GRID)) for part in (beyond, slope))
            instant = first_crossing(GRID, y, dy).reshape(len(i), -1)
            earliest = instant.min(axis=1) * H[i]
            hit = earliest < used[i]
            used[i[hit]] = earliest[hit]
            port[i[hit]] = instant.argmin(axis=1)[hit]
        return used, port

    def _within(self, step: Steps, port: Array) -> tuple[Array, Array]:
        """Return the states after `used` seconds, moved to the very kink."""
        i, used, H = step.motion, step.used, self.base * 2.0**step.level
        longest = _POLISHED * H
        for _ in range(_NEWTON):
            states, rates = self._states(step, used)
            shift = self._to_kink(i, port, states, rates)
            settled = np.abs(shift) <= longest
            if settled.all():
                break
            used = np.where(settled, used, np.clip(used + shift, 0, H))
        shift = np.clip(shift, -longest, longest)
        return states + shift[:, None] * rates, used + shift

    def _states(self, step: Steps, t: Array) -> tuple[Array, Array]:
        """Return states and rates t seconds after the steps began."""
        packed = self._packed(step.motion, step.regime)
        return states_in_step(packed, self.base * 2.0**step.level, *self._split(step.z), t)

    def _split(self, z: Array) -> tuple[Array, Array, Array]:
        x, f, w = np.split(z, [self.n, self.n + self.c], axis=1)
        return x, f, w.reshape(len(z), STAGES, self.p)

    def _packed(self, i: Array, regime: Array) -> Array:
        present = {r: self.modes(r).packed for r in set(regime.tolist())}
        count = max(packed.shape[1] for packed in present.values())
        out = np.zeros((len(i), count, next(iter(present.values())).shape[2]), dtype=complex)
        for r, packed in present.items():
            these = np.flatnonzero(regime == r)
            out[these, : packed.shape[1]] = packed[self.case[i[these]]]
        return out

    def _to_kink(self, i: Array, port: Array, states: Array, rates: Array) -> Array:
        """Return the time from `states` to where `port` meets its kink, to first order."""
        if self.piece.shape[1] == 0:
            return np.zeros(len(i))
        C = self.ports.watched[self.case[i], port]
        piece, kink = self.piece[i, port], self.kink[i, port]
        u, slope = (C * states).sum(axis=1), (C * rates).sum(axis=1)
        sign = np.where(piece == 0, np.sign(u), piece)
        missing = kink - sign * u
        is_there = (port < 0) | (np.abs(missing) <= _ON_KINK * kink)
        return np.where(is_there, 0.0, missing / (sign * slope))

    def _switch(self, i: Array, port: Array, end: Array) -> None:
        """Let contacts close or open, smooth elements follow the other half of their law."""
        port = port[i]
        seen = (self.ports.watched[self.case[i], port] * end[i]).sum(axis=1)
        piece = self.piece[i, port]
        beyond = np.where(port < self.c, 0.0, -piece)
        self.piece[i, port] = np.where(piece == 0, np.sign(seen), beyond)

    def _turns(self, step: Steps, seen: Array, rates: Array, H: Array, good: Array) -> Turns:
        """Find where within the steps the output, or what a contact sees, turns."""
        turning = (rates[..., :-1] * rates[..., 1:] < 0) & good[:, None, None]
        turning[:, self.c : -1] = False
        i, row, j = np.nonzero(turning)
        width = H[i] * _WIDTH[j]
        y0, y1 = seen[i, row, j], seen[i, row, j + 1]
        d0, d1 = rates[i, row, j] * width, rates[i, row, j + 1] * width
        s = turning_point(y0, y1, d0, d1)
        after = H[i] * GRID[j] + s * width
        real = after <= step.used[i]
        i, height = i[real], np.abs(cubic(y0, y1, d0, d1, s))[real]
        return Turns(step.only(i)._replace(used=after[real]), row[real], height)

    def _crests(self, turns: list[Turns]) -> Crests:
        """Evaluate the turns of the output; note the largest ones of the contacts."""
        if not any(len(turn.row) for turn in turns):
            return Crests(np.zeros(0, dtype=int), np.zeros(0), np.zeros(0))
        step = Steps(*map(np.concatenate, zip(*(turn.step for turn in turns), strict=True)))
        row = np.concatenate([turn.row for turn in turns])
        states, _ = self._states(step, step.used)
        case = self.case[step.motion]
        seen = np.abs(states @ self.output)
        contact = row < self.c
        i, port = np.flatnonzero(contact), row[contact]
        seen[i] = np.abs((self.ports.contact_C[case[i], port] * states[i]).sum(axis=1))
        np.maximum.at(self.contact_peak, (step.motion[i], port), seen[i])
        motion, time = step.motion[~contact], (step.time + step.used)[~contact]
        return Crests(motion, time, seen[~contact])

    def _advance(self, good: Array, end: Array, used: Array, turns: Turns) -> None:
        self.state[good] = end[good]
        self.time[good] += used[good]
        if self.sample is not None:
            nearest = np.round(self.time / self.sample) * self.sample
            same = np.abs(self.time - nearest) < _SAME * self.sample
            self.time[same] = nearest[same]
        away = good & (np.abs(self.state @ self.output) > self.limit)
        over = (turns.row >= self.c) & (turns.height > self.limit[turns.step.motion])
        away[turns.step.motion[over]] = True
        self.ended[away] = self.time[away]

    def _adapt(self, going: Array, good: Array, error: Array) -> None:
        """Halve the steps that failed; double those that could be longer."""
        bad = going & ~good
        self.patience = np.where(bad, 0, self.patience + 1)
        easy = good & (error < self.tolerance / _EASY) & (self.patience > _PATIENCE)
        self.level += (easy & (self.level < self.highest)).astype(int) - bad
        self.taken += going
        lost = bad & (self.level < self.highest - _HALVINGS)
        lost |= going & (self.taken > self.most_steps)
        self.resolved[lost] = False
        self.ended[lost] = self.time[lost]

    def _fastest(self) -> Array:
        """Return each case's largest angular frequency that is not drowned in its own damping."""
        regimes = {0, (1 << self.c) - 1}
        lam = np.concatenate([self.modes(r).packed[..., 0] for r in regimes], axis=-1)
        return np.max(lam.imag * (np.abs(lam.real) < lam.imag), axis=-1)

    def sampled(self, steps: list[Steps], count: int) -> Array:
        """Return the states at the first `count` samples after the start, shape (N, count, n).

        They are NaN after the end of a motion.
        """
        assert self.sample is not None
        out = np.full((len(self.case), count, self.n), np.nan)
        if not steps:
            return out
        all_steps = Steps(*map(np.concatenate, zip(*steps, strict=True)))
        begin = all_steps.time / self.sample
        first = np.floor(begin + _SAME).astype(int)
        end = (all_steps.time + all_steps.used) / self.sample
        inside = np.floor(end + _SAME).astype(int) - first
        aligned = (np.abs(begin - first) < _SAME) & (all_steps.level >= 0)
        late = np.flatnonzero(~aligned & (inside > 0))
        if len(late):
            self._move_to_sample(all_steps, late, first[late] + 1)
            first[late] += 1
            inside[late] -= 1
            out[all_steps.motion[late], first[late] - 1] = all_steps.z[late, : self.n]
        self._sample(out, all_steps, first, inside)
        return out

    def _move_to_sample(self, steps: Steps, i: Array, sample: Array) -> None:
        """Let the steps `i` begin at a sample within them: the same polynomial, seen from there."""
        assert self.sample is not None
        late = steps.only(i)
        _, f, w = self._split(late.z)
        ahead = np.minimum(sample * self.sample - late.time, late.used)
        states, _ = self._states(late, ahead)
        H = self.base * 2.0**late.level
        w = lagrange((ahead / H)[:, None] + GAUSS) @ w
        steps.z[i] = np.concatenate([states, f, w.reshape(len(i), -1)], axis=1)

    def _sample(self, out: Array, steps: Steps, first: Array, inside: Array) -> None:
        """One matrix product for all the steps of the same length, regime and case."""
        which = np.flatnonzero((inside > 0) & (steps.level >= 0))
        keys = np.stack([steps.level, steps.regime, self.case[steps.motion]])[:, which]
        order = np.lexsort(keys)
        which, keys = which[order], keys[:, order]
        new = np.flatnonzero((np.diff(keys) != 0).any(axis=0)) + 1
        maps: dict[tuple[int, int], Array] = {}
        for i in np.split(which, new) if len(which) else []:
            level, regime = int(steps.level[i[0]]), int(steps.regime[i[0]])
            S = 1 << level
            if (level, regime) not in maps:
                theta = np.arange(1, S + 1) / S
                maps[level, regime] = step_map(self.modes(regime), self.ports, self.base * S, theta)
            matrix = maps[level, regime][self.case[steps.motion[i[0]]]]
            states = steps.z[i] @ matrix.reshape(-1, matrix.shape[-1]).T
            _write(out, steps.motion[i], first[i], inside[i], states.reshape(len(i), S, self.n))


def _write(out: Array, motion: Array, first: Array, inside: Array, states: Array) -> None:
    """Put the first `inside` of each step's states at the samples after `first`."""
    sample = first[:, None] + np.arange(states.shape[1])
    wanted = (np.arange(states.shape[1]) < inside[:, None]) & (sample < out.shape[1])
    out[np.broadcast_to(motion[:, None], sample.shape)[wanted], sample[wanted]] = states[wanted]
