"""Critical speeds of many cases: in chunks, on any executor, kept in a folder if wanted.

A case is a parameter set that differs from a given one in a few fields. The arrays do the work;
this file only cuts them into chunks, so that memory is bounded, the work can be watched, cancelled
and shared out, and what is finished survives a crash.
"""

from __future__ import annotations

import json
import os
from collections.abc import Callable, Generator, Mapping
from concurrent.futures import FIRST_COMPLETED, BrokenExecutor, Executor, Future, wait
from contextlib import closing
from dataclasses import dataclass
from hashlib import sha256
from importlib.metadata import version
from itertools import islice
from pathlib import Path
from typing import Any, Self
from zipfile import BadZipFile

import numpy as np

from hunting.critical_speeds import Method, critical_speeds
from hunting.elements import Array
from hunting.lure import LureSystem
from hunting.parameters import Parameters

Vehicle = Callable[[Parameters], LureSystem]
Progress = Callable[[int, int], object]
Answers = Mapping[str, Array]

QUANTITIES = ("linear", "nonlinear", "amplitude", "frequency", "criticality", "message")
CHUNK = 1000  # cases
_IN_FLIGHT = 64  # chunks submitted and not yet answered


class Cancelled(Exception):
    """The caller's `progress` has returned False."""


@dataclass(frozen=True)
class Cases:
    """Parameter sets that differ from a given one in a few fields.

    Attributes
    ----------
    vehicle : callable
        `wheelset` or `bogie`, or another function that makes a system of parameters.
    parameters : Parameters
        The fields that do not differ, as numbers.
    columns : dict of str to ndarray, shape (m,)
        The fields that do, a value for each case.
    method : {"harmonic_balance", "averaging"}
        As for `critical_speeds`.
    """

    vehicle: Vehicle
    parameters: Parameters
    columns: Mapping[str, Array]
    method: Method

    def __len__(self) -> int:
        return max(map(len, self.columns.values()), default=0)

    def part(self, chunk: int) -> Self:
        """Return the cases of one chunk."""
        here = slice(chunk * CHUNK, (chunk + 1) * CHUNK)
        columns = {name: values[here] for name, values in self.columns.items()}
        return type(self)(self.vehicle, self.parameters, columns, self.method)

    def answers(self) -> Answers:
        """Return the critical speeds of all cases at once, as arrays of shape (m,)."""
        system = self.vehicle(self.parameters.replace(**self.columns))
        speeds = critical_speeds(system, self.method)
        return {name: np.asarray(getattr(speeds, name)) for name in QUANTITIES}

    def description(self) -> dict[str, Any]:
        """Return in words what the answers depend on, but for the values that differ."""
        return {
            "bogie-hunting": version("bogie-hunting"),
            "vehicle": name_of(self.vehicle),
            "method": self.method,
            "parameters": self.parameters.to_dict(),
            "columns": list(self.columns),
            "cases": len(self),
            "chunk": CHUNK,
        }

    def key(self) -> str:
        """Return a hash of everything the answers depend on."""
        system = self.vehicle(self.parameters)
        digest = sha256(json.dumps(self.description()).encode())
        for values in (*self.columns.values(), system.A0, system.A1, system.A2):
            digest.update(np.ascontiguousarray(values).tobytes())
        digest.update(repr(system.elements).encode())
        return digest.hexdigest()[:32]


def name_of(vehicle: Vehicle) -> str:
    """Return what a vehicle is called."""
    return getattr(vehicle, "__name__", type(vehicle).__name__)


