"""Terminal: what the operator is shown of a drive, line by line, and below these a picture of how it is now.

Where the console is no terminal, as in a service's journal, what the picture shows against engaging and of sensors are
lines as well.
"""

from contextlib import suppress
from types import TracebackType
from typing import Self

from rich.console import Console
from rich.live import Live

from drawbar.driving.messaging.process_options import CONSOLE, RECEIVERS, RECORDER
from drawbar.driving.operator.display import headline, notices, picture, reason, refusals, stands
from drawbar.driving.operator.front_end import FrontEnd
from drawbar.driving.processes.drive_processes import LOSSES, DriveProcesses
from drawbar.messages import GateState, SupervisorState
from drawbar.safety.causes import Cause, Response

TAKE_OVER = "the drive is over: take the wheel, and STOP THE VEHICLE"


class Terminal:
    """Shows a drive while it is a context; the picture only where the console is a terminal."""

    def __init__(self, console: Console, processes: DriveProcesses, front: FrontEnd) -> None:
        """Take where to show it, the processes and what they send."""
        self._console, self._processes, self._front = console, processes, front
        self._live = Live(console=console, auto_refresh=False, transient=True) if console.is_terminal else None
        self._announced: SupervisorState | None = None
        self._reasons = set[Cause]()
        """that were printed since the newest state"""
        self._lost: list[str] = []
        self._said = len(processes.output())
        """lines of the processes that were shown, or written before"""

    def show(self) -> None:
        """Show how the drive is; a state that is new gets a line."""
        front = self._front
        if front.state is not None:
            with suppress(OSError):  # a full disk does not end a drive
                self._tell(front.state)
        with suppress(OSError):
            self._tell_said()
        if self._live is not None:
            self._live.update(picture(front.state, front.controller, front.refusal), refresh=True)

    def _tell_said(self) -> None:
        """Print the lines of the processes, such as a caster's refusal; a failed one's are shown with its end."""
        lines = self._processes.output()
        for line in lines[self._said :]:
            if line.partition(": ")[0] in self._processes.by_name:
                self._console.print(line, style="yellow", soft_wrap=True, markup=False, highlight=False)
        self._said = len(lines)

    def _tell(self, state: GateState) -> None:
        """Print a state that is new; without a picture also, once, each reason against engaging, or warning."""
        if state.state is not self._announced:
            self._announced, self._reasons = state.state, set()
            self._console.print(headline(state, self._front.controller))
        for cause in self._causes_as_lines(state):
            if cause not in self._reasons:
                self._reasons.add(cause)
                self._console.print(reason(cause), soft_wrap=True)

    def _causes_as_lines(self, state: GateState) -> list[Cause]:
        """Return the causes to print without a picture.

        What stands against engaging, or warnings while it steers; and faults of sensors.
        """
        if self._live is not None:
            return []
        causes, sensors = refusals(state, self._front.controller), notices(self._front.controller, state)
        if state.state is not SupervisorState.STANDBY:
            causes = [cause for cause in causes if state.steers and cause.response is not Response.NONE]
        return causes + sensors

    def tell_losses(self) -> bool:
        """Show which processes have ended; return whether the drive continues without them."""
        lost, before = self._processes.ended(), self._lost
        self._lost = lost
        if not self._spared() >= set(lost):
            ended = ", ".join(f"{name} ({self._processes.how_ended(name)})" for name in lost)
            self._console.print(
                f"ended: {ended}: {self._processes.last_output(lost)}", style="bold red", soft_wrap=True
            )
            if self._front.drove and not stands(self._front.controller):
                self._console.print(TAKE_OVER, style="bold reverse red")
            return False
        for name in set(lost).difference(before):
            with suppress(OSError):
                self._console.print(
                    f"{LOSSES[name]}: {self._processes.last_output([name])}", style="bold red", soft_wrap=True
                )
        return True

    def _spared(self) -> set[str]:
        """Return the processes without which it continues now: nothing engages without recorder and receivers."""
        state = self._front.state
        steers = state is not None and bool(state.steers)
        return {CONSOLE} | ({RECORDER} if self._front.drove else set()) | ({RECEIVERS} if steers else set())

    def __enter__(self) -> Self:
        if self._live is not None:
            self._live.start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if self._live is not None:
            self._live.stop()
