"""How long a command takes from a sample's first byte to the wire: python tests/driving/wire_delay.py [HZ ...].

Drives stand-ins in processes, in real time, at each rate (5, 10 and 20 Hz), for --seconds each, and listens on the
computer's loopback to the datagrams to the front wheels' board; that takes root. Prints delays, late steps, what all
processes but the stand-in need of a core, how their memory and the log grow.
"""

import argparse
import math
import os
import socket
import struct
import sys
import tempfile
import threading
import time
from bisect import bisect_left
from dataclasses import dataclass, field
from operator import attrgetter
from pathlib import Path
from typing import NamedTuple

import numpy as np

from drawbar.config import load_configuration
from drawbar.configurations import CONFIGURATION_NAME
from drawbar.driving.operator.front_end import FrontEnd
from drawbar.driving.processes.drive_processes import DriveProcesses
from drawbar.driving.stand_in.demonstration import with_stand_ins
from drawbar.messages import CommandMessage, ControllerState, Fixes, Mode
from drawbar.protocols.agopengps.steer_board import SET_POINT
from drawbar.recording.drive_records import Happening, Kind, open_drive
from drawbar.recording.log import LOG_NAME
from drawbar.transports.clock import StampConverter
from drawbar.transports.udp import SO_TIMESTAMPNS, STAMP

LINE = ["path.radii=[12.0, 12.0, 12.0, 12.0, 12.0, 12.0]", "path.straight_length=100.0"]
OUTGOING, UDP, EVERYTHING = 4, 17, 3
STEP = 1.6
"""of set points on the wire within which one is that of a command, 0.01°"""
SOON = 0.15
"""a command that has not come so long after its sample was left out, s"""


class SetPoint(NamedTuple):
    """What a board was told."""

    time: int
    """monotonic, ns"""
    port: int
    steers: bool
    angle: int
    """0.01°, right positive"""


@dataclass
class Wire:
    """Listens to set points for ports of this computer."""

    ports: tuple[int, ...]
    seen: list[SetPoint] = field(default_factory=list)

    def __post_init__(self) -> None:
        self._socket = socket.socket(socket.AF_PACKET, socket.SOCK_RAW, socket.htons(EVERYTHING))
        self._socket.bind(("lo", 0))
        self._socket.settimeout(0.2)
        self._socket.setsockopt(socket.SOL_SOCKET, SO_TIMESTAMPNS, 1)
        self._stamps = StampConverter()
        self._ended = False
        self._thread = threading.Thread(target=self._listen)
        self._thread.start()

    def _listen(self) -> None:
        while not self._ended:
            try:
                packet, ancillary, _, place = self._socket.recvmsg(2048, socket.CMSG_SPACE(STAMP.size))
            except TimeoutError:
                continue
            internet = packet[14:]
            datagram = internet[(internet[0] & 15) * 4 :]
            if place[2] == OUTGOING or internet[9] != UDP:
                continue
            (port,), data = struct.unpack(">H", datagram[2:4]), datagram[8:]
            if port in self.ports and data.startswith(SET_POINT):
                self.seen.append(SetPoint(self._time(ancillary), port, data[7] == 1, *struct.unpack("<h", data[8:10])))

    def _time(self, ancillary: list[tuple[int, int, bytes]]) -> int:
        """Return when the kernel had a datagram, ns: this listener has to wait for a busy computer."""
        ((_, _, stamp),) = ancillary
        seconds, nanoseconds = STAMP.unpack(stamp)
        return round(1e9 * self._stamps.monotonic(seconds + 1e-9 * nanoseconds))

    def close(self) -> None:
        self._ended = True
        self._thread.join()
        self._socket.close()


def processor_time(processes: DriveProcesses) -> float:
    """Return what the processes of a drive have used of the processor, s; the stand-in is the machine's."""
    used = 0
    for name, process in processes.by_name.items():
        fields = Path(f"/proc/{process.pid}/stat").read_text("utf-8").rpartition(")")[2].split()
        used += (int(fields[11]) + int(fields[12])) * (name != "stand_in")
    return used / os.sysconf("SC_CLK_TCK")


def memory(processes: DriveProcesses) -> float:
    """Return the resident memory of the processes of a drive, MB."""
    pages = (int(Path(f"/proc/{each.pid}/statm").read_text("utf-8").split()[1]) for each in processes.by_name.values())
    return sum(pages) * os.sysconf("SC_PAGE_SIZE") * 1e-6


