"""Painting: the time until a step is on the screen of a real Chromium, on this computer and as slow as on a phone.

The page is watched from outside: the last message of the console before something is drawn on a canvas, and the frame
after that. Needs playwright and a Chromium of the distribution.
"""

import time
from contextlib import suppress
from dataclasses import dataclass, field
from typing import Any

from drawbar.console.browsers import Place, place_of
from drawbar.console.screenshots import PHONE, WAIT, chromium_path

PHONE_SLOWER = 4
"""times, by which a phone's processor is slower than this one"""
_WATCH = """
(() => {
  window.painted = [];
  let received = null;
  const Plain = window.WebSocket;
  window.WebSocket = class extends Plain {
    constructor(...given) {
      super(...given);
      this.addEventListener("message", ({ data }) => {
        const drawn = /runMethod\\(\\d+, \\\\"draw|plotSteps/;
        if (typeof data === "string" && drawn.test(data)) received = { text: data, at: performance.now() };
      });
    }
  };
  for (const name of ["fillRect", "clearRect"]) {
    const plain = CanvasRenderingContext2D.prototype[name];
    CanvasRenderingContext2D.prototype[name] = function (...given) {
      if (received !== null) {
        const { text, at } = received;
        received = null;
        requestAnimationFrame(() => window.painted.push([text, at, performance.now()]));
      }
      return plain.apply(this, given);
    };
  }
})();
"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Painted:
    """What one page has painted."""

    name: str
    slower: int
    """times, by which the browser was made slower"""
    begin: int
    """monotonic, ns"""
    end: int
    took: list[float] = field(default_factory=list)
    """from each message that was painted to its frame, s"""
    places: list[tuple[int, Place]] = field(default_factory=list)
    """when each picture of the map was on the screen (monotonic, ns), and where the bodies are in it"""


async def paint(address: str, duration: float) -> list[Painted]:
    """Return what is painted of the drive page and of a plot, each for a time, s; nothing without a Chromium.

    A page that does not open in time is left out.
    """
    try:
        from playwright.async_api import TimeoutError as Late
        from playwright.async_api import async_playwright
    except ImportError:
        return []
    program = chromium_path()
    if program is None:
        return []
    async with async_playwright() as playwright:
        browser = await playwright.chromium.launch(executable_path=program, args=["--no-sandbox"])
        page = await browser.new_page(viewport=PHONE, device_scale_factor=3)  # type: ignore[arg-type]
        await page.add_init_script(_WATCH)
        slow = await page.context.new_cdp_session(page)
        painted: list[Painted] = []
        for slower in (1, PHONE_SLOWER):
            await slow.send("Emulation.setCPUThrottlingRate", {"rate": slower})
            for name, path in _PAGES.items():
                with suppress(Late):  # on a computer that is busier than this is worth; the rest is measured
                    painted.append(await _watched(page, name, slower, address + path, duration))
        await browser.close()
    return painted


_PAGES = {"map": "", "plot": "inside"}


async def _watched(page: Any, name: str, slower: int, address: str, duration: float) -> Painted:
    await page.goto(address, timeout=WAIT)
    await page.wait_for_function("window.painted.length > 5", timeout=WAIT)
    await page.evaluate("window.painted = []")
    begin = time.monotonic_ns()
    await page.wait_for_timeout(1e3 * duration)
    end = time.monotonic_ns()
    rows = await page.evaluate("window.painted")
    zero = await page.evaluate("performance.timeOrigin") * 1e6 - (time.time_ns() - time.monotonic_ns())
    found = [(place_of(text), int(zero + at * 1e6)) for text, _, at in rows]
    return Painted(
        name=name,
        slower=slower,
        begin=begin,
        end=end,
        took=[1e-3 * (at - received) for _, received, at in rows],
        places=[(at, place) for place, at in found if place],
    )
