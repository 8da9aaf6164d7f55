"""Plan of faults: when each is put into a stand-in machine."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

from drawbar.errors import ConfigurationError
from drawbar.machine.hardware.devices import DeviceSettings
from drawbar.machine.stand_in.faults import FAULTS
from drawbar.machine.stand_in.machine import StandInMachine

LIST = "list"
"""in the place of a fault's name: list them"""


@dataclass(frozen=True, slots=True, kw_only=True)
class PlannedFault:
    """A fault and when it begins."""

    name: str
    after: float | None
    """it has first been steered, s; None: from the start"""


def planned_fault(text: str) -> PlannedFault:
    """Return what `NAME` (from the start) or `NAME@20s` (20 s after it has first been steered) means.

    Raises:
        ConfigurationError: there is no such fault, or that is no time; lists those that there are.
    """
    name, at, time = text.partition("@")
    if name not in FAULTS:
        raise ConfigurationError(f"--fault {text}: there is no fault {name!r}; there are: {', '.join(FAULTS)}")
    try:
        after = float(time.removesuffix("s")) if at else None
    except ValueError:
        after = math.nan
    if after is not None and not 0.0 <= after < math.inf:
        raise ConfigurationError(f"--fault {text}: {time!r} is no time in seconds; give for example {name}@20s")
    return PlannedFault(name=name, after=after)


def _has(devices: DeviceSettings, setting: str) -> bool:
    section, _, key = setting.partition(".")
    found = getattr(devices, section)
    return bool(getattr(found, key) if key and found else found)


class FaultPlan:
    """Puts faults into a machine when they are due."""

    def __init__(self, faults: Sequence[PlannedFault], machine: StandInMachine, devices: DeviceSettings) -> None:
        """Take the faults, the machine and the devices that it has.

        Raises:
            ConfigurationError: the machine does not have the device that one is a fault of.
        """
        for fault in faults:
            needs = FAULTS[fault.name].needs
            if needs and not _has(devices, needs):
                raise ConfigurationError(
                    f"--fault {fault.name} ({FAULTS[fault.name].text}) needs devices.{needs}, which the configuration "
                    "does not have; add it, or choose another fault"
                )
        self._machine, self._coming = machine, list(faults)
        self._steered = math.inf

    def look(self) -> list[str]:
        """Put in what is due now; return what happens, in words."""
        machine = self._machine
        if machine.driver.steered:
            self._steered = min(self._steered, machine.time)
        due = [each for each in self._coming if each.after is None or machine.time >= self._steered + each.after]
        self._coming = [each for each in self._coming if each not in due]
        for each in due:
            FAULTS[each.name].begin(machine)
        return [FAULTS[each.name].text for each in due]
