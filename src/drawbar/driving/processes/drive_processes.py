"""The processes of a drive: they are started, the recorder first, watched, and ended, the gate first."""

import math
import os
import re
import shutil
import signal
import socket
import subprocess
import sys
import time
from collections.abc import Callable, Collection
from pathlib import Path
from types import TracebackType
from typing import Self

from drawbar.config import Configuration
from drawbar.configurations import CONFIGURATION_NAME
from drawbar.driving.devices.gate_options import gate_options
from drawbar.driving.messaging.console_options import ConsoleOptions
from drawbar.driving.messaging.process_options import (
    CONSOLE,
    GUARD,
    OPTIONS_NAME,
    RECEIVERS,
    RECORDER,
    ProcessOptions,
)
from drawbar.driving.messaging.socket_folder import SocketFolder
from drawbar.driving.processes.process_output import ProcessOutput
from drawbar.driving.processes.shutdown import environment, signals_ignored
from drawbar.errors import HardwareError
from drawbar.safety.channels import controller_pair

MESSAGES_NAME = "messages.txt"
"""in the folder of the run: what the processes have written"""
LOSSES = {
    CONSOLE: "the console has ended, and the drive continues",
    RECORDER: "the recorder has ended: nothing more is recorded, what was recorded is kept, and the drive continues",
    RECEIVERS: "the receivers' process has ended: the vehicle is steered along its line until it stands; brake",
}
"""processes without which a drive continues, the last one only while it steers, and what is then shown"""
_TRACE = re.compile(r'(  File ".*", line \d+ in |Current thread 0x|Thread 0x|Extension modules: |$)')
"""lines in which a process that crashed says where it was"""
_ROOM = 1_000_000
"""with less free space a disk is full, bytes"""
_ENDING, _WRITING = 5.0, 30.0
"""within which a process must end that was told to, and the recorder have written what waits, s"""
_STARTING = 120.0
"""within which a process must have opened its socket, s"""


class DriveProcesses:
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
        console: ConsoleOptions | None = None,
        pair: Callable[[], tuple[socket.socket, socket.socket]] = controller_pair,
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
            pair: returns the controller's and the gate's ends of what is between them.

        Raises:
            HardwareError: the temporary folder's name is too long for sockets.
        """
        assert configuration.devices is not None
        self.configuration, self._run = configuration, run
        self._stand_ins, self._console, self._pair = stand_ins, console, pair
        self.by_name: dict[str, subprocess.Popen[bytes]] = {}
        self.killed: list[str] = []
        """names of processes that did not end when they were told to"""
        self._folder = SocketFolder()
        self._output = ProcessOutput(run / MESSAGES_NAME)
        self.options = ProcessOptions(
            folder=self._folder.name,
            run=str(run),
            configuration=str(run / CONFIGURATION_NAME),
            stand_ins=stand_ins,
            pace=pace,
            live=live,
            shadow=shadow,
        )

    def __enter__(self) -> Self:
        """Start all; each is there when this returns.

        Raises:
            HardwareError: a process has ended at once; with what it has written last.
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
        return [name for name, process in self.by_name.items() if process.poll() is not None]

    def how_ended(self, name: str) -> str:
        """Return how a process that is not there any more has ended."""
        code = self.by_name[name].returncode
        return f"killed by {signal.Signals(-code).name}" if code < 0 else f"exit code {code}"

    def _start_all(self) -> None:
        options = self.options.model_dump_json()
        self._start(RECORDER, "driving.processes.recorder_main", options)  # first: nothing happens unrecorded
        if self._stand_ins:
            self._start("stand_in", "driving.stand_in.stand_in_main", options)
            self._await("stand_in", "driver")
        self._await(RECORDER, RECORDER)
        ours, theirs = self._pair()
        with ours, theirs:
            of_gate = gate_options(
                self.configuration, self._folder.name, theirs.fileno(), self.options.pace, shadow=self.options.shadow
            )
            self._start("guard", "driving.processes.guard_main", of_gate.model_dump_json())
            self._await("guard", GUARD)
            self._start("gate", "driving.processes.gate_main", of_gate.model_dump_json(), ends=(theirs,))
            self._start("controller", "driving.processes.controller_main", options, str(ours.fileno()), ends=(ours,))
        self._start("receivers", "driving.processes.receivers_main", options)
        for name in ("gate", "controller", "receivers"):
            self._await(name, name)
        (Path(self._folder.name) / OPTIONS_NAME).write_text(options, "utf-8")
        if self._console is not None:
            filled = self.options.model_dump(include={"folder", "configuration", "stand_ins"})
            self._start(CONSOLE, "console.console_main", self._console.model_copy(update=filled).model_dump_json())
            self._await(CONSOLE, CONSOLE)

    def _start(
        self, name: str, module: str, options: str, *arguments: str, ends: tuple[socket.socket, ...] = ()
    ) -> None:
        process = subprocess.Popen(
            [sys.executable, "-X", "faulthandler", "-m", f"drawbar.{module}", *arguments],
            stdin=subprocess.PIPE,
            stdout=self._output.descriptor,
            stderr=self._output.descriptor,
            pass_fds=[end.fileno() for end in ends],
            start_new_session=True,  # Ctrl-C is for the front end, which then ends them in order
            env={**environment(), "OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"},
        )
        assert process.stdin is not None
        process.stdin.write(options.encode())
        process.stdin.close()
        self.by_name[name] = process

    def _await(self, name: str, path: str) -> None:
        """Wait until a process has opened its socket."""
        end = time.monotonic() + _STARTING
        while not os.path.exists(self.options.socket(path)):
            if self.by_name[name].poll() is not None or time.monotonic() > end:
                raise HardwareError(f"the {name} process did not start: {self.last_output([name])}")
            time.sleep(0.01)

    def output(self) -> list[str]:
        """Return the lines that the processes have written."""
        return self._output.text.strip().splitlines()

    def last_output(self, ended: Collection[str]) -> str:
        """Return the last lines that processes have written which have ended; where there is no room for any, that.

        A warning begins with its process's name; what an error says does not. Where one crashed is left to the file.
        """
        others = self.by_name.keys() - set(ended)
        said = [line for line in self.output() if not _TRACE.match(line)]
        if lines := [line for line in said if line.partition(": ")[0] not in others]:
            return " / ".join(lines[-4:])
        free = shutil.disk_usage(self._run).free if self._run.exists() else math.inf
        if free < _ROOM:
            return f"the disk of {self._run} is full: make room, or choose another folder by --out"
        return "it said nothing"

    @property
    def messages_lost(self) -> str:
        """Return why the end of what the processes have written is not in the run's folder; empty: it is."""
        return self._output.trouble

    def close(self) -> None:
        """End the gate first, so that the actuators release the steering; then all others, the recorder last."""
        if self._output.closed:
            return
        with signals_ignored():
            self._end_all()
            self._output.close()
            self._folder.cleanup()

    def _end_all(self) -> None:
        for name in ("gate", "guard", "controller", "receivers", "stand_in", RECORDER, CONSOLE):
            process = self.by_name.get(name)
            if process is not None and process.poll() is None:
                process.send_signal(signal.SIGTERM)
                try:
                    process.wait(_WRITING if name == RECORDER else _ENDING)
                except subprocess.TimeoutExpired:
                    self.killed.append(name)
                    process.kill()
                    process.wait()
