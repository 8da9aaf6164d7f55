"""Every safety setting does something: each is changed alone, and a test sees that the gate behaves differently.

The table is held against the settings' classes, so that a new setting without a line here fails.
"""

from collections.abc import Iterator
from dataclasses import replace

import pytest
from gate_bench import BOUNDS, Bench
from pydantic import BaseModel
from setting_looks import (
    angle_cap,
    armed_after,
    clipped,
    command_lasting,
    degraded_speed,
    degraded_then_calm,
    engaging_for,
    flooded,
    garbage_forgotten,
    largest_speed,
    late,
    leaps,
    lease_after,
    nudged,
    overrun_forgotten,
    rate_cap,
    ready_after,
    refuses,
    saying,
    seen_after,
    set_points,
    silent,
    silent_angle,
    speeds,
    state_after,
    state_on_the_way,
    steering_apart,
    stopping_for,
    stuck,
    suspended_for,
    ticks_in_a_second,
    told_priority,
    unknown_speed,
    untried,
    wheels_do_not_take,
)

from drawbar.safety.causes import Cause
from drawbar.safety.settings import SafetySettings


def names(model: type[BaseModel], before: str = "") -> Iterator[str]:
    """Yield the dotted name of every setting."""
    for name, field in model.model_fields.items():
        if isinstance(field.annotation, type) and issubclass(field.annotation, BaseModel):
            yield from names(field.annotation, f"{before}{name}.")
        else:
            yield before + name


def changed(name, value):
    section, _, key = name.rpartition(".")
    return SafetySettings.model_validate({section: {key: value}} if section else {key: value})


