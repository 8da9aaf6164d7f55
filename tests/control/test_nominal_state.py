"""Moving a state along the path, and the coordinates in which it is compared with the estimate."""

import math

import numpy as np
import pytest


def pose(arc_length, curvature, offset=0.0, heading=0.0):
    """Return x, y, yaw beside a circle that begins at (3, -2) with a yaw of 0.7."""
    turned = curvature * arc_length
    chord = arc_length * np.sinc(0.5 * turned / math.pi)
    x, y = 3.0 + chord * math.cos(0.7 + 0.5 * turned), -2.0 + chord * math.sin(0.7 + 0.5 * turned)
    yaw = 0.7 + turned
    return np.array([x - offset * math.sin(yaw), y + offset * math.cos(yaw), yaw + heading])


@pytest.mark.parametrize("curvature", [0.0, 1e-9, 0.15, -0.3])
def test_what_moves_along_the_path_keeps_its_offset_and_heading_to_it(curvature, nominal_states):
    rng = np.random.default_rng(3)
    for _ in range(20):
        here, there, offset, heading = rng.uniform(-1.0, 1.0, 4)
        state, closest = np.append(pose(there, curvature, offset, heading), 0.123), pose(here, curvature)
        moved = nominal_states.beside(state, np.append(closest, curvature))
        assert moved[:3] == pytest.approx(pose(here, curvature, offset, heading), abs=1e-12)
        assert moved[3] == 0.123


def test_what_is_beside_already_stays(nominal_states):
    random = np.random.default_rng(4)
    for _ in range(20):
        x, y, yaw, curvature, offset, heading = random.uniform(-0.5, 0.5, 6)
        state = np.array([x - offset * math.sin(yaw), y + offset * math.cos(yaw), yaw + heading])
        assert nominal_states.beside(state, np.array([x, y, yaw, curvature])) == pytest.approx(state, abs=1e-15)


def test_the_deviation_is_that_in_the_nominal_headings_frame(nominal_states):
    rng = np.random.default_rng(31)
    for _ in range(100):
        x, y, yaw, along, across, turn, rest = rng.normal(size=7).tolist()
        nominal = np.array([x, y, yaw, 0.2])
        estimated = np.array(
            [
                x + along * math.cos(yaw) - across * math.sin(yaw),
                y + along * math.sin(yaw) + across * math.cos(yaw),
                yaw + turn,
                0.2 + rest,
            ]
        )
        assert nominal_states.pose_deviation(estimated, nominal) == pytest.approx([across, turn, rest], abs=1e-12)


def test_a_whole_turn_between_estimate_and_nominal_state_is_none(nominal_states):
    nominal, estimated = np.array([0.0, 0.0, 3.1]), np.array([0.0, 0.0, 3.2 - 2.0 * math.pi])
    assert nominal_states.pose_deviation(estimated, nominal) == pytest.approx([0.0, 0.1])
    assert nominal_states.plain_deviation(np.array([0.1 - 2.0 * math.pi, 0.3]), np.array([0.0, 0.1])) == pytest.approx(
        [0.1, 0.2]
    )
