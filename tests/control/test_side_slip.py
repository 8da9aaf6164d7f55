"""How side-slips change along a preview: against the estimator's own equation, in numpy."""

import math

import numpy as np
import pytest
from alone import Alone
from c_signals import Real

from drawbar.codegen import Unit

UNIT = """
#include "geometry.h"
#include "side_slip.h"
#include "unit.h"
struct component { double change; };
#define COMPONENT_FIELDS FIELD(component, change, 0, 1, 0, 0)
int UNIT(look)(struct component *component, double yaw, double first, double turned, double last)
{
    const struct drawbar_estimate estimate = {
        .speed = 2.5, .longitudinal_slip = 0.8, .slide_east = 0.02, .slide_north = -0.03, .creep = 0.4};
    const double samples[2][4] = {{0.0, 0.0, yaw, first}, {5.0, 1.0, turned, last}};
    double changes[2], cosines[2], sines[2];
    side_slip_changes(&estimate, samples, 2, changes, cosines, sines);
    component->change = changes[1];
    return 0;
}
"""


def test_it_follows_the_slope_in_the_frame_of_the_axle_and_the_curve() -> None:
    alone = Alone(Unit(name="look", source=UNIT, configure=lambda workspace: None))
    rng = np.random.default_rng(4)
    downhill = np.array([0.02, -0.03])
    for _ in range(20):
        yaws, curvatures = rng.uniform(-9.0, 9.0, 2), rng.uniform(-0.2, 0.2, 2)
        alone.call("look", *map(Real, (yaws[0], curvatures[0], yaws[1], curvatures[1])))
        left = [np.array([-math.sin(yaw), math.cos(yaw)]) for yaw in yaws]
        slips = [downhill @ side - 0.4 * 2.0**2 * bend / 9.81 for side, bend in zip(left, curvatures, strict=True)]
        assert alone.live.array("change").item() == pytest.approx(slips[1] - slips[0], abs=1e-12)
