"""An estimator that somebody tells when a slope begins."""

from drawbar.experiment.alteration import InterceptedMachine
from drawbar.signals import Measurement
from drawbar.simulation import Simulation

BEGINS, ENDS = 25.0, 26.5
"""between which the slope may drift at will, s"""
DRIFT = 0.05
"""rad per sample, meanwhile"""


def told_when_the_slope_begins(simulation: Simulation) -> None:
    """Let the estimator expect any slope for 1.5 s from the moment at which one begins."""
    estimator = simulation.autopilot.library.components["estimator"]
    shipped, common = estimator.settings.array("common"), estimator.live.array("common")

    def tell(measurement: Measurement) -> Measurement:
        told = BEGINS <= measurement.time < ENDS
        common[:] = shipped * (DRIFT / shipped.max() if told else 1.0)
        return measurement

    simulation.machine = InterceptedMachine(simulation.machine, tell)
