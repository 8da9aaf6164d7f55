"""Bare valves: what a record of pushes shows, of a valve whose truth is known, and what is no such record."""

import math

import numpy as np
import pytest

pytest.importorskip("nicegui", reason="the extra `console` is not installed")
pytest.importorskip("shapefile", reason="the extra `console` is not installed")

from console_stage import staged, until
from nicegui import ui

from drawbar.console.push_record import PushFile
from drawbar.console.words import Words
from drawbar.errors import DrawbarError

PERIOD = 0.02
BANDS, RATES, LAG, DEAD_TIME = {1: 0.12, -1: 0.2}, {1: 25.0, -1: 18.0}, 0.1, 0.04
"""by side, 1 is left: dead band, full rate in degrees per second; s"""


class Valve:
    """A valve with a lag and a dead time, and the rows that its sensor makes."""

    def __init__(self, direction):
        self.direction, self.time, self.angle, self.rate, self.rows = direction, 0.0, 0.0, 0.0, []
        self._waiting = [0.0] * round(DEAD_TIME / PERIOD)

    def hold(self, drive, duration):
        """Drive it for a time, s; return how far it has turned, degrees."""
        before = self.angle
        for _ in range(round(duration / PERIOD)):
            self.rows.append(f"{self.time:.2f},{drive:.2f},{round(self.angle, 2)}")
            self._waiting.append(drive * self.direction)
            now = self._waiting.pop(0)
            side = 1 if now > 0.0 else -1
            opening = max(abs(now) - BANDS[side], 0.0) / (1.0 - BANDS[side])
            aim, share = side * RATES[side] * opening, -math.expm1(-PERIOD / LAG)
            self.angle += PERIOD * aim + (self.rate - aim) * LAG * share
            self.rate += share * (aim - self.rate)
            self.time += PERIOD
        return self.angle - before


def pushed(direction):
    """Return the record of a valve that was pushed as the card says."""
    valve = Valve(direction)
    valve.hold(0.0, 1.0)
    for run in range(6):
        sign, moved, percent = 1 - 2 * (run % 2), 0, 0
        while moved < 4:
            percent += 1
            way = valve.hold(sign * percent / 100.0, 0.5) + valve.hold(0.0, 0.5)
            moved += abs(way) > 0.3
    for push in range(10):
        valve.hold(0.45 * (1 - 2 * (push % 2)), 0.8)
        valve.hold(0.0, 0.8)
    return "\n".join(["time,drive,angle", *valve.rows]).encode()


@pytest.mark.parametrize("direction", [1, -1])
def test_a_record_shows_the_valves_numbers_whichever_way_it_is_connected(direction):
    found = {each.name: each.value for each in PushFile.of(pushed(direction), "a.csv").found()}
    assert all(value.accepted for value in found.values()), found
    for side, sign in (("left", 1), ("right", -1)):
        assert found[f"{side}: dead band"].value == pytest.approx(BANDS[sign], abs=0.01)
        assert math.degrees(found[f"{side}: full rate"].value) == pytest.approx(RATES[sign], rel=0.05)
        assert found[f"{side}: lag"].value == pytest.approx(LAG, abs=0.02)
        assert found[f"{side}: dead time"].value == pytest.approx(DEAD_TIME, abs=0.02)
    assert all(isinstance(each, float) for value in found.values() for each in (value.value, value.deviation))


def test_what_was_not_pushed_is_not_found_and_said_in_both_languages():
    rows = pushed(1).decode().splitlines()
    few = "\n".join(rows[: len(rows) // 9]).encode()
    for each in PushFile.of(few, "a.csv").found():
        assert not each.value.accepted
        for text in (*each.value.refusals, each.name, each.value.unit):
            assert Words("de").message(text) != text
    gap = [row for row in rows[1:] if not 0.2 < float(row.split(",")[0]) % 1.0 < 0.45]
    with pytest.raises(DrawbarError, match="without gaps"):  # silent in each push: none counts
        PushFile.of("\n".join(gap).encode(), "a.csv")


@pytest.mark.parametrize(
    ("data", "told"),
    [
        (b"\xff\xfe", "byte 0 is not UTF-8"),
        (b"time,drive,angle\n0,0,0\n", "has 1 rows"),
        (b"0,0\n", "3 numbers separated by commas"),
        (b"\n".join(b"%d,nan,0" % i for i in range(20)), "not finite"),
        (b"\n".join(b"1,0,0" for _ in range(20)), "times do not rise"),
        (b"\n".join(b"%d,45,0" % i for i in range(20)), "a drive beyond"),
        (b"\n".join(b"%d,0,200" % i for i in range(20)), "an angle beyond"),
        (b"\n".join(b"%d,0,0" % i for i in range(20)), "holds no push"),
    ],
)
def test_a_file_that_is_no_record_is_refused_with_its_name(data, told):
    with pytest.raises(DrawbarError, match=told) as caught:
        PushFile.of(data, "a.csv")
    assert str(caught.value).startswith("a.csv")
    assert Words("de").message(caught.value) != str(caught.value)


@staged
async def test_the_card_takes_a_record_draws_it_and_lists_what_was_found(stage, browser):
    one = await browser().open("/setup")
    (upload,) = one.user.find(ui.upload).elements
    for data in (b"0,0\n", pushed(1)):
        answer = await one.user.http_client.post(upload.props["url"], files={"file": ("a.csv", data)})
        assert answer.status_code == 200
    await until(lambda: "left: dead band: 0.12" in one.text())
    assert "3 numbers separated by commas" in one.told()
    assert one.text().count("✓ 3 / 3") == 1
    assert "✓ 5 / 3" in one.text()
    assert "settings of drawbar_actuate" in one.text()
    assert (
        np.count_nonzero([isinstance(each, ui.echart) and each.visible for each in one.user.client.elements.values()])
        == 2
    )