def drive(rate: float, seconds: float) -> None:
    """Drive at a rate and print."""
    configuration = with_stand_ins(load_configuration("articulated", [*LINE, f"sample_time={1.0 / rate}"]))
    assert configuration.devices is not None
    assert configuration.devices.tractor_board is not None
    wire, looks = Wire((configuration.devices.tractor_board.destination[1],)), list[tuple[float, float, float]]()
    with tempfile.TemporaryDirectory(prefix="drawbar-wire-") as folder:
        run = Path(folder)
        (run / CONFIGURATION_NAME).write_text(configuration.to_toml(), "utf-8")
        with DriveProcesses(configuration, run, stand_ins=True) as processes:
            front, end = FrontEnd(processes, demonstrates=True), time.monotonic() + seconds
            begun = (run / LOG_NAME).stat().st_size  # what is written once
            while time.monotonic() < end and not front.is_over and not processes.ended():
                front.wait(1.0)
                looks.append((time.monotonic(), processor_time(processes), memory(processes)))
            state = front.state
            front.close()
        wire.close()
        print(f"{rate:g} Hz, {state.state.name if state else 'silent'}: {_described(run / LOG_NAME, wire.seen)}")
        log = 3600e-6 * ((run / LOG_NAME).stat().st_size - begun) / seconds
    change = 3600.0 * (np.array(looks[-1]) - looks[len(looks) // 2]) / (looks[-1][0] - looks[len(looks) // 2][0])
    print(f"    {change[1] / 36.0:.1f} % of a core, memory {change[2]:+.1f} MB/h, log {log:.0f} MB/h")


def _described(log: Path, seen: list[SetPoint]) -> str:
    """Say how long commands took, from what the log holds and what was seen on the wire."""
    epochs, commands, misses = list[tuple[int, int]](), list[tuple[int, float]](), [0]
    starting = late = 0  # steps that were late before it steered, as it began, and in all
    with open_drive(log) as records:
        for record in records:
            if isinstance(record, Fixes):
                epochs.append((record.time, record.first_byte))
            elif isinstance(record, Happening) and record.kind is Kind.MISS:
                misses.append(record.time)
            elif isinstance(record, ControllerState):
                late = record.overruns
                starting = starting if commands else late
            elif isinstance(record, CommandMessage) and record.mode is Mode.DRIVE:
                angle = -100.0 * math.degrees(record.tractor_angle)
                if not commands or angle != commands[-1][1]:  # the controller repeats the last one while it waits
                    commands.append((record.time, angle))
    times = np.array([first for _, first in epochs])
    waits, same, missing, missed, told_at = list[float](), 0, 0, 0, attrgetter("time")
    for left, angle in commands:
        first = times[times.searchsorted(left) - 1]
        if misses[bisect_left(misses, left) - 1] > first:
            missed += 1
            continue
        before = seen[: bisect_left(seen, left, key=told_at)][-1:]
        if any(abs(each.angle - angle) <= STEP for each in before):  # the board turns there already
            same += 1
            continue
        soon = seen[bisect_left(seen, left - 1e6, key=told_at) : bisect_left(seen, left + 1e9 * SOON, key=told_at)]
        frames = (each.time for each in soon if each.steers and abs(each.angle - angle) <= STEP)
        found = next(frames, None)
        missing += found is None
        waits += [1e-6 * (found - first)] if found is not None else []
    if not waits:
        return "nothing was steered"
    median, most, largest = np.percentile(waits, [50, 99, 100])
    words = (
        f"median {median:.1f} ms, p99 {most:.1f}, largest {largest:.1f} of {len(waits)}; "
        f"{same} as the one before, {missing} limited or left out, {missed} without their epoch"
    )
    return f"{words}; {late - starting} late steps; load {os.getloadavg()[0]:.1f}"


def main() -> int:
    """Drive at each rate."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("rates", metavar="HZ", nargs="*", type=float, default=[5.0, 10.0, 20.0])
    parser.add_argument("--seconds", type=float, default=100.0)
    given = parser.parse_args()
    for rate in given.rates:
        drive(rate, given.seconds)
    return 0


if __name__ == "__main__":
    sys.exit(main())
