"""The gate and the run monitor, each by itself."""

from ctypes import byref
from typing import Any

from alone import Alone
from c_signals import CBodyReference, Real, given, room, taken

from drawbar.safety.gate import gate_unit
from drawbar.safety.run_monitor import run_monitor_unit
from drawbar.safety.sanity import SanitySettings
from drawbar.signals import BodyReference, Command, Estimate, GateVerdict, Measurement, MonitorVerdict
from drawbar.vehicle.parameters import VehicleParameters

Given = tuple[Command, GateVerdict]


class CommandGate(Alone):
    """The last look at a command."""

    def __init__(
        self, vehicle: VehicleParameters, first: Measurement | None, *, speed_limit: float, sample_time: float
    ) -> None:
        """Begin with a vehicle that stands with its wheels as they were measured first; None: do not begin."""
        super().__init__(gate_unit(vehicle, speed_limit=speed_limit, sample_time=sample_time))
        if first is not None:
            self.call("begin", given(first))

    def check(self, wanted: Command) -> Given:
        """Return what leaves in a command's place, and how that came about."""
        return self._giving("check", given(wanted))

    def hold(self, time: float) -> Given:
        """Return what leaves where there is no command."""
        return self._giving("hold", Real(time))

    def stop(self, time: float) -> Given:
        """Return the command that stops the vehicle."""
        return self._giving("stop", Real(time))

    def stand(self, time: float) -> Given:
        """Return the answer to a call that was wrong."""
        return self._giving("stand", Real(time))

    def skip(self) -> Command:
        """Let a sample pass that was left out; return the command that went on to act."""
        return self._giving("skip")[0]

    def _giving(self, name: str, *arguments: Any) -> Given:
        command = room(Command)
        verdict = self.call(name, *arguments, command)
        return taken(Command, command), GateVerdict(verdict)


class RunMonitor(Alone):
    """The decision whether a run may go on."""

    def __init__(self) -> None:
        """Compile the run monitor."""
        super().__init__(run_monitor_unit(SanitySettings(), VehicleParameters()))

    def rejoin(self) -> None:
        """Begin the way onto another path."""
        self.call("rejoin")

    def watch(self, estimate: Estimate, tractor: BodyReference, *, released: bool = False) -> MonitorVerdict:
        """Judge one step by its estimate and the tractor's reference; `released`: somebody else steers."""
        return MonitorVerdict(self.call("watch", given(estimate), byref(CBodyReference.of(tractor)), int(released)))
