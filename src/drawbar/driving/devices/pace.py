"""Pace: how fast time passes in a drive. A machine is driven at 1; a stand-in on this computer may be faster.

A stand-in that is a program of its own shows its pace by the name of its driver's socket, which is gone when it ends.
It alone has the ports of its devices; so whoever finds that name, for devices that cannot be but on this computer,
drives a stand-in and no machine.
"""

import hashlib
from collections.abc import Mapping
from pathlib import Path

from drawbar.errors import ConfigurationError, HardwareError
from drawbar.machine.hardware.devices import DeviceSettings
from drawbar.transports.address import is_loopback, stays_here
from drawbar.transports.clock import FASTEST

_SOCKETS = Path("/proc/net/unix")
"""of this computer; names that are no files begin with @"""


def demand_stand_in(devices: DeviceSettings, pace: int) -> None:
    """Raise unless devices may be driven at a pace: a machine at 1, a stand-in at its own.

    Raises:
        ConfigurationError: the pace is not 1, and a device is not on this computer.
        HardwareError: the pace is not that of the devices' stand-in, or they have none.
    """
    refuse_elsewhere(devices, pace)
    found = shown_pace(devices)
    if found is None and pace != 1:
        raise HardwareError(
            f"--pace {pace} is for stand-ins, and none runs at the devices of this configuration; start `drawbar "
            f"stand-in --pace {pace}` of the same configuration on this computer first, or leave out --pace"
        )
    if found not in (None, pace):
        raise HardwareError(f"the stand-in at these devices runs at --pace {found}, not {pace}; give the same to both")


def refuse_elsewhere(devices: DeviceSettings, pace: int) -> None:
    """Raise ConfigurationError where a pace is not 1, and a device may be on another computer or a wire."""
    elsewhere = [name for name, is_here in _places(devices).items() if not is_here]
    if pace != 1 and elsewhere:
        raise ConfigurationError(
            f"--pace {pace} is for stand-ins on this computer, and these devices may be real ones: "
            f"{', '.join(elsewhere)}; leave out --pace, or give them addresses of 127.0.0.1"
        )


def _places(devices: DeviceSettings) -> Mapping[str, bool]:
    """Return of each device, by its name in the configuration, whether it cannot be but on this computer."""
    lines = {name: getattr(devices, name) for name, _ in devices if hasattr(getattr(devices, name), "transport")}
    places = {f"devices.{name}": stays_here(each.transport) for name, each in lines.items()}
    if devices.isobus is not None:
        places["devices.isobus"] = stays_here(devices.isobus.bus)
    if devices.corrections is not None:
        outlets = all(stays_here(each) for each in devices.corrections.forward)
        places["devices.corrections"] = outlets and is_loopback(devices.corrections.host)
    return places


def driver_socket(devices: DeviceSettings, pace: int) -> str:
    """Return the address to which the gate's states are sent for the driver of a stand-in of devices."""
    name = hashlib.sha256(devices.model_dump_json().encode()).hexdigest()[:32]
    return f"\0drawbar-stand-in-{name}-{pace}"


def shown_pace(devices: DeviceSettings) -> int | None:
    """Return the pace that a stand-in of devices shows on this computer; None: there is none."""
    try:
        lines = _SOCKETS.read_text("utf-8", "replace").splitlines()
    except OSError:  # no /proc, as in some containers
        return None
    names = {line.rpartition(" ")[2] for line in lines}
    paces = range(1, FASTEST + 1)
    return next((pace for pace in paces if driver_socket(devices, pace).replace("\0", "@") in names), None)
