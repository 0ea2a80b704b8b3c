"""Send a running demo what nobody should send it, and see that it stands.

    python deploy/hostile.py http://127.0.0.1:5006 [--pid PID] [--memory-mb 512]

Give it an address of this machine only. It sends a bounded number of requests, stops by itself,
prints a line for each check and ends with 1 if one failed. The standard library is all it needs.
"""

from __future__ import annotations

import argparse
import base64
import contextlib
import json
import os
import re
import socket
import struct
import sys
import time
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from urllib.parse import quote, urlsplit

SCRIPT = "<script>window.hacked=1</script>"
MEGABYTE = 1_000_000
TEXT, BINARY = 1, 2


class Target:
    """The demo under test: raw sockets, as no well-behaved client says such things."""

    def __init__(self, url: str, pid: int | None) -> None:
        parts = urlsplit(url)
        self.host, self.port = parts.hostname or "", parts.port or 80
        self.path = parts.path.rstrip("/")
        self.name = parts.netloc
        self.pid = pid

    def connect(self, seconds: float = 15) -> socket.socket:
        """Return a new connection."""
        return socket.create_connection((self.host, self.port), timeout=seconds)

    def say(self, raw: bytes, seconds: float = 15) -> bytes:
        """Send bytes; return what comes back until the other side ends it."""
        answer = b""
        with self.connect(seconds) as line, contextlib.suppress(OSError):
            with contextlib.suppress(OSError):  # the other side may have heard enough
                line.sendall(raw)
            while piece := line.recv(65536):
                answer += piece
        return answer

    def get(self, place: str, *headers: str, method: str = "GET", seconds: float = 60) -> bytes:
        """Ask for a page."""
        lines = [f"{method} {self.path}{place} HTTP/1.1", f"Host: {self.name}", *headers]
        raw = "\r\n".join([*lines, "Connection: close", "", ""]).encode()
        return self.say(raw, seconds)

    def status(self, place: str, *headers: str, method: str = "GET") -> int:
        """Return the status of the answer, 0 if there was none."""
        return status(self.get(place, *headers, method=method))

    def memory(self) -> float:
        """Return the resident memory of the process [MB]."""
        told = Path(f"/proc/{self.pid}/status").read_text()
        (kilobytes,) = re.findall(r"^VmRSS:\s+(\d+)", told, flags=re.MULTILINE)
        return int(kilobytes) * 1024 / MEGABYTE

    def visit(self) -> str:
        """Load the page and return its token; wait for a place if there is none."""
        for _ in range(30):
            token = re.search(rb'"token":"([^"]+)"', page := self.get("/"))
            if token:
                return token[1].decode()
            time.sleep(1)
        raise AssertionError(f"no page: {page[:200]!r}")

    @contextlib.contextmanager
    def websocket(self, token: str, origin: str | None = None) -> Iterator[socket.socket]:
        """Open a websocket as the page does."""
        key = base64.b64encode(os.urandom(16)).decode()
        with self.connect() as line:
            line.sendall(
                f"GET {self.path}/ws HTTP/1.1\r\nHost: {self.name}\r\nUpgrade: websocket\r\n"
                f"Connection: Upgrade\r\nSec-WebSocket-Key: {key}\r\nSec-WebSocket-Version: 13\r\n"
                f"Origin: {origin or 'http://' + self.name}\r\n"
                f"Sec-WebSocket-Protocol: bokeh, {token}\r\n\r\n".encode()
            )
            yield line


def status(answer: bytes) -> int:
    """Return the status of an answer, 0 for none."""
    found = re.match(rb"HTTP/1\.1 (\d{3})", answer)
    return int(found[1]) if found else 0


def frame(kind: int, content: bytes, *, final: bool = True, length: int | None = None) -> bytes:
    """Return a masked websocket frame; `length` is what it claims to hold."""
    size = len(content) if length is None else length
    head = struct.pack("!BB", (128 if final else 0) | kind, 128 | (127 if size > 125 else size))
    return head + (struct.pack("!Q", size) if size > 125 else b"") + b"\0\0\0\0" + content


def message(kind: str, content: object) -> bytes:
    """Return a Bokeh message as three frames."""
    header = {"msgid": os.urandom(8).hex(), "msgtype": kind}
    return b"".join(frame(TEXT, json.dumps(part).encode()) for part in (header, {}, content))


def heard(line: socket.socket, word: bytes) -> None:
    """Read until a word has come."""
    told = b""
    while word not in told:
        told += (piece := line.recv(65536))
        assert piece, f"the line was closed before {word!r} came, after {told[:80]!r}"


