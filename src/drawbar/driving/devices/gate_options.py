"""Options of the gate's process, from a configuration."""

from pathlib import Path

from drawbar.config import Configuration
from drawbar.driving.devices.pace import driver_socket, shown_pace
from drawbar.driving.messaging.process_options import SENTENCES, GateOptions


def gate_options(
    configuration: Configuration, folder: str, controller: int, pace: int = 1, *, shadow: bool = False
) -> GateOptions:
    """Return what the gate of a configuration is given; folder of its socket, descriptor of its end of the pair."""
    vehicle, devices = configuration.vehicle, configuration.devices
    assert devices is not None
    shown = shown_pace(devices)
    return GateOptions(
        folder=folder,
        safety=configuration.safety,
        wheelbase=vehicle.wheelbase,
        tractor_limit=vehicle.tractor_steering_limit,
        trailer_limit=vehicle.trailer_steering_limit,
        tractor_board=devices.tractor_board,
        trailer_board=devices.trailer_board,
        isobus=devices.isobus,
        sentences=str(Path(folder) / SENTENCES) if devices.receivers_on_boards else "",
        drives=devices.speed == "isobus",
        driver=driver_socket(devices, shown) if shown is not None else "",
        shadow=shadow,
        pace=pace,
        controller=controller,
    )
