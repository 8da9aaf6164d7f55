"""A drive on stand-ins of all devices: what cannot be, and what is kept of its configuration."""

import pytest

from drawbar.config import load_configuration
from drawbar.driving.stand_in.demonstration import with_stand_ins, without_stand_ins
from drawbar.errors import ConfigurationError


@pytest.mark.parametrize("body", ["tractor", "trailer"])
def test_a_vehicle_that_no_stand_in_board_can_steer_is_refused(body):
    changes = [f"vehicle.{body}_steering_limit=0.9", f"machine.actuators.{body}_stop=1.0"]
    with pytest.raises(ConfigurationError, match=rf"vehicle\.{body}_steering_limit = 0\.9 rad: .* below 0\.8726 rad"):
        with_stand_ins(load_configuration("articulated", changes))


def test_what_is_kept_of_a_demonstration_names_no_stand_in_and_asks_for_the_wiggle_test():
    configuration = load_configuration("articulated")
    driven = with_stand_ins(configuration)
    assert driven.devices is not None
    assert without_stand_ins(driven) == configuration
    assert without_stand_ins(driven).safety.engage.wiggle_test
