"""The web demo as its container starts it, without the container: ``python -m demo``."""

from __future__ import annotations

import os
import re
import signal
import subprocess
import sys
import time
import urllib.error
import urllib.request
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from pathlib import Path

import pytest

from tests.conftest import ROOT, free_port

DEPLOY = ROOT / "deploy"
Proxy = Callable[..., str]


def ask(url: str) -> tuple[int, str]:
    """Status and text of what a URL answers."""
    try:
        with urllib.request.urlopen(url, timeout=30) as answer:
            return answer.status, answer.read().decode()
    except urllib.error.HTTPError as error:
        with error:
            return error.code, error.read().decode()


@dataclass
class Demo:
    url: str
    log: Path
    process: subprocess.Popen[bytes] = field(repr=False)

    @property
    def port(self) -> int:
        return int(re.findall(r":(\d+)", self.url)[0])

    def logged(self) -> str:
        return self.log.read_text()

    def stop(self, number: int = signal.SIGTERM) -> int:
        if self.process.poll() is None:
            self.process.send_signal(number)
        return self.process.wait(timeout=5)


def command(**settings: str) -> tuple[list[str], dict[str, str]]:
    """How to start a demo with these environment variables."""
    paths = [str(path) for path in (DEPLOY, ROOT / "app", ROOT / "model")]
    kept = {name: value for name, value in os.environ.items() if name != "PREFIX"}
    environment = kept | {"PYTHONPATH": os.pathsep.join(paths)} | settings
    return [sys.executable, "-m", "demo"], environment


@pytest.fixture
def demo(tmp_path: Path) -> Iterator[Callable[..., Demo]]:
    """Start a demo: ``demo(SESSION_LIMIT="2")``."""
    demos: list[Demo] = []

    def start(**settings: str) -> Demo:
        port = free_port()
        arguments, environment = command(PORT=str(port), **settings)
        log = tmp_path / f"{port}.log"
        with log.open("wb") as output:
            process = subprocess.Popen(
                arguments, env=environment, stdout=output, stderr=subprocess.STDOUT, cwd=DEPLOY
            )
        started = Demo(f"http://127.0.0.1:{port}{settings.get('PREFIX', '')}", log, process)
        demos.append(started)
        for _ in range(300):
            if "serving at" in started.logged() or process.poll() is not None:
                break
            time.sleep(0.1)
        assert process.poll() is None, started.logged()
        return started

    yield start
    for one in demos:
        if one.process.poll() is None:
            one.process.kill()
        one.process.wait()


@pytest.fixture
def proxy(tmp_path: Path) -> Iterator[Proxy]:
    """Start nginx with the project's own configuration before some demos; returns its address."""
    running: list[subprocess.Popen[bytes]] = []

    def start(*demos: Demo) -> str:
        port = free_port()
        text = (DEPLOY / "nginx.conf").read_text()
        (replica,) = re.findall(r"^ *server demo:5006(.*);$", text, flags=re.MULTILINE)
        replicas = "".join(f"server 127.0.0.1:{demo.port}{replica};\n" for demo in demos)
        text = text.replace(f"server demo:5006{replica};\n", replicas)
        text = text.replace("listen 8080;", f"listen 127.0.0.1:{port};")
        text = text.replace("/tmp/", f"{tmp_path}/")
        text = text.replace("worker_processes auto;", "worker_processes 1;")
        (tmp_path / "nginx.conf").write_text(text)
        command = ["nginx", "-c", str(tmp_path / "nginx.conf"), "-g", "daemon off;"]
        with (tmp_path / "nginx.log").open("wb") as log:
            running.append(subprocess.Popen(command, stderr=log))
        url = f"http://127.0.0.1:{port}"
        for _ in range(50):
            try:
                ask(f"{url}/liveness")
            except OSError:
                time.sleep(0.1)
        return url

    yield start
    for process in running:
        process.terminate()
        process.wait(timeout=10)
