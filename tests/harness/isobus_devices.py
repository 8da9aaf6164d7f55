"""Devices of a machine that has nothing but CAN: NMEA 2000 receivers, and an ISOBUS with both valves and the speed."""

from drawbar.machine.hardware.devices import DeviceSettings


def isobus_devices(bus: str = "can:virtual:rehearsal", gnss: str = "can:virtual:rehearsal") -> DeviceSettings:
    """Return them, on the buses at these addresses."""
    tractor = {"wheelbase": 1.4, "address": 38, "rate": 20.0}
    trailer = {"curvature": [(-0.5, -0.4), (0.5, 0.4)], "address": 39, "rate": 20.0}
    return DeviceSettings.model_validate(
        {
            "tractor_receiver": {"transport": gnss, "sender": "32"},
            "trailer_receiver": {"transport": gnss, "sender": "33"},
            "isobus": {"bus": bus, "name": {"identity": 7}, "tractor_valve": tractor, "trailer_valve": trailer},
            "speed": "isobus",
        }
    )
