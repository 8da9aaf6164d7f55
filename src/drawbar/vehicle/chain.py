"""Chain: the lengths that estimators and controllers on the chain of both bodies use (chain.h)."""

from drawbar.vehicle.parameters import VehicleParameters


def chain_settings(vehicle: VehicleParameters) -> dict[str, float]:
    """Return the values of CHAIN_FIELDS, m."""
    return {
        "chain.wheelbase": vehicle.wheelbase,
        "chain.hitch": vehicle.free_joint_offset,
        "chain.drawbar": vehicle.drawbar_length,
        "chain.back": vehicle.trailer_length - vehicle.trailer_antenna,
    }