def drained(line: socket.socket) -> bytes:
    """Return what comes until the other side closes."""
    got = b""
    with contextlib.suppress(OSError):
        while piece := line.recv(65536):
            got += piece
    return got


# ------------------------------------------------------------------------------------ the checks


def oversized_and_malformed_addresses(it: Target) -> None:
    """Each gets an error, none an echo."""
    for place in (
        "/" + "a" * 5000,
        "/?Ky=" + "9" * 5000,
        "/?Ky=" + "9" * 1_000_000,
        "/%00", "/%ff%fe", "/../../../../etc/passwd", "/static/../../../etc/passwd",
        "/static/..%2f..%2f..%2fetc/passwd", "/static//etc/passwd", "/" + quote(SCRIPT),
        "/liveness?endpoint=/", "/autoload.js?bokeh-autoload-element=" + quote(SCRIPT),
        "/metadata", "/?bokeh-session-id=x&bokeh-token=y", "/?bokeh-token=" + "A" * 3000,
    ):  # fmt: skip
        answer = it.get(place)
        assert status(answer) in {0, 200, 400, 403, 404, 414, 431, 500, 503}, answer[:80]
        assert b"root:" not in answer, place[:60]
        assert SCRIPT.encode() not in answer, place[:60]
    for raw in (b"\0" * 4096, b"GET\r\n\r\n", b"GET / HTTP/9.9\r\n\r\n", os.urandom(4096)):
        assert status(it.say(raw + b"\r\n\r\n", seconds=3)) in {0, 400, 505}


def oversized_and_malformed_headers(it: Target) -> None:
    """Each is refused or left unread."""
    for header in (
        "X: " + "a" * 100_000,
        "Cookie: " + "a=b; " * 20_000,
        "No colon",
        " : ",
        "\0: \0",
    ):
        assert it.status("/liveness", header) in {0, 200, 400, 431}, header[:20]
    many = [f"X-{n}: {n}" for n in range(5000)]
    assert it.status("/liveness", *many) in {0, 400, 431}
    for header in ("Content-Length: -1", "Content-Length: 9" * 2, "Transfer-Encoding: x, chunked"):
        assert it.status("/liveness", header) in {0, 200, 400, 413, 501}, header
    smuggled = it.get("/liveness", "Content-Length: 5", "Transfer-Encoding: chunked")
    assert status(smuggled) in {0, 400}, smuggled[:80]


def scripts_in_values_are_never_echoed(it: Target) -> None:
    """The page never holds one as it was sent."""
    for name in ("Ky", "vehicle", SCRIPT):
        for value in (
            SCRIPT,
            '"><img src=x onerror=alert(1)>',
            "</script>" + SCRIPT,
            "${1}{{1234567*7}}",
        ):
            for _ in range(30):
                answer = it.get(f"/?{quote(name)}={quote(value)}")
                if status(answer) != 503:
                    break
                time.sleep(1)
            assert status(answer) == 200, answer[:80]
            assert value.encode() not in answer, (name, value)
            assert b"8641969" not in answer, "a template was filled in"


def uploads(it: Target) -> None:
    """100 MB are refused before they are read, however they are sent."""
    for method in ("POST", "PUT", "GET"):
        for length in ("Content-Length: 100000000", "Transfer-Encoding: chunked"):
            begin = f"{method} {it.path}/ HTTP/1.1\r\nHost: {it.name}\r\n{length}\r\n\r\n".encode()
            sent = 0
            with it.connect() as line, contextlib.suppress(OSError):
                line.sendall(begin)
                block = b"%x\r\n" % 65536 + b"x" * 65536 + b"\r\n"
                while sent < 100 * MEGABYTE:
                    line.sendall(block)
                    sent += 65536
            assert sent < 20 * MEGABYTE, f"{method} with {length}: {sent / MEGABYTE} MB were taken"
    for method in ("POST", "PUT", "DELETE", "PATCH", "OPTIONS", "TRACE"):
        assert it.status("/", method=method) in {0, 400, 405}, method


def foreign_origins_are_refused(it: Target) -> None:
    """A page of another site cannot open the websocket."""
    token = it.visit()
    for origin in ("http://evil.example", "null", "file://", f"http://{it.name}.evil.example",
                   f"http://evil.example/{it.name}", "http://[::1", "x" * 3000):  # fmt: skip
        with it.websocket(token, origin) as line:
            assert status(line.recv(4096)) in {400, 403}, origin[:40]
    with it.websocket(token) as line:
        assert status(line.recv(4096)) == 101


