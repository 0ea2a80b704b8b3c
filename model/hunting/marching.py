"""Many motions at once through time, each by its own clock.

Every pass takes each motion one step further: a full step of `collocation`, or less where a
contact opens or closes within it. The polynomial of the step already knows the motion at that
instant, so nothing is solved twice and no motion waits for another; the number of passes is that of
the busiest motion.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from hunting.collocation import (
    GRID,
    STAGES,
    Modes,
    Operators,
    SortedPorts,
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
_BLOCK = 20_000  # steps sampled at once
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
    sample : float, optional
        Steps begin at multiples of this interval [s] where they can.

    Attributes
    ----------
    state : ndarray, shape (N, n)
        State of each motion at its own `time` (N,); of a motion that has ended, its last.
    ended : ndarray, shape (N,)
        When a motion left the range or could not be resolved; infinity while it has not.
    resolved : ndarray of bool, shape (N,)
        False where even the shortest step was too long.
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
        sample: float | None = None,
    ) -> None:
        cases = np.broadcast_shapes(system.shape, speed.shape)
        self.shape = np.broadcast_shapes(cases, initial.shape[:-1])
        n = initial.shape[-1]
        self.ports = SortedPorts.of(system, cases)
        self.A = np.broadcast_to(system.matrix(speed), (*cases, n, n)).reshape(-1, n, n)
        number = np.arange(len(self.A)).reshape(cases)
        self.case = np.broadcast_to(number, self.shape).ravel()
        N = len(self.case)

        self.output = system.output
        self.limit = reach * np.broadcast_to(system.clearance, self.shape).ravel()
        self.tolerance = tolerance
        self.kink = self.ports.kink[self.case]
        self.preload = self.ports.preload[self.case]
        self.n, self.p, self.c = n, self.ports.C.shape[-2], self.kink.shape[-1]

        self.state = np.array(np.broadcast_to(initial, (*self.shape, n)).reshape(N, n))
        self.time = np.zeros(N)
        self.ended = np.where(np.abs(self.state @ self.output) > self.limit, 0.0, np.inf)
        self.resolved = np.ones(N, dtype=bool)
        seen = (self.ports.contact_C[self.case] @ self.state[..., None])[..., 0]
        self.contact_peak = np.abs(seen)
        self.side = np.sign(seen) * (np.abs(seen) > self.kink)

        self._modes: dict[int, Modes] = {}
        self._operators: dict[tuple[int, int], Operators] = {}
        step = min(step, _ANGLE / max(self._fastest(), _TINY))
        self.sample = sample
        self.base = step if sample is None else sample
        self.highest = 0 if sample is None else int(np.floor(np.log2(step / sample) + _SAME))
        self.level = np.full(N, self.highest)
        self.patience = np.zeros(N, dtype=int)
        self.scale = np.full((N, self.p), _TINY)
        self._held = np.full((N, 2), -1)
        m = STAGES * self.p
        rows = n + 2 * (self.c + 1) * len(GRID) + 2 * self.p
        self._now = Operators(
            np.empty((N, m, n + self.c)), np.empty((N, m, m)), np.empty((N, rows, n + self.c + m))
        )

    def run(self, until: float, keep: bool = False) -> tuple[Crests, list[Steps]]:
        """Take every motion to `until` [s], or a part of a step beyond.

        Returns
        -------
        crests : Crests
            Extremes met on the way.
        steps : list of Steps
            One for each pass if `keep`, else empty.
        """
        crests = [Crests(np.zeros(0, dtype=int), np.zeros(0), np.zeros(0))]
        steps: list[Steps] = []
        with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
            while True:
                going = (self.time < until - _SAME * self.base) & (self.ended == np.inf)
                if not going.any():
                    break
                step, crest = self._pass(going)
                crests.append(crest)
                if keep:
                    steps.append(step)
        seen = (self.ports.contact_C[self.case] @ self.state[..., None])[..., 0]
        self.contact_peak = np.maximum(self.contact_peak, np.abs(seen))
        return Crests(*map(np.concatenate, zip(*crests, strict=True))), steps

    def _pass(self, going: Array) -> tuple[Steps, Crests]:
        """Take every motion that is `going` one step further, or mark its step as too long."""
        H = self.base * 2.0**self.level
        regime = (self.side != 0) @ (1 << np.arange(self.c))
        operators = self._fetch(regime)
        start = np.concatenate([self.state, self.side * self.preload], axis=1) * going[:, None]
        w, converged = self._stages(operators, start)
        z = np.concatenate([start, w], axis=1)
        end, seen, rates, error = self._view(operators, z)
        good = going & converged & (error <= self.tolerance)

        used, port = self._until_contact(self._until_sample(H), seen, rates, H, good)
        part = np.flatnonzero(good & (used < H * (1 - _SAME)))
        if len(part):
            end[part], used[part] = self._within(
                part, regime[part], z[part], H[part], used[part], port[part]
            )
        crests = self._crests(seen, rates, H, used, good)
        record = Steps(
            *(
                values[good]
                for values in (np.arange(len(good)), regime, self.level, self.time, used, z)
            )
        )
        self._switch(np.flatnonzero(good & (port >= 0)), port, end)
        self._advance(good, end, used, crests)
        self._adapt(going, good, error)
        return record, crests

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
        converged = np.ones(N, dtype=bool)
        if m == 0:
            return u, converged
        shape = (*self.shape, STAGES, self.p)
        one = np.eye(m)
        for _ in range(_NEWTON):
            w, slope = (part.reshape(N, m) for part in self.ports.forces(u.reshape(shape)))
            residual = base + (operators.kernel @ w[..., None])[..., 0] - u
            jacobian = one - operators.kernel * slope[:, None]
            change = np.linalg.solve(jacobian, residual[..., None])[..., 0]
            u = u + change
            size = np.maximum(np.abs(u).max(axis=1), _TINY)
            # The error left is of the order of the square of the last relative change.
            converged = np.abs(change).max(axis=1) <= np.sqrt(0.1 * self.tolerance) * size
            if converged.all():
                break
        size = np.abs(u.reshape(N, STAGES, self.p)).max(axis=1)
        self.scale = np.fmax(_FORGET * self.scale, size)
        return self.ports.forces(u.reshape(shape))[0].reshape(N, m), converged

    def _view(self, operators: Operators, z: Array) -> tuple[Array, Array, Array, Array]:
        """Return the end of each step, what is seen on GRID with its rates, and the error."""
        view = (operators.view @ z[..., None])[..., 0]
        N, rows = len(view), (self.c + 1) * len(GRID)
        end, seen, rates, error = np.split(view, np.cumsum([self.n, rows, rows]), axis=1)
        error = (np.abs(error) / np.tile(self.scale, 2)).max(axis=1, initial=0)
        grid = (N, self.c + 1, len(GRID))
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

    def _until_contact(
        self, used: Array, seen: Array, rates: Array, H: Array, good: Array
    ) -> tuple[Array, Array]:
        """Shorten `used` to where a contact opens or closes; return it and which one, or -1."""
        port = np.full(len(used), -1)
        if self.c == 0:
            return used, port
        u, slope = seen[:, : self.c], rates[:, : self.c] * H[:, None, None]
        side, kink = self.side[..., None], self.kink[..., None]
        sign = np.where(side == 0, np.sign(u), -side)
        beyond = np.where(side == 0, -kink, kink) + sign * u
        slope = sign * slope
        near = (beyond + _WIDTH.max() * np.abs(slope) / 4 > 0)[..., 1:]
        i = np.flatnonzero(near.any(axis=(1, 2)) & good)
        if len(i):
            y, dy = (part[i].reshape(-1, len(GRID)) for part in (beyond, slope))
            instant = first_crossing(GRID, y, dy).reshape(-1, self.c)
            earliest = instant.min(axis=1) * H[i]
            hit = earliest < used[i]
            used[i[hit]] = earliest[hit]
            port[i[hit]] = instant.argmin(axis=1)[hit]
        return used, port

    def _within(
        self, i: Array, regime: Array, z: Array, H: Array, used: Array, port: Array
    ) -> tuple[Array, Array]:
        """Return the states after `used` seconds, moved to the very instant of contact."""
        packed = self._packed(i, regime)
        x, f, w = np.split(z, [self.n, self.n + self.c], axis=1)
        w = w.reshape(len(i), STAGES, self.p)
        longest = _POLISHED * H
        for _ in range(_NEWTON):
            states, rates = states_in_step(packed, H, x, f, w, used[:, None])
            shift = self._to_contact(i, port, states[:, 0], rates)
            settled = np.abs(shift) <= longest
            if settled.all():
                break
            used = np.where(settled, used, np.clip(used + shift, 0, H))
        shift = np.clip(shift, -longest, longest)
        return states[:, 0] + shift[:, None] * rates, used + shift

    def _packed(self, i: Array, regime: Array) -> Array:
        present = {r: self.modes(r).packed for r in set(regime.tolist())}
        count = max(packed.shape[1] for packed in present.values())
        out = np.zeros((len(i), count, next(iter(present.values())).shape[2]), dtype=complex)
        for r, packed in present.items():
            these = np.flatnonzero(regime == r)
            out[these, : packed.shape[1]] = packed[self.case[i[these]]]
        return out

    def _to_contact(self, i: Array, port: Array, states: Array, rates: Array) -> Array:
        """Return the time from `states` to where contact `port` changes, to first order."""
        if self.c == 0:
            return np.zeros(len(i))
        C = self.ports.contact_C[self.case[i], port]
        side, kink = self.side[i, port], self.kink[i, port]
        u, slope = (C * states).sum(axis=1), (C * rates).sum(axis=1)
        sign = np.where(side == 0, np.sign(u), side)
        missing = kink - sign * u
        is_there = (port < 0) | (np.abs(missing) <= _ON_KINK * kink)
        return np.where(is_there, 0.0, missing / (sign * slope))

    def _switch(self, i: Array, port: Array, end: Array) -> None:
        port = port[i]
        seen = (self.ports.contact_C[self.case[i], port] * end[i]).sum(axis=1)
        self.side[i, port] = np.where(self.side[i, port] == 0, np.sign(seen), 0.0)

    def _crests(self, seen: Array, rates: Array, H: Array, used: Array, good: Array) -> Crests:
        turns = (rates[..., :-1] * rates[..., 1:] < 0) & good[:, None, None]
        i, row, j = np.nonzero(turns)
        width = H[i] * _WIDTH[j]
        hermite = (
            seen[i, row, j],
            seen[i, row, j + 1],
            rates[i, row, j] * width,
            rates[i, row, j + 1] * width,
        )
        s = turning_point(*hermite)
        after = H[i] * GRID[j] + s * width
        height = np.abs(cubic(*hermite, s))
        real = after <= used[i]
        contact, output = real & (row < self.c), real & (row == self.c)
        np.maximum.at(self.contact_peak, (i[contact], row[contact]), height[contact])
        return Crests(i[output], (self.time[i] + after)[output], height[output])

    def _advance(self, good: Array, end: Array, used: Array, crests: Crests) -> None:
        self.state[good] = end[good]
        self.time[good] += used[good]
        if self.sample is not None:
            nearest = np.round(self.time / self.sample) * self.sample
            same = np.abs(self.time - nearest) < _SAME * self.sample
            self.time[same] = nearest[same]
        away = good & (np.abs(self.state @ self.output) > self.limit)
        away[crests.motion[crests.height > self.limit[crests.motion]]] = True
        self.ended[away] = self.time[away]

    def _adapt(self, going: Array, good: Array, error: Array) -> None:
        """Halve the steps that failed; double those that could be longer."""
        bad = going & ~good
        self.patience = np.where(bad, 0, self.patience + 1)
        easy = good & (error < self.tolerance / _EASY) & (self.patience > _PATIENCE)
        self.level += (easy & (self.level < self.highest)).astype(int) - bad
        lost = bad & (self.level < self.highest - _HALVINGS)
        self.resolved[lost] = False
        self.ended[lost] = self.time[lost]

    def _fastest(self) -> float:
        """Return the largest angular frequency that is not drowned in its own damping."""
        lam = np.concatenate([self.modes(r).packed[..., 0].ravel() for r in {0, (1 << self.c) - 1}])
        return float(np.abs(lam.imag[np.abs(lam.real) < np.abs(lam.imag)]).max(initial=0))

    def sampled(self, steps: list[Steps], count: int) -> Array:
        """Return the states at the first `count` samples after the start, shape (N, count, n).

        They are NaN after the end of a motion.
        """
        assert self.sample is not None
        out = np.full((len(self.case), count, self.n), np.nan)
        if not steps:
            return out
        whole = Steps(*map(np.concatenate, zip(*steps, strict=True)))
        begin = whole.time / self.sample
        first = np.floor(begin + _SAME).astype(int)
        inside = np.floor((whole.time + whole.used) / self.sample + _SAME).astype(int) - first
        aligned = (np.abs(begin - first) < _SAME) & (whole.level >= 0)
        self._sample_aligned(out, whole, first, inside, np.flatnonzero(aligned & (inside > 0)))
        self._sample_others(out, whole, first, inside, np.flatnonzero(~aligned & (inside > 0)))
        return out

    def _sample_aligned(
        self, out: Array, steps: Steps, first: Array, inside: Array, which: Array
    ) -> None:
        """One matrix product for all the steps of the same length, regime and case."""
        keys = np.stack([steps.level, steps.regime, self.case[steps.motion]], axis=1)[which]
        which = which[np.lexsort(keys.T[::-1])]
        keys = np.stack([steps.level, steps.regime, self.case[steps.motion]], axis=1)[which]
        new = np.flatnonzero((np.diff(keys, axis=0) != 0).any(axis=1)) + 1
        maps: dict[tuple[int, int], Array] = {}
        for i in np.split(which, new):
            if len(i) == 0:
                continue
            level, regime, case = (
                int(k)
                for k in (steps.level[i[0]], steps.regime[i[0]], self.case[steps.motion[i[0]]])
            )
            S = 1 << level
            if (level, regime) not in maps:
                theta = np.arange(1, S + 1) / S
                maps[level, regime] = step_map(self.modes(regime), self.ports, self.base * S, theta)
            matrix = maps[level, regime][case]
            states = steps.z[i] @ matrix.reshape(-1, matrix.shape[-1]).T
            _write(out, steps.motion[i], first[i], inside[i], states.reshape(len(i), S, self.n))

    def _sample_others(
        self, out: Array, steps: Steps, first: Array, inside: Array, which: Array
    ) -> None:
        assert self.sample is not None
        for i in np.array_split(which, len(which) // _BLOCK + 1):
            if len(i) == 0:
                continue
            H = self.base * 2.0 ** steps.level[i]
            ahead = (first[i, None] + 1 + np.arange(inside[i].max())) * self.sample
            t = np.minimum(ahead - steps.time[i, None], steps.used[i, None])
            x, f, w = np.split(steps.z[i], [self.n, self.n + self.c], axis=1)
            packed = self._packed(steps.motion[i], steps.regime[i])
            states, _ = states_in_step(packed, H, x, f, w.reshape(len(i), STAGES, self.p), t)
            _write(out, steps.motion[i], first[i], inside[i], states)


def _write(out: Array, motion: Array, first: Array, inside: Array, states: Array) -> None:
    """Put the first `inside` of each step's states at the samples after `first`."""
    sample = first[:, None] + np.arange(states.shape[1])
    wanted = (np.arange(states.shape[1]) < inside[:, None]) & (sample < out.shape[1])
    out[np.broadcast_to(motion[:, None], sample.shape)[wanted], sample[wanted]] = states[wanted]
