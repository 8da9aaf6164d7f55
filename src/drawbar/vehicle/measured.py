"""Measured outputs: what the sensors measure, shared by models and estimator."""

from drawbar.vehicle.model import variables

MEASURED = variables(
    tractor_x="m",
    tractor_y="m",
    trailer_x="m",
    trailer_y="m",
    hitch_angle="rad",
    speed="m/s",
    tractor_steering="rad",
    trailer_steering="rad",
)
"""The measured quantities, in the order in which both models of the whole vehicle have them as outputs."""
