"""The envelope of the gate's process: what is refused, what is limited, and that nominal driving is neither."""

import math

import pytest
from gate_bench import BOUNDS
from hypothesis import given, settings
from hypothesis import strategies as st

from drawbar.messages import CommandMessage, Mode
from drawbar.safety.envelope import AHEAD, Bounds, Envelope, is_after
from drawbar.safety.settings import EnvelopeSettings, SafetySettings

SETTINGS = SafetySettings()
LIMITS = SETTINGS.envelope
DEGREE = math.radians(1.0)


def command(time=10.0, tractor=0.0, trailer=0.0, speed=1.0, *, sequence=1, valid=0.2):
    return CommandMessage(
        sequence=sequence, time=round(time * 1e9), valid_until=round((time + valid) * 1e9), mode=Mode.DRIVE,
        tractor_angle=tractor, trailer_angle=trailer, speed=speed,
    )  # fmt: skip


def begun(angles=(0.0, 0.0), time=10.0, given=SETTINGS, bounds=BOUNDS):
    envelope = Envelope(given, bounds)
    envelope.begin(time, angles)
    return envelope


def test_a_fresh_command_is_admitted_once():
    envelope = Envelope(SETTINGS, BOUNDS)
    assert envelope.admit(command(), 10.0)
    assert not envelope.admit(command(), 10.0), "the same again"
    assert envelope.admit(command(sequence=2), 10.1)


@pytest.mark.parametrize("first", [0, 5, 2**32 - 3])
@pytest.mark.parametrize(
    ("ahead", "admitted"), [(1, True), (10, True), (11, False), (0, False), (-1, False), (2**31, False)]
)
def test_sequences_follow_one_another(first, ahead, admitted):
    envelope = Envelope(SETTINGS, BOUNDS)
    assert envelope.admit(command(sequence=first), 10.0)
    assert envelope.admit(command(sequence=(first + ahead) % 2**32), 10.0) is admitted


@pytest.mark.parametrize(("ahead", "after"), [(0, False), (1, True), (2**31 - 1, True), (2**31, False), (-1, False)])
def test_the_later_half_of_all_sequences_is_before(ahead, after):
    assert is_after((2**32 - 1 + ahead) % 2**32, 2**32 - 1) is after


def test_after_a_refused_gap_the_next_ones_follow_but_no_old_one():
    envelope = Envelope(SETTINGS, BOUNDS)
    assert envelope.admit(command(sequence=100), 10.0)
    assert not envelope.admit(command(sequence=500), 10.0)
    assert envelope.admit(command(sequence=501), 10.0)
    assert not envelope.admit(command(sequence=101), 10.0)
    assert envelope.admit(command(sequence=502), 10.0), "the old one has not become the last"


@pytest.mark.parametrize(
    ("now", "valid", "admitted"),
    [
        (10.0, 0.2, True),
        (10.19, 0.2, True),
        (10.21, 0.2, False),  # too old, and expired
        (9.99, 0.2, False),  # from the future
        (10.0, 0.21, False),  # claims to be valid for too long
        (10.125, 0.125, True),  # at the end of its time
        (10.05, 0.05, True),
        (10.06, 0.05, False),  # expired by its own account
        (10.0, -0.01, False),
    ],
)
def test_times_must_be_possible(now, valid, admitted):
    assert Envelope(SETTINGS, BOUNDS).admit(command(valid=valid), now) is admitted


def test_a_command_may_be_ahead_of_the_gates_clock_by_what_both_are_read_apart():
    time = 10.0 + AHEAD
    assert Envelope(SETTINGS, BOUNDS).admit(command(time=time), 10.0)
    assert not Envelope(SETTINGS, BOUNDS).admit(command(time=time + 1e-9), 10.0)


def test_an_expired_command_does_not_keep_later_ones_out():
    envelope = Envelope(SETTINGS, BOUNDS)
    assert not envelope.admit(command(sequence=1), 11.0)
    assert envelope.admit(command(time=11.0, sequence=2), 11.0)


