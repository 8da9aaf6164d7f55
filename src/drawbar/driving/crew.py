"""Crew: starts the processes of a drive, the recorder first, watches them, and ends them, the gate first."""

import os
import signal
import socket
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from types import TracebackType
from typing import IO, Self

from drawbar.config import Configuration
from drawbar.driving.console_orders import ConsoleOrders
from drawbar.driving.ending import undisturbed
from drawbar.driving.orders import (
    CONSOLE,
    GUARD,
    ORDERS_NAME,
    RECEIVERS,
    RECORDER,
    SENTENCES,
    SOCKETS,
    GateOrders,
    Orders,
)
from drawbar.driving.pace import driver_socket, shown_pace
from drawbar.errors import HardwareError
from drawbar.safety.channels import controller_pair

CONFIGURATION_NAME = "config.toml"
MESSAGES_NAME = "messages.txt"
"""in the folder of the run: what the processes have written"""
LOSSES = {
    CONSOLE: "the console has ended, and the drive goes on",
    RECORDER: "the recorder has ended: nothing is recorded any more, what was recorded is kept, and the drive goes on",
    RECEIVERS: "the receivers' process has ended: the vehicle is steered along its line until it stands; brake",
}
"""processes without which a drive goes on, the last one only while it steers, and what is then said"""
_ENDING = 5.0
"""within which a process must end that was told to, s"""
_STARTING = 30.0
"""within which a process must have opened its socket, s"""
_LONGEST_PATH = 107
"""bytes of a Unix socket's address, which Linux allows"""