def solve_cases(
    cases: Cases,
    executor: Executor | None = None,
    progress: Progress | None = None,
    store: str | os.PathLike[str] | None = None,
) -> Answers:
    """Return the critical speeds of all cases, chunk by chunk.

    Parameters
    ----------
    cases : Cases
        One case or more.
    executor : concurrent.futures.Executor, optional
        Where chunks are computed; by default here, one after the other. A process pool, or what
        ``dask.distributed.Client.get_executor()`` returns.
    progress : callable, optional
        Called with the numbers of cases done and of all cases, before the first chunk and after
        each. If it returns False, no further chunk is begun.
    store : path, optional
        A folder for finished chunks. The same cases, asked for again, go on from there.

    Returns
    -------
    dict of str to ndarray, shape (m,)
        By the names of `QUANTITIES`.

    Raises
    ------
    Cancelled
        If `progress` has returned False.
    concurrent.futures.BrokenExecutor
        If a process of the pool was killed.
    """
    total, count = len(cases), -(-len(cases) // CHUNK)
    shelf = None if store is None else Shelf(Path(store), cases)
    done = {} if shelf is None else shelf.finished(count)

    def tell() -> None:
        finished = min(total, sum(len(part["linear"]) for part in done.values()))
        if progress is not None and progress(finished, total) is False:
            raise Cancelled(f"cancelled after {finished} of {total} cases")

    tell()
    missing = [chunk for chunk in range(count) if chunk not in done]
    with closing(_computed(cases, missing, executor or _Here())) as computed:
        for chunk, answers in computed:
            if shelf is not None:
                shelf.put(chunk, answers)
            done[chunk] = answers
            tell()
    return {
        name: np.concatenate([done[chunk][name] for chunk in range(count)]) for name in QUANTITIES
    }


def _computed(
    cases: Cases, chunks: list[int], executor: Executor
) -> Generator[tuple[int, Answers]]:
    """Yield chunks as they finish; only so many are under way at a time."""
    waiting = iter(chunks)
    running: dict[Future[Answers], int] = {}
    limit = 1 if isinstance(executor, _Here) else _IN_FLIGHT
    try:
        while True:
            for chunk in islice(waiting, limit - len(running)):
                running[executor.submit(Cases.answers, cases.part(chunk))] = chunk
            if not running:
                return
            finished, _ = wait(running, return_when=FIRST_COMPLETED)
            for future in sorted(finished, key=lambda f: f.exception() is not None):
                yield running.pop(future), future.result()
    except BrokenExecutor as broken:
        raise type(broken)(
            "a worker process was killed or ran out of memory, and its pool is of no more use; "
            "with store=... the finished chunks are kept, and the same call with a new executor "
            "goes on from there"
        ) from broken
    finally:
        for future in running:
            future.cancel()


class _Here(Executor):
    """Computes at once, in the calling thread."""

    def submit(self, fn: Callable[..., Any], /, *args: Any, **kwargs: Any) -> Future[Any]:
        future: Future[Any] = Future()
        future.set_result(fn(*args, **kwargs))
        return future


class Shelf:
    """A folder of finished chunks, named after what they depend on.

    Parameters
    ----------
    store : Path
        Where such folders are kept; made if need be.
    cases : Cases
        What the chunks are of.
    """

    def __init__(self, store: Path, cases: Cases) -> None:
        self.folder = store / cases.key()
        self.folder.mkdir(parents=True, exist_ok=True)
        text = json.dumps(cases.description(), indent=2)
        self._write("cases.json", lambda file: file.write(text.encode()))

    def finished(self, count: int) -> dict[int, Answers]:
        """Return those of the first `count` chunks that are there and whole."""
        return {k: answers for k in range(count) if (answers := self._read(k)) is not None}

    def put(self, chunk: int, answers: Answers) -> None:
        """Keep a chunk. It is there as a whole or not at all, whenever the machine stops."""
        arrays: dict[str, Any] = dict(answers)
        self._write(self._name(chunk), lambda file: np.savez(file, **arrays))

    def _name(self, chunk: int) -> str:
        return f"chunk-{chunk:06d}.npz"

    def _read(self, chunk: int) -> Answers | None:
        try:
            path = self.folder / self._name(chunk)
            with path.open("rb") as file, np.load(file, allow_pickle=False) as data:
                return {name: data[name] for name in QUANTITIES}
        except (FileNotFoundError, EOFError, BadZipFile, KeyError, ValueError):
            return None

    def _write(self, name: str, write: Callable[[Any], object]) -> None:
        beside = self.folder / f"{name}.{os.getpid()}.tmp"
        with beside.open("wb") as file:
            write(file)
            file.flush()
            os.fsync(file.fileno())
        beside.replace(self.folder / name)