@pytest.mark.parametrize(
    ("speed", "degrees"), [(0.0, 30.0), (1.0, 30.0), (2.0, 27.7), (2.5, 18.6), (3.0, 13.1), (4.2, 6.8), (-3.0, 13.1)]
)
def test_the_angle_is_capped_by_lateral_acceleration(speed, degrees):
    assert math.degrees(Envelope(SETTINGS, BOUNDS).angle_cap(speed)) == pytest.approx(degrees, abs=0.05)


@pytest.mark.parametrize(
    ("speed", "degrees"), [(0.0, 25.0), (1.0, 25.0), (2.5, 25.0), (3.0, 17.8), (4.2, 9.1), (-4.2, 9.1)]
)
def test_the_rate_is_capped_by_lateral_jerk(speed, degrees):
    assert math.degrees(Envelope(SETTINGS, BOUNDS).rate_cap(speed)) == pytest.approx(degrees, abs=0.05)


def test_what_is_allowed_passes_bit_for_bit():
    limited = begun().limit(command(10.1, 0.0712345, -0.0543216, 1.2345), (0.01, -0.02), 1.0)
    assert limited.angles == (0.0712345, -0.0543216)
    assert limited.speed == 1.2345
    assert not limited.clipped


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_set_point_stays_within_its_caps(sign):
    near = (sign * 29.0 * DEGREE, sign * 19.0 * DEGREE)
    limited = begun(near).limit(command(10.0, sign * 31.0 * DEGREE, sign * 21.0 * DEGREE), near, 1.0)
    assert limited.angles == pytest.approx((sign * 30.0 * DEGREE, sign * 20.0 * DEGREE))
    assert limited.clipped


@pytest.mark.parametrize("axis", [0, 1])
@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize("eased", [False, True])
def test_a_set_point_may_lead_its_rate_and_lasting_motion_may_not_exceed_it(axis, sign, eased):
    far = SafetySettings(envelope=EnvelopeSettings(steering_reach=3.0))
    envelope = begun(given=far, bounds=Bounds(wheelbase=1.4, tractor_limit=1.5, trailer_limit=1.5))
    share, wanted = 0.5 if eased else 1.0, [0.0, 0.0]
    wanted[axis] = sign * 1.4
    for tick in range(12):
        measured = envelope.angles  # a steering that follows at once
        limited = envelope.limit(command(10.0 + 0.1 * tick, *wanted), measured, 1.0, eased=eased)
        reached = share * 25.0 * DEGREE * (LIMITS.steering_lead + 0.1 * tick)
        assert limited.angles[axis] == pytest.approx(sign * min(reached, 1.4), abs=1e-6)
        assert limited.angles[1 - axis] == 0.0
        assert limited.clipped


def test_time_between_commands_is_no_credit():
    envelope = begun(bounds=Bounds(wheelbase=1.4, tractor_limit=1.5, trailer_limit=1.5))
    envelope.limit(command(10.0, 16.0 * DEGREE), (16.0 * DEGREE, 0.0), 1.0)
    limited = envelope.limit(command(15.0, 1.4), (16.0 * DEGREE, 0.0), 1.0)
    assert limited.angles[0] == pytest.approx(min(5.0 + 20.0, 16.0 + 15.0) * DEGREE), "0.2 s of it at most"
    back = envelope.limit(command(14.0, 1.4), (16.0 * DEGREE, 0.0), 1.0)
    assert back.angles[0] == pytest.approx(25.0 * DEGREE), "nor does time run backwards"


@pytest.mark.parametrize("axis", [0, 1])
@pytest.mark.parametrize(("eased", "degrees"), [(False, 15.0), (True, 7.5)])
def test_a_set_point_stays_near_the_measured_angle(axis, eased, degrees):
    start = [0.0, 0.0]
    start[axis] = 10.0 * DEGREE
    measured = [0.0, 0.0]
    measured[axis] = -8.0 * DEGREE
    limited = begun(tuple(start)).limit(command(10.0, *start), tuple(measured), 1.0, eased=eased)
    assert limited.angles[axis] == pytest.approx((degrees - 8.0) * DEGREE)
    assert limited.angles[1 - axis] == 0.0


def test_an_unknown_angle_holds_the_set_point():
    envelope = begun((0.1, -0.1))
    limited = envelope.limit(command(10.1, 0.2, -0.12), (math.nan, -0.1), 1.0)
    assert limited.angles == (0.1, -0.12)
    assert limited.clipped


