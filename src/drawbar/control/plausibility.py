"""Plausibility of a controller's weights: how soon an error is corrected, from the weights alone.

The cost's own regulator (LQR without bounds, near the path) has a fastest time constant that follows from the ratio of
the weight on an error to that on the steering: for a chain of n integrators from the steering to an error of weight q,
against a weight r, it is (r/q)^(1/2n) times the chain's own time scale.
"""

from drawbar.control.settings import ArticulatedControllerSettings, TricycleControllerSettings

_PACE = 1.0
"""m/s: at least this speed is assumed, so that a slow one does not speak against the weights"""
_ARTICULATED, _TRICYCLE = 0.5, 2.0
"""of the horizon: what a correction may take; with weights beyond, runs end metres beside the path"""


def demand_weights_that_steer(
    controller: ArticulatedControllerSettings | TricycleControllerSettings,
    *,
    wheelbase: float,
    speed: float,
    sample_time: float,
) -> None:
    """Raise ValueError where the steering weighs so much that errors are hardly corrected within the horizon.

    Args:
        controller: whose weights are looked at.
        wheelbase: of the tractor, m.
        speed: set speed, m/s.
        sample_time: s.
    """
    horizon, pace = controller.horizon * sample_time, max(speed, _PACE)
    if isinstance(controller, TricycleControllerSettings):
        error = max(controller.position_weight, controller.terminal_weight / controller.horizon)
        time = (controller.steering_weight / max(error, 1e-300)) ** 0.25 * (wheelbase**0.5 / pace)
        allowed, weight = _TRICYCLE * horizon, f"controller.steering_weight = {controller.steering_weight:g}"
    else:
        weights = controller.tractor
        lateral = (weights.steering_rate / weights.lateral) ** (1 / 6) * (wheelbase / pace**2) ** (1 / 3)
        heading = (weights.steering_rate / max(weights.heading, 1e-300)) ** 0.25 * (wheelbase / pace) ** 0.5
        time = min(lateral, heading)
        allowed, weight = _ARTICULATED * horizon, f"controller.tractor.steering_rate = {weights.steering_rate:g}"
    if not time <= allowed:
        raise ValueError(
            f"{weight} is too large against the weights on the errors: a correction would take {time:.3g} s, at most "
            f"{allowed:.3g} s is allowed with controller.horizon = {controller.horizon} and sample_time = "
            f"{sample_time:g} s; lower the weight, raise the others, or raise horizon or sample_time"
        )
