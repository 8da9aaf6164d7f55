"""Every declared model of the vehicle."""

from drawbar.vehicle.articulated import (
    articulated,
    articulated_tracking,
    articulated_tractor,
    articulated_trailer,
)
from drawbar.vehicle.tricycle import tricycle, tricycle_tractor, tricycle_trailer

MODELS = (
    tricycle,
    tricycle_tractor,
    tricycle_trailer,
    articulated,
    articulated_tracking,
    articulated_tractor,
    articulated_trailer,
)
