"""While both fixes are coarse nothing shows the bias of the yaw rate: it must not turn the estimate."""

from dataclasses import replace

import numpy as np

from drawbar.config import load_configuration
from drawbar.experiment.alteration import InterceptedMachine
from drawbar.report.path_errors import true_path_errors
from drawbar.signals import Measurement
from drawbar.simulation import Simulation

BIAS = 0.006
"""rad/s, within what is known of it after 25 s"""


def test_a_bias_that_appears_with_coarse_fixes_keeps_the_vehicle_near_the_line() -> None:
    def off(m: Measurement) -> Measurement:
        return replace(m, tractor_yaw_rate=m.tractor_yaw_rate + BIAS) if 25.0 <= m.time < 45.0 else m

    settings = (
        "machine.attitude={tractor={present=true},trailer={present=true}}",
        "machine.events=[{kind='gps_float',start=25.0,duration=20.0}]",
        "machine.sensors.position=0.02",
        "speed=2.0",
    )
    with Simulation(load_configuration("articulated", settings), seed=1) as simulation:
        simulation.machine = InterceptedMachine(simulation.machine, off)
        errors = true_path_errors(simulation.log())
    furthest = [100.0 * float(np.nanmax(np.abs(each.error))) for each in (errors.tractor, errors.trailer)]
    assert max(furthest) < 21.0  # 26 where the yaw rate keeps its weight