def malformed_websocket_frames(it: Target) -> None:
    """Each ends its own connection, and no other."""
    for token in ("", "x", "AAAA", base64.b64encode(b'{"session_id": 1}').decode(), "A" * 8000):
        with it.websocket(token) as line:
            line.settimeout(3)
            drained(line)
    token = it.visit()
    with it.websocket(token) as inside:  # an honest visitor who must notice nothing
        heard(inside, b"ACK")
        for raw in (
            frame(TEXT, b"no json") * 3, frame(TEXT, b"\xff\xfe") * 3, frame(BINARY, b"\0" * 99),
            frame(TEXT, b"{}") * 3, message("PATCH-DOC", {"events": [{"kind": "x"}]}),
            message("PATCH-DOC", {"events": [{"kind": "MessageSent", "msg_type": "bokeh_event"}]}),
            message("X" * 9000, []), frame(3, b"reserved"), frame(TEXT, b"", length=2**62),
            frame(TEXT, b"", length=10**9), frame(TEXT, b"[" * 200_000), frame(9, b"p" * 200),
            frame(TEXT, b"x" * 60_000, final=False) * 50, os.urandom(5000),
        ):  # fmt: skip
            with it.websocket(token) as line:
                heard(line, b"ACK")
                line.settimeout(1)
                with contextlib.suppress(OSError):
                    line.sendall(raw)
                drained(line)
        inside.sendall(message("SERVER-INFO-REQ", {}))
        heard(inside, b"SERVER-INFO-REPLY")


def who_reads_nothing_costs_little(it: Target) -> None:
    """Someone who asks for the whole document again and again and reads none of it."""
    token = it.visit()
    before = it.memory() if it.pid else 0
    asked = 0
    with it.websocket(token) as line:
        heard(line, b"ACK")
        line.settimeout(2)
        with contextlib.suppress(OSError):
            while asked < 2000:
                line.sendall(message("PULL-DOC-REQ", {}))
                asked += 1
            time.sleep(3)
        if it.pid:
            grown = it.memory() - before
            assert grown < 60, f"{asked} requests of one visitor took {grown:.0f} MB"


def slow_clients(it: Target) -> None:
    """300 that never finish their request keep nobody out."""
    lines = [it.connect() for _ in range(300)]
    try:
        for line in lines:
            line.sendall(b"GET / HTTP/1.1\r\nX: ")
        for _ in range(3):
            for line in lines:
                line.sendall(b"a")
            began = time.monotonic()
            assert it.status("/liveness") == 200
            assert time.monotonic() - began < 5, "an honest request waited for slow ones"
    finally:
        for line in lines:
            line.close()


def a_thousand_rapid_connects(it: Target) -> None:
    """Half of them say nothing, half load the page: a page or a readable refusal, no hang."""

    def one(number: int) -> int:
        if number % 2:
            it.connect().close()
            return 200
        return it.status("/")

    with ThreadPoolExecutor(32) as crowd:
        seen = list(crowd.map(one, range(1000)))
    assert set(seen) <= {200, 503}, {code: seen.count(code) for code in set(seen)}
    assert it.status("/liveness") == 200


CHECKS: tuple[Callable[[Target], None], ...] = (
    oversized_and_malformed_addresses,
    oversized_and_malformed_headers,
    scripts_in_values_are_never_echoed,
    uploads,
    foreign_origins_are_refused,
    malformed_websocket_frames,
    who_reads_nothing_costs_little,
    slow_clients,
    a_thousand_rapid_connects,
)


def main() -> None:
    """Run all checks against the given address."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("url")
    parser.add_argument("--pid", type=int, help="the server's process, to watch its memory")
    parser.add_argument("--memory-mb", type=float, default=512, help="the most it may take")
    asked = parser.parse_args()
    it = Target(asked.url, asked.pid)
    if it.host not in {"127.0.0.1", "localhost", "::1"}:
        parser.error(f"{asked.url} is not on this machine")
    failed = 0
    for check in CHECKS:
        began = time.monotonic()
        trouble = ""
        try:
            check(it)
            assert it.status("/liveness") == 200, "it answers no more"
            if it.pid:
                assert it.memory() < asked.memory_mb, f"it takes {it.memory():.0f} MB"
        except (AssertionError, OSError) as error:
            trouble = f": {type(error).__name__} {error}"
            failed += 1
        name = check.__name__.replace("_", " ")
        memory = f", {it.memory():.0f} MB" if it.pid and Path(f"/proc/{it.pid}").exists() else ""
        took = time.monotonic() - began
        print(  # noqa: T201
            f"{'FAIL' if trouble else 'ok  '} {name} ({took:.1f} s{memory}){trouble}", flush=True
        )
    sys.exit(1 if failed else 0)


if __name__ == "__main__":
    main()
