"""Run monitor: whether a run may continue (run_monitor.h)."""

from numpy.typing import ArrayLike

from drawbar.codegen import Unit
from drawbar.safety.sanity import SanitySettings
from drawbar.vehicle.parameters import VehicleParameters

_SETTINGS = ("lost", "leaving", "blind", "blind_deviation")
_HEADING, _STEERING = 0.013, 0.0056
"""standard deviations of heading and steering when the last fix is lost, rad: what they make of the way is what the
estimator's own covariance (tests/safety/test_blind.py)"""


def run_monitor_unit(sanity: SanitySettings, vehicle: VehicleParameters) -> Unit:
    """Return the run monitor, which watches a run from its first step on."""
    settings: dict[str, ArrayLike] = {name: getattr(sanity, name) for name in _SETTINGS}
    settings |= {"heading": _HEADING, "bend": _STEERING / (2.0 * vehicle.wheelbase)}
    return Unit(
        name="run_monitor", source='#include "run_monitor.h"', configure=lambda workspace: workspace.write(settings)
    )
