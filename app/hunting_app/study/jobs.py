"""Long work: off the page's thread, in processes that all visitors share by turns."""

from __future__ import annotations

import multiprocessing
import os
import threading
from collections import deque
from collections.abc import Callable
from concurrent.futures import (
    BrokenExecutor,
    Executor,
    Future,
    ProcessPoolExecutor,
    ThreadPoolExecutor,
)
from functools import partial
from typing import Any

import panel as pn

from hunting import Cancelled
from hunting.cases import Progress

PROCESSES = max(1, min(4, os.cpu_count() or 1))
JOBS = 8  # under way at a time, in the whole server; further ones wait

Work = Callable[[Executor, Progress], Any]


class Workers:
    """A few processes. Whoever has work stands in a line of their own; the lines take turns."""

    def __init__(self, count: int = PROCESSES) -> None:
        self.count = count
        self._pool: ProcessPoolExecutor | None = None
        self._lines: deque[Line] = deque()
        self._busy = 0
        self._lock = threading.RLock()

    def line(self) -> Line:
        """Return a new line, an executor for one job."""
        return Line(self)

    def wake(self, line: Line | None = None) -> None:
        """Give free processes the first piece of work of each line in turn."""
        with self._lock:
            if line is not None and line not in self._lines:
                self._lines.append(line)
            while self._lines and self._busy < self.count:
                next_line = self._lines.popleft()
                while next_line.waiting:
                    future, call = next_line.waiting.popleft()
                    if future.set_running_or_notify_cancel():
                        self._give(future, call)
                        break
                if next_line.waiting:
                    self._lines.append(next_line)

    def _give(self, future: Future[Any], call: partial[Any]) -> None:
        self._busy += 1
        try:
            inner = self._processes().submit(call)
        except (BrokenExecutor, RuntimeError) as refusal:  # killed, or the server is ending
            self._busy -= 1
            self._pool = None
            future.set_exception(refusal)
        else:
            inner.add_done_callback(lambda done: self._answered(future, done))

    def _answered(self, future: Future[Any], inner: Future[Any]) -> None:
        error = inner.exception()
        with self._lock:
            self._busy -= 1
            if isinstance(error, BrokenExecutor):
                self._pool = None  # the next piece of work gets new processes
        if error is None:
            future.set_result(inner.result())
        else:
            future.set_exception(error)
        self.wake()

    def _processes(self) -> ProcessPoolExecutor:
        if self._pool is None:  # a fork would take the server's threads and sockets along
            fresh = multiprocessing.get_context("spawn")
            self._pool = ProcessPoolExecutor(self.count, mp_context=fresh)
        return self._pool


class Line(Executor):
    """What one job has submitted and no process has begun."""

    def __init__(self, workers: Workers) -> None:
        self.workers = workers
        self.waiting: deque[tuple[Future[Any], partial[Any]]] = deque()

    def submit(self, fn: Callable[..., Any], /, *args: Any, **kwargs: Any) -> Future[Any]:
        """Queue a call."""
        future: Future[Any] = Future()
        self.waiting.append((future, partial(fn, *args, **kwargs)))
        self.workers.wake(self)
        return future


WORKERS = Workers()
_THREADS = ThreadPoolExecutor(JOBS, thread_name_prefix="study")


class Job:
    """One piece of long work.

    Parameters
    ----------
    work : callable
        Called with an executor and a `progress` in a thread; returns the result.
    progress : callable
        Called on the page with the numbers of things done and of all things.
    finish : callable
        Called on the page with the result, or the exception.
    """

    def __init__(
        self, work: Work, progress: Callable[[int, int], None], finish: Callable[[Any], None]
    ) -> None:
        self._work, self._progress, self._finish = work, progress, finish
        self._cancelled = threading.Event()
        self._post = poster()
        self._future = _THREADS.submit(self._run)

    def cancel(self) -> None:
        """Begin no further part of the work; what it would have brought is not shown."""
        self._cancelled.set()
        self._future.cancel()

    def _run(self) -> None:
        try:
            end = self._work(WORKERS.line(), self._tell)
        except Cancelled:
            return
        except Exception as error:  # whatever it is, the page says so
            end = error
        self._on_page(self._finish, end)

    def _tell(self, done: int, total: int) -> bool:
        if not self._cancelled.is_set():
            self._on_page(self._progress, done, total)
        return not self._cancelled.is_set()

    def _on_page(self, callback: Callable[..., None], *arguments: Any) -> None:
        def call() -> None:
            if not self._cancelled.is_set():
                with pn.io.hold():
                    callback(*arguments)

        self._post(call)


def poster() -> Callable[[Callable[[], None]], object]:
    """Return what runs a function on the thread of the page that is being served."""
    document = pn.state.curdoc
    if document is None:  # a notebook cell takes updates from any thread
        return lambda callback: callback()
    return lambda callback: document.add_next_tick_callback(callback)
