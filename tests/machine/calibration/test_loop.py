"""Dead bands of closed loops, on the stand-in of a board whose motor is known not to move at first."""

import math

import numpy as np
import pytest
from steer_bench import Bench

from drawbar.machine.calibration.loop import LoopDrive, loop_dead_band
from drawbar.machine.stand_in.wheel import MotorWheel


def steered(
    stiction: int, *, firmware: str = "v4", seconds: float = 60.0, fastest: float = 1.0
) -> tuple[LoopDrive, Bench]:
    """Let a board with a motor of that stiction follow slow waves of the set point, fastest in degrees a second."""
    bench = Bench(firmware=firmware, wheel=MotorWheel(stiction=stiction))
    bench.engage()
    rows = []
    while bench.time < bench.start + 3.5 + seconds:
        phase = 2.0 * math.pi * (bench.time - bench.start) / 15.0
        bench.ask(steer=True, angle=math.radians(fastest) * 15.0 / (2.0 * math.pi) * math.sin(phase))
        bench.tick()
        rows.append((bench.report.angle_time, bench.request.angle, bench.report.angle))
    times, asked, measured = np.array(rows).T
    return LoopDrive(times=times, asked=asked, measured=measured), bench


def true_band(bench: Bench, stiction: int) -> float:
    """Return the error (rad) at which the board's own rule drives its motor more than it needs to move."""
    return math.radians(next(each for each in np.arange(0.0, 5.0, 0.01) if abs(bench.board._drive(each)) > stiction))


@pytest.mark.parametrize("stiction", [20, 30, 40])
def test_the_dead_band_of_a_board_is_found_within_its_deviation(stiction: int) -> None:
    drive, bench = steered(stiction)
    found = loop_dead_band(drive)
    assert found.accepted, found.refusals
    assert abs(found.value - true_band(bench, stiction)) <= 3.0 * found.deviation
    assert found.deviation < math.radians(0.15)


def test_what_does_not_show_it_is_refused() -> None:
    short, _ = steered(30, seconds=5.0)
    assert "motions from rest" in loop_dead_band(short).refusals[0]
    fast, _ = steered(30, fastest=20.0)
    assert not loop_dead_band(fast).accepted
    nothing = LoopDrive(times=np.zeros(0), asked=np.zeros(0), measured=np.zeros(0))
    assert math.isnan(loop_dead_band(nothing).value)