def test_a_cap_that_shrinks_is_walked_to():
    envelope = begun((25.0 * DEGREE, 0.0))
    first = envelope.limit(command(10.05, 25.0 * DEGREE), (25.0 * DEGREE, 0.0), 4.2)
    rate = envelope.rate_cap(4.2)
    assert first.angles[0] == pytest.approx(25.0 * DEGREE - rate * LIMITS.steering_lead)
    assert first.clipped


@pytest.mark.parametrize(("wanted", "given"), [(9.0, 4.2), (-9.0, -4.2), (4.2, 4.2), (-1.0, -1.0)])
def test_the_speed_is_limited(wanted, given):
    limited = begun().limit(command(10.0, speed=wanted), (0.0, 0.0), 1.0)
    assert limited.speed == given
    assert limited.clipped is (wanted != given)


FLOATS = st.floats(-1e6, 1e6) | st.sampled_from([5e-324, -0.0, 1e300, -1e300, 1.7e308])


@given(
    stream=st.lists(st.tuples(FLOATS, FLOATS, FLOATS, st.floats(0.0, 0.4)), min_size=1, max_size=12),
    speed=st.floats(0.0, 10.0),
    eased=st.booleans(),
)
@settings(derandomize=True, max_examples=150, deadline=None)
def test_whatever_comes_the_set_points_are_within_all_limits(stream, speed, eased):
    envelope, time = begun(), 10.0
    share = 0.5 if eased else 1.0
    measured = (0.0, 0.0)
    for tractor, trailer, wanted_speed, step in stream:
        time += step
        before = envelope.angles
        limited = envelope.limit(command(time, tractor, trailer, wanted_speed), measured, speed, eased=eased)
        caps = (envelope.angle_cap(speed), BOUNDS.trailer_limit)
        for axis in (0, 1):
            rate = share * (envelope.rate_cap(speed), LIMITS.steering_rate)[axis]
            assert abs(limited.angles[axis]) <= caps[axis] + 1e-12
            assert abs(limited.angles[axis] - measured[axis]) <= share * LIMITS.steering_reach + 1e-12
            reach = rate * (2.0 * LIMITS.steering_lead + min(step, 0.2) + 1e-6)
            assert abs(limited.angles[axis] - before[axis]) <= reach
        assert abs(limited.speed) <= LIMITS.speed
        assert limited.clipped == (limited.angles != (tractor, trailer) or limited.speed != wanted_speed)


@given(tractor=st.floats(-2.0, 2.0), at=st.floats(-0.5, 0.5), speed=st.floats(0.0, 5.0), tighter=st.floats(0.1, 1.0))
@settings(derandomize=True, max_examples=150, deadline=None)
def test_a_tighter_limit_never_lets_more_through(tractor, at, speed, tighter):
    tight = SETTINGS.model_copy(
        update={"envelope": LIMITS.model_copy(update={"steering_reach": tighter * LIMITS.steering_reach})}
    )
    loose_angle = begun((at, 0.0)).limit(command(10.0, tractor), (at, 0.0), speed).angles[0]
    tight_angle = begun((at, 0.0), given=tight).limit(command(10.0, tractor), (at, 0.0), speed).angles[0]
    assert abs(tight_angle - at) <= abs(loose_angle - at) + 1e-12


@pytest.mark.parametrize("name", ["articulated", "paper", "lqr-pi"])
def test_nominal_driving_is_not_limited(simulate, name):
    """Closed loop at 1 m/s; the last row in a row of limited commands would stop the vehicle at five."""
    envelope, sign = begun(), -1.0 if name == "paper" else 1.0
    in_a_row = 0
    for record in simulate(name).records:
        measured = (record.measurement.tractor_steering, record.measurement.trailer_steering)
        if record.step == 0:
            envelope.begin(record.measurement.time, measured)
        wanted = (record.command.tractor_steering, sign * record.command.trailer_steering)
        asked = command(record.measurement.time, *wanted, record.command.speed)
        limited = envelope.limit(asked, measured, abs(record.measurement.speed))
        in_a_row = in_a_row + 1 if limited.clipped else 0
        assert in_a_row < LIMITS.clips
