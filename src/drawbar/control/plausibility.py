"""Plausibility of a controller's settings: whether samples come often enough, and how soon an error is corrected.

A vehicle that drives nearly its wheelbase from one sample to the next turns too far before anything corrects it.

How soon an error is corrected follows from the weights alone.

The cost's own regulator (LQR without bounds, near the path) has a fastest time constant that follows from the ratio of
the weight on an error to that on the steering: for a chain of n integrators from the steering to an error of weight q,
against a weight r, it is (r/q)^(1/2n) times the chain's own time scale.
"""

import math

from drawbar.control.settings import ArticulatedControllerSettings, TricycleControllerSettings

_LARGEST_MOVE = 0.75
"""of the wheelbase: what the vehicle may drive from one sample to the next"""
_PACE = 1.0
"""m/s: at least this speed is assumed, so that a slow one is not evidence against the weights"""
_ARTICULATED, _TRICYCLE = 0.5, 2.0
"""of the horizon: what a correction may take; with weights beyond, runs end metres beside the path"""


def demand_samples_that_steer(*, wheelbase: float, speed: float, sample_time: float) -> None:
    """Raise ValueError where a vehicle drives too far from one sample to the next to be steered.

    Args:
        wheelbase: of the tractor, m.
        speed: set speed, m/s.
        sample_time: s.
    """
    move = speed * sample_time
    if not move <= _LARGEST_MOVE * wheelbase:
        raise ValueError(
            f"speed = {speed:g} m/s drives the vehicle {move:.3g} m in each sample_time = {sample_time:g} s, which is "
            f"too far for vehicle.wheelbase = {wheelbase:g} m: at most {_LARGEST_MOVE * wheelbase:.3g} m is allowed; "
            f"lower speed or sample_time, or correct the wheelbase"
        )


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
        enough = math.ceil(controller.horizon * time / allowed)
        raise ValueError(
            f"{weight} is too large against the weights on the errors: a correction would take {time:.3g} s, at most "
            f"{allowed:.3g} s is allowed with controller.horizon = {controller.horizon} and sample_time = "
            f"{sample_time:g} s; raise horizon (to {enough}) or sample_time, lower the weight, or raise the others"
        )
