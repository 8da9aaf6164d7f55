"""Browsers without a screen, for measuring: they open the drive page and acknowledge each picture.

`python -m drawbar.console.browsers ADDRESS` floods the console there until it is ended, and prints a line each time
the console ends or refuses its connection.
"""

import asyncio
import json
import os
import re
import sys
import time
from contextlib import suppress
from dataclasses import dataclass, field

import aiohttp

_CLIENT = re.compile(r"'client_id': '([0-9a-f-]+)'")
_DRAWN = re.compile(r'"listener_id":"([0-9a-f-]+)","type":"drawn"')
_DRAW = re.compile(r"return runMethod\((\d+), \"draw\", \[(.*)\]\)$", re.DOTALL)
Place = tuple[float, ...]
"""x, y (m) and yaw (rad) of tractor and trailer, as pictures have them"""
_FLOOD = 200
"""messages at once"""


@dataclass(slots=True)
class Seen:
    """What one browser was sent."""

    pictures: list[tuple[int, Place]] = field(default_factory=list)
    """when each was there (monotonic, ns), and where the bodies are in it"""
    ends: int = 0
    """how often the console has ended its connection"""


async def draws(address: str, seen: Seen) -> None:
    """Draw what comes, until cancelled."""
    async with _opened() as session:
        page, listener = await _page(session, address)
        async with _socket(session, address, page) as socket:
            async for message in socket:
                answer = _answer(message.data, seen, page, listener)
                if answer:
                    await socket.send_str(answer)
    seen.ends += 1


async def reads_nothing(address: str, seen: Seen) -> None:
    """Open the page and its connection, and never read what comes, until cancelled."""
    async with _opened() as session:
        page, _ = await _page(session, address)
        async with _socket(session, address, page) as socket:
            await socket.receive()
            await socket.send_str("40")
            await asyncio.Event().wait()


async def floods(address: str, seen: Seen) -> None:
    """Let another process flood the console, until cancelled: in this one it would be late for what others are sent."""
    flood = await asyncio.create_subprocess_exec(
        sys.executable, "-m", "drawbar.console.browsers", address, stdout=asyncio.subprocess.PIPE
    )
    assert flood.stdout is not None
    try:
        while await flood.stdout.readline():
            seen.ends += 1
    finally:
        flood.kill()
        await flood.wait()


async def _flood(address: str) -> None:
    """Send as much as the console takes, and come again when it ends the connection."""
    async with _opened() as session:
        while True:
            with suppress(aiohttp.ClientError, ConnectionError, RuntimeError):
                page, _ = await _page(session, address)
                async with _socket(session, address, page) as socket:
                    await socket.receive()
                    await socket.send_str("40")
                    while not socket.closed:
                        for _ in range(_FLOOD):
                            await socket.send_str('42["log",{"client_id":"","level":"info","message":""}]')
                        await asyncio.sleep(0.01)
            print("ended", flush=True)
            await asyncio.sleep(0.1)


def _opened() -> aiohttp.ClientSession:
    return aiohttp.ClientSession(cookie_jar=aiohttp.CookieJar(unsafe=True))


async def _page(session: aiohttp.ClientSession, address: str) -> tuple[str, str]:
    """Return the ids of the page and of the listener for drawn pictures."""
    async with session.get(address, headers={"Connection": "close"}) as answer:  # browsers use another for the socket
        text = await answer.text()
    client, listener = _CLIENT.search(text), _DRAWN.search(text)
    if client is None or listener is None:
        raise RuntimeError(f"{address}: this is not the drive page")
    return client[1], listener[1]


def _socket(
    session: aiohttp.ClientSession, address: str, page: str
) -> "aiohttp.client._WSRequestContextManager":  # what it is called is not public
    names = {"EIO": "4", "transport": "websocket", "client_id": page, "tab_id": page, "document_id": page}
    names |= {"next_message_id": "0", "implicit_handshake": "true"}
    return session.ws_connect(f"{address}_nicegui_ws/socket.io/", params=names)


def _answer(text: str, seen: Seen, page: str, listener: str) -> str:
    """Return what a browser answers to a message of the console, as Engine.IO and Socket.IO frame it."""
    if text[:1] == "0":
        return "40"
    if text[:1] == "2":
        return "3"
    if not text.startswith('42["run_javascript"'):
        return ""
    found = _DRAW.match(json.loads(text[2:])[1]["code"])
    if found is None:
        return ""
    if place := place_of(text):
        seen.pictures.append((time.monotonic_ns(), place))
    picture = json.loads(found[2])
    said = {"id": int(found[1]), "client_id": page, "listener_id": listener, "args": [json.dumps(picture["seen"])]}
    return f"42{json.dumps(['event', said])}"


def place_of(text: str) -> Place:
    """Return where the bodies are in a message of the console; empty where it is no picture, or shows none."""
    found = _DRAW.match(json.loads(text[2:])[1]["code"])
    moving = json.loads(found[2])["moving"] if found is not None else None
    return (*moving["tractor"], *moving["trailer"]) if moving else ()


if __name__ == "__main__":
    os.nice(10)  # it stands for another computer, which takes nothing from this one's processor
    asyncio.run(_flood(sys.argv[1]))
