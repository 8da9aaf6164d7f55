"""Weights of the tractor's cost that follow its speed, as stated (`speed_weights.h`)."""

from drawbar.control.settings import ArticulatedTractorWeights


def speed_weight_settings(weights: ArticulatedTractorWeights) -> dict[str, float]:
    """Return what a tractor's controller knows of them, by the names of its settings."""
    return {
        "weights.rate": weights.steering_rate,
        "weights.lateral": weights.lateral,
        "weights.heading": weights.heading,
    }
