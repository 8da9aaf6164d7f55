"""The AIO v4 stand-in against what the real firmware did: every byte and every change of its drive, to the ms."""

import math
from typing import Any

import pytest
from golden import load

from drawbar.machine.stand_in.aio_v4 import AioV4
from drawbar.machine.stand_in.wheel import HeldWheel

NAMES = (
    "engage_10hz",
    "engage_5hz",
    "edge_missed_100hz",
    "power_up_into_status_1",
    "silence",
    "resume_after_4s_silence",
    "resume_after_7s_silence",
    "status_0",
    "bad_crc_obeyed",
    "overspeed",
    "standstill",
    "operator_button",
    "wheel_angle_sensor_fault",
    "settings_then_engage",
    "hello_scan",
)


class Trace:
    """A scenario run through the stand-in, one millisecond after the other."""

    def __init__(self, scenario: dict[str, Any]) -> None:
        self.wheel = HeldWheel(-math.radians(scenario["wheel_angle_deg"]))
        self.board = AioV4(self.wheel)
        self.outputs: list[list[Any]] = []
        self.changes: list[list[Any]] = []
        inputs = {(when, kind): value for when, kind, value in scenario["inputs"]}
        for now in range(1, scenario["end_ms"] + 1):
            for kind in ("frame", "pin", "angle_deg"):  # what comes at t is there in the millisecond after
                if (now - 1, kind) in inputs:
                    self.feed(now, kind, inputs[now - 1, kind])
            self.keep(self.board.advance(now / 1000.0))
            self.note(now)

    def feed(self, now: int, kind: str, value: Any) -> None:
        if kind == "frame":
            self.keep(self.board.receive(now / 1000.0, bytes.fromhex(value)))
        elif kind == "pin":
            assert value[0] == 32
            self.board.press(pressed=value[1] == 0)
        else:
            self.wheel.angle = -math.radians(value)

    def keep(self, outputs: list[Any]) -> None:
        self.outputs += [[round(each.time * 1000.0), each.data.hex(), each.destination] for each in outputs]

    def note(self, now: int) -> None:
        board = self.board
        state = {"drive_enabled": board.driving, "pwm_signed": board.pwm, "steer_switch_off": board.steer_off}
        if not self.changes or self.changes[-1][1] != state:
            self.changes.append([now, state])


@pytest.fixture(scope="module")
def scenarios() -> dict[str, dict[str, Any]]:
    return {each["name"]: each for each in load("aog_board_traces.json")["scenarios"]}


def test_every_trace_is_looked_at(scenarios: dict[str, dict[str, Any]]) -> None:
    assert tuple(scenarios) == NAMES


@pytest.mark.parametrize("name", NAMES)
def test_reproduces_the_firmware(scenarios: dict[str, dict[str, Any]], name: str) -> None:
    trace = Trace(scenarios[name])
    assert trace.outputs == scenarios[name]["outputs"]
    assert trace.changes == scenarios[name]["changes"]