FIX = {"tractor_quality": 4}
TABLE = {
    "engage.hold": (8.0, ready_after),
    "engage.arming": (1.0, armed_after(2.0)),
    "engage.seen": (0.2, seen_after(0.5)),
    "engage.fixed": (60.0, refuses(Cause.FIX_TOO_NEW)),
    "engage.correction_age": (0.5, refuses(Cause.CORRECTIONS_OLD)),
    "engage.lateral_deviation": (0.01, refuses(Cause.POSITION_UNSURE)),
    "engage.heading_deviation": (0.005, refuses(Cause.HEADING_UNSURE)),
    "engage.lateral_error": (0.05, refuses(Cause.OFF_LINE)),
    "engage.heading_error": (0.01, refuses(Cause.ACROSS_LINE)),
    "engage.speed": (1.5, refuses(Cause.TOO_SLOW)),
    "engage.steering_error": (0.3, steering_apart),
    "engage.hitch_angle": (0.05, refuses(Cause.HITCH_ANGLE)),
    "engage.solved": (100, refuses(Cause.UNPROVED)),
    "engage.quiet": (0.5, overrun_forgotten),
    "engage.clean": (0.5, garbage_forgotten),
    "engage.emergency_test": (False, untried(Cause.EMERGENCY_UNTRIED, lambda bench: None)),
    "engage.wiggle_test": (False, untried(Cause.WIGGLE_UNTRIED, lambda b: b.controller.update(wiggled=0))),
    "engage.recorder": (False, untried(Cause.NOT_RECORDING, lambda b: setattr(b, "recorder", None))),
    "drive.engaging": (1.5, engaging_for(2.0, wheels_do_not_take)),
    "drive.easing": (0.2, engaging_for(0.5)),
    "drive.budget": (2.0, state_after(5.0, saying(**FIX))),
    "drive.recovery": (0.5, degraded_then_calm(1.0)),
    "drive.degraded_speed": (0.25, degraded_speed),
    "drive.stopping": (2.0, stopping_for(3.0, lateral_deviation=1.0)),
    "drive.abandoning": (2.0, stopping_for(3.0)),
    "drive.comfort": (1.0, stopping_for(2.0)),
    "drive.deceleration": (0.7, stopping_for(1.0)),
    "drive.emergency_deceleration": (2.0, stopping_for(6.0)),
    "drive.standing": (0.5, stopping_for(2.0, speed=0.2)),
    "drive.stood": (3.0, stopping_for(2.0, speed=0.0)),
    "drive.correction_age": (0.5, state_after(0.2)),
    "drive.lateral_deviation": (0.01, state_after(0.2)),
    "drive.lateral_error": (0.3, state_on_the_way(0.2, tractor_lateral_error=0.5)),
    "drive.leaving": (0.05, state_after(0.2)),
    "drive.hitch_angle": (0.05, state_after(0.2)),
    "drive.overruns": (1, state_after(0.2, saying(overruns=1))),
    "drive.operator": (0.3, state_after(1.0, lambda bench: setattr(bench, "operator", False))),
    "drive.stuck_angle": (0.01, stuck(0.03, 0.0, 1.5)),
    "drive.stuck_move": (0.05, stuck(0.1, 0.02, 1.5)),
    "drive.stuck_time": (0.3, stuck(0.1, 0.0, 0.5)),
    "drive.reversed_angle": (0.001, stuck(0.018, -0.02, 0.7, ahead=False)),
    "drive.reversed_time": (0.2, stuck(0.05, -0.6, 0.3, ahead=False)),
    "drive.jump_rate": (1.0, leaps(0.06)),
    "drive.jump_angle": (0.06, leaps(0.06)),
    "envelope.speed": (0.5, state_after(0.2)),
    "envelope.acceleration": (0.5, unknown_speed),
    "envelope.lateral_acceleration": (0.5, angle_cap),
    "envelope.lateral_jerk": (0.5, rate_cap),
    "envelope.steering_rate": (0.05, set_points),
    "envelope.steering_lead": (0.1, set_points),
    "envelope.steering_reach": (0.05, set_points),
    "envelope.clips": (2, clipped(3)),
    "envelope.flood": (4, flooded(8)),
    "timing.tick": (0.1, ticks_in_a_second),
    "timing.command": (0.1, command_lasting(0.15)),
    "timing.controller": (0.1, state_after(0.3, lambda bench: setattr(bench, "controller", None))),
    "timing.speed": (0.1, speeds(0.3)),
    "timing.speed_difference": (0.1, speeds(0.3, wheel_speed=1.0, receiver_speed=1.3)),
    "timing.speed_samples": (1, largest_speed),
    "timing.speed_ratio": (3.0, state_after(1.0, saying(wheel_speed=0.5, receiver_speed=0.9))),
    "timing.fix": (2.0, state_after(0.7, saying(**FIX))),
    "timing.angle": (0.05, state_after(0.2, silent_angle)),
    "timing.angle_lost": (0.1, state_after(0.2, silent_angle)),
    "timing.recorder": (0.2, silent("recorder", Cause.NOT_RECORDING, 0.5)),
    "timing.guard": (0.2, silent("guard", Cause.NOT_GUARDED, 0.5)),
    "timing.late": (0.01, state_after(0.1, late(0.05))),
    "timing.suspended": (5.0, suspended_for(1.0)),
    "timing.off": (3.0, ticks_in_a_second),
    "timing.lease": (0.2, lease_after(0.5)),
    "timing.priority": (7, told_priority),
    "nudge": (0.1, nudged),
}


def test_every_setting_is_in_the_table():
    assert list(TABLE) == list(names(SafetySettings))


@pytest.mark.parametrize("name", list(TABLE))
def test_changing_a_setting_changes_what_the_gate_does(name):
    value, look = TABLE[name]
    assert look(changed(name, value)) != look(SafetySettings())


def test_equal_settings_have_equal_fingerprints_and_changed_ones_do_not():
    assert SafetySettings().fingerprint() == SafetySettings().fingerprint()
    prints = {changed(name, value).fingerprint() for name, (value, _) in TABLE.items()}
    assert len(prints) == len(TABLE)
    assert SafetySettings().fingerprint() not in prints


@pytest.mark.parametrize("field", ["wheelbase", "tractor_limit", "trailer_limit"])
def test_the_vehicles_bounds_do_something_too(field):
    def look(bounds):
        bench = Bench(bounds=bounds)
        bench.speed = 3.0
        bench.drive()
        bench.command = {"tractor_angle": 1.0, "trailer_angle": 1.0}
        bench.run(0.2)
        return bench.gate._envelope.angles

    assert look(replace(BOUNDS, **{field: 0.1})) != look(BOUNDS)
