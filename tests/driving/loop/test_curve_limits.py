"""What the gate's envelope leaves of the front wheels at the set speed, and which paths are refused for it."""

import math

import pytest

from drawbar.config import load_configuration
from drawbar.driving.loop.curve_limits import demand_slow_curves, within_envelope
from drawbar.driving.loop.driven_line import DrivenLine
from drawbar.errors import PathError
from drawbar.guidance.figure_eight import figure_eights
from drawbar.safety.envelope import Bounds, Envelope


def at(speed, *changes):
    return load_configuration("articulated", [f"speed={speed}", *changes])


@pytest.mark.parametrize(("speed", "limit"), [(0.5, 30.0), (1.6, 30.0), (2.0, 21.65), (3.0, 10.91)])
def test_the_controller_keeps_to_what_the_gate_lets_pass(speed, limit):
    configuration = at(speed)
    found = within_envelope(configuration).vehicle.tractor_steering_limit
    assert math.degrees(found) == pytest.approx(limit, abs=0.01)
    gate = Envelope(configuration.safety, Bounds(wheelbase=1.4, tractor_limit=math.radians(30.0), trailer_limit=0.3))
    assert found <= gate.angle_cap(speed + 0.29)


def test_a_curve_that_is_too_tight_for_the_speed_is_refused_with_what_to_do():
    path = figure_eights((12.0, 6.67), 20.0)
    with pytest.raises(PathError, match=r"curve of 6\.7 m radius at 1\d\d m .* 15\.4°.* 10\.9°.* at most 2\.45 m/s"):
        DrivenLine.first(at(3.0), path)
    assert DrivenLine.first(at(2.45), path).path is path
    with pytest.raises(PathError, match=r"at speed = 2\.5 m/s"):
        demand_slow_curves(path, at(2.5))
    demand_slow_curves(path, at(3.0, "safety.envelope.lateral_acceleration=3.0"))


def test_a_limit_that_no_speed_keeps_is_said_so():
    with pytest.raises(PathError, match=r"0\.02 m/s²: no speed will do; raise that limit, or choose a path"):
        demand_slow_curves(figure_eights((6.67,), 20.0), at(1.0, "safety.envelope.lateral_acceleration=0.02"))


def test_a_line_beside_it_that_is_tighter_is_refused_too():
    line = DrivenLine.first(at(3.0), figure_eights((11.0,), 40.0))
    assert line.beside(0.1).offset == 0.1
    with pytest.raises(PathError, match=r"curve of 9\.0 m radius"):
        line.beside(2.0)


def test_where_the_speed_takes_nothing_away_nothing_is_refused():
    tight = figure_eights((3.34,), 20.0)
    assert DrivenLine.first(at(1.0), tight).path is tight
