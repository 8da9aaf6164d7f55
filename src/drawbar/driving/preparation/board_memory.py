"""Memory of steer boards: the configured settings are written there, on the operator's command, at standstill.

A board neither confirms nor reports what it stores; all that shows is that it answers again. Each write wears its
memory out.
"""

import math
from collections.abc import Iterator

from drawbar.driving.preparation.check import listen_to_board
from drawbar.driving.preparation.finding import Finding, poll_times
from drawbar.machine.hardware.devices import DeviceSettings
from drawbar.machine.hardware.sensor_line import SensorBoardSettings, SensorLine
from drawbar.machine.hardware.steer_board import SteerBoardSettings
from drawbar.transports.open import open_transport

_LISTENING = 2.5
"""to a board before it is written to, which must be fit to steer, and after: an AiO_26 may take 2 s to restart; s"""
_STANDING = 0.05
"""speed below which the vehicle stands, m/s"""


def store_board_memories(devices: DeviceSettings) -> Iterator[Finding]:
    """Yield what became of each board; one that does not reply, steers, or obeys another computer is not written to."""
    wheels = _wheels(devices.sensors) if devices.sensors is not None else None
    if wheels is not None and wheels.problems:
        yield wheels
        return
    for name, board in (("tractor board", devices.tractor_board), ("trailer board", devices.trailer_board)):
        if board is not None:
            yield _store(name, board)


def _store(name: str, board: SteerBoardSettings) -> Finding:
    found = listen_to_board(name, board, _LISTENING)
    if found.problems:
        found.problems.append("nothing was written to it")
        return found
    transport = open_transport(board.transport)
    taken = [transport.write(frame) for frame in board.memory.frames()]
    transport.close()
    found = listen_to_board(name, board, _LISTENING)
    if all(taken):
        found.facts.append("memory written")
    else:
        found.problems.append(f"its memory was not written: {transport.trouble}")
    return found


def _wheels(sensors: SensorBoardSettings) -> Finding | None:
    """Return the finding of the wheels' encoder; None: there is no encoder, and the operator confirms standstill."""
    if sensors.pulses_per_metre is None:
        return None
    line = SensorLine(open_transport(sensors.transport), sensors)
    for _ in poll_times(1.0):
        line.poll()
    line.close()
    speed = line.last.wheel_speed
    found = Finding(device="wheels", received=math.isfinite(speed))
    if not found.received:
        found.problems.append("their encoder reports nothing, so that nothing shows that they stand: mend it")
    else:
        found.facts.append(f"{speed:.2f} m/s")
    if abs(speed) > _STANDING:
        found.problems.append("they turn: stand")
    if found.problems:
        found.problems.append("nothing was written to any board")
    return found
