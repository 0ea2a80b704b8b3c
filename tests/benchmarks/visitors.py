"""Visitors who drag sliders, as far as the server can tell: the sidebar's messages, no browser.

    python tests/benchmarks/visitors.py URL VISITORS BURSTS

prints as JSON what they met. Each opens the page, takes the websocket's session, drags K_y in
bursts of ten moves with pauses between, rests, and reads the answers that it is shown.
"""

from __future__ import annotations

import asyncio
import itertools
import json
import random
import re
import sys
import time

from tornado.httpclient import AsyncHTTPClient
from tornado.websocket import websocket_connect

MOVES = 10
PAUSE = 0.05  # s between two moves of a hand
REST = 6.0  # s between two bursts, on average


class Visitor:
    """One page's end of the websocket."""

    def __init__(self, url):
        self.url = url
        self.waits = []
        self.answers = ""
        self.gone = False
        self._numbers = itertools.count(1)
        self._answered = {}

    async def open(self):
        page = (await AsyncHTTPClient().fetch(self.url, request_timeout=60)).body.decode()
        token = re.search(r'"token":"([^"]+)"', page)[1]
        socket = self.url.replace("http", "ws", 1).rstrip("/") + "/app/ws"
        self.socket = await websocket_connect(
            socket, subprotocols=["bokeh", token], max_message_size=2**28
        )
        await self._message()  # ACK
        await self._send("PULL-DOC-REQ", {})
        while (reply := await self._message())[0] != "PULL-DOC-REPLY":
            pass
        self._know(reply[1])
        self.listening = asyncio.ensure_future(self._listen())
        await self._event("document_ready")

    def _know(self, node):
        """Remember the ids of the sidebar and of the answers' text."""
        if isinstance(node, list):
            for one in node:
                self._know(one)
        elif isinstance(node, dict):
            attributes = node.get("attributes", {})
            if isinstance(attributes, dict):
                if attributes.get("class_name") == "Sidebar":
                    self.sidebar, self.values = node["id"], attributes["data"]["id"]
                if "answers" in attributes.get("css_classes", []):
                    (text,) = attributes["elements"]
                    self.text, self.answers = text["id"], text["attributes"]["html"]
            for one in node.values():
                self._know(one)

    async def _message(self):
        """Return type and content of the next message."""
        header = await self.socket.read_message()
        if header is None:
            raise ConnectionError("closed by the server")
        header = json.loads(header)
        await self.socket.read_message()
        content = json.loads(await self.socket.read_message())
        for _ in range(2 * header.get("num_buffers", 0)):
            await self.socket.read_message()
        return header["msgtype"], content

    async def _listen(self):
        try:
            while True:
                _, content = await self._message()
                for event in content.get("events", []) if isinstance(content, dict) else []:
                    if event.get("kind") != "ModelChanged":
                        continue
                    at = (event["model"]["id"], event["attr"])
                    if at == (self.values, "answered") and event["new"] in self._answered:
                        self._answered.pop(event["new"]).set_result(time.perf_counter())
                    elif at == (self.text, "html"):
                        self.answers = event["new"]
        except ConnectionError:
            self.gone = True
            for waiting in self._answered.values():
                waiting.cancel()

    async def _send(self, kind, content):
        header = json.dumps({"msgid": f"{id(self)}-{next(self._numbers)}", "msgtype": kind})
        for part in (header, "{}", json.dumps(content)):
            await self.socket.write_message(part)

    async def _event(self, name, **values):
        event = {"type": "event", "name": name, "values": _map(values)}
        sent = {"kind": "MessageSent", "msg_type": "bokeh_event", "msg_data": event}
        await self._send("PATCH-DOC", {"events": [sent]})

    async def act(self, act):
        """Send an act as the sidebar does; return the seconds until it is answered."""
        number = next(self._numbers)
        self._answered[number] = asyncio.get_running_loop().create_future()
        waiting = self._answered[number]
        data = _map({"acts": [_map(act)], "number": number})
        start = time.perf_counter()
        await self._event("data_event", model={"id": self.sidebar}, data=data)
        return await asyncio.wait_for(waiting, 120) - start

    async def drag(self, roll, bursts):
        """Drag in bursts; the last value is where the hand rests."""
        for _ in range(bursts):
            await asyncio.sleep(REST * roll.uniform(0.2, 1.8))
            for _ in range(MOVES):
                self.Ky = round(roll.uniform(6e4, 1.3e5))
                self.waits.append(await self.act({"set": "Ky", "to": self.Ky}))
                await asyncio.sleep(PAUSE)
            await asyncio.sleep(0.4)
            await self.act({"rest": True})
        await asyncio.sleep(3)

    def report(self):
        speeds = re.findall(r"<dd>([\d.]+)<small> km/h", self.answers)
        return {"gone": self.gone, "waits": self.waits, "Ky": self.Ky, "shown": speeds[:2]}

    async def leave(self):
        self.listening.cancel()
        self.socket.close()


def _map(values):
    return {"type": "map", "entries": [[key, value] for key, value in values.items()]}


async def visit(url, count, bursts):
    visitors = [Visitor(url) for _ in range(count)]
    for visitor in visitors:
        await visitor.open()
    await asyncio.sleep(2)
    print("here", file=sys.stderr, flush=True)
    if bursts:
        await asyncio.gather(
            *(v.drag(random.Random(k), bursts) for k, v in enumerate(visitors)),
            return_exceptions=True,
        )
    print(json.dumps([v.report() for v in visitors] if bursts else []), flush=True)
    for visitor in visitors:
        await visitor.leave()


if __name__ == "__main__":
    asyncio.run(visit(sys.argv[1], int(sys.argv[2]), int(sys.argv[3])))