class Crew:
    """The processes of one drive, as a context."""

    def __init__(
        self,
        configuration: Configuration,
        run: Path,
        *,
        stand_ins: bool,
        shadow: bool = False,
        pace: int = 1,
        live: int | None = None,
        console: ConsoleOrders | None = None,
    ) -> None:
        """Take what to drive.

        Args:
            configuration: complete, with devices.
            run: folder of the log, which exists.
            stand_ins: start the stand-in of all devices too.
            shadow: the gate only listens to the actuators.
            pace: of the stand-ins; 1 for a machine.
            live: port of this computer on which the recorder shows what it records; None: it does not.
            console: start the operator's console too; its `folder`, `configuration` and `stand_ins` are filled in here.

        Raises:
            HardwareError: the temporary folder's name is too long for sockets.
        """
        assert configuration.devices is not None
        self.configuration, self._run = configuration, run
        self._stand_ins, self._shadow, self._console = stand_ins, shadow, console
        self.processes: dict[str, subprocess.Popen[bytes]] = {}
        self._folder = folder_of_sockets()
        self._messages: IO[bytes] = (run / MESSAGES_NAME).open("wb")
        self.orders = Orders(
            folder=self._folder.name,
            run=str(run),
            configuration=str(run / CONFIGURATION_NAME),
            stand_ins=stand_ins,
            pace=pace,
            live=live,
        )

    def __enter__(self) -> Self:
        """Start all; each is there when this returns.

        Raises:
            HardwareError: a process has ended at once; says where its words are.
        """
        try:
            self._start_all()
        except BaseException:
            self.close()
            raise
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def ended(self) -> list[str]:
        """Return the names of processes that are not there any more."""
        return [name for name, process in self.processes.items() if process.poll() is not None]

    def how_ended(self, name: str) -> str:
        """Return how a process that is not there any more has ended."""
        code = self.processes[name].returncode
        return f"killed by {signal.Signals(-code).name}" if code < 0 else f"exit code {code}"

    def _start_all(self) -> None:
        orders = self.orders.model_dump_json()
        self._start(RECORDER, "driving.recorder_main", orders)  # the first, so that nothing happens unrecorded
        if self._stand_ins:
            self._start("stand_in", "driving.stand_in_main", orders)
            self._await("stand_in", "driver")
        self._await(RECORDER, RECORDER)
        ours, theirs = controller_pair()
        with ours, theirs:
            orders_of_gate = gate_orders(
                self.configuration, self._folder.name, theirs.fileno(), self.orders.pace, shadow=self._shadow
            )
            self._start("guard", "driving.guard_main", orders_of_gate.model_dump_json())
            self._await("guard", GUARD)
            self._start("gate", "driving.gate_main", orders_of_gate.model_dump_json(), ends=(theirs,))
            self._start("controller", "driving.controller_main", orders, str(ours.fileno()), ends=(ours,))
        self._start("receivers", "driving.receivers_main", orders)
        for name in ("gate", "controller", "receivers"):
            self._await(name, name)
        (Path(self._folder.name) / ORDERS_NAME).write_text(orders, "utf-8")
        if self._console is not None:
            filled = self.orders.model_dump(include={"folder", "configuration", "stand_ins"})
            self._start(CONSOLE, "console.console_main", self._console.model_copy(update=filled).model_dump_json())
            self._await(CONSOLE, CONSOLE)

    def _start(
        self, name: str, module: str, orders: str, *arguments: str, ends: tuple[socket.socket, ...] = ()
    ) -> None:
        process = subprocess.Popen(
            [sys.executable, "-m", f"drawbar.{module}", *arguments],
            stdin=subprocess.PIPE,
            stdout=self._messages,
            stderr=self._messages,
            pass_fds=[end.fileno() for end in ends],
            start_new_session=True,  # Ctrl-C is for the front end, which then ends them in order
            env={**os.environ, "OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"},
        )
        assert process.stdin is not None
        process.stdin.write(orders.encode())
        process.stdin.close()
        self.processes[name] = process

    def _await(self, name: str, path: str) -> None:
        """Wait until a process has opened its socket."""
        end = time.monotonic() + _STARTING
        while not os.path.exists(self.orders.socket(path)):
            if self.processes[name].poll() is not None or time.monotonic() > end:
                raise HardwareError(f"the {name} process did not start: {self.words()}")
            time.sleep(0.01)

    def said(self) -> list[str]:
        """Return the lines that the processes have written; none where the run's folder is gone."""
        try:
            return (self._run / MESSAGES_NAME).read_text("utf-8", "replace").strip().splitlines()
        except OSError:
            return []

    def words(self) -> str:
        """Return the last lines that the processes have written."""
        return " / ".join(self.said()[-4:]) or "it said nothing"

    def close(self) -> None:
        """End the gate first, so that the actuators let go; then all others, the recorder last."""
        if self._messages.closed:
            return
        with undisturbed():
            self._end_all()
            self._messages.close()
            self._folder.cleanup()

    def _end_all(self) -> None:
        for name in ("gate", "guard", "controller", "receivers", "stand_in", RECORDER, CONSOLE):
            process = self.processes.get(name)
            if process is not None and process.poll() is None:
                process.send_signal(signal.SIGTERM)
                try:
                    process.wait(_ENDING)
                except subprocess.TimeoutExpired:
                    process.kill()
                    process.wait()


def folder_of_sockets() -> "tempfile.TemporaryDirectory[str]":
    """Return a new folder, the user's own, with room for the names of sockets."""
    folder = tempfile.TemporaryDirectory(prefix="drawbar-")
    longest = _LONGEST_PATH - len(os.sep) - len(max(SOCKETS, key=len))
    if len(os.fsencode(folder.name)) > longest:
        folder.cleanup()
        raise HardwareError(
            f"the temporary folder {tempfile.gettempdir()} has too long a name for sockets, which may have "
            f"{_LONGEST_PATH} bytes; set TMPDIR to a shorter one, as TMPDIR=/tmp"
        )
    return folder


def gate_orders(
    configuration: Configuration, folder: str, controller: int, pace: int = 1, *, shadow: bool = False
) -> GateOrders:
    """Return what the gate of a configuration is told; folder of its socket, descriptor of its end of the pair."""
    vehicle, devices = configuration.vehicle, configuration.devices
    assert devices is not None
    shown = shown_pace(devices)
    return GateOrders(
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
