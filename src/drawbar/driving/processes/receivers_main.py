"""The receivers' process as a program: reads the receivers, and sends their epochs to the controller.

`python -m drawbar.driving.processes.receivers_main`, with its options on standard input.
"""

import sys
from collections.abc import Sequence
from functools import partial
from itertools import chain

from drawbar.config import load_configuration
from drawbar.driving.devices.path_frame import local_frame
from drawbar.driving.devices.receiver_transports import open_receivers, receiver_settings
from drawbar.driving.messaging.datagrams import Device
from drawbar.driving.messaging.endpoint import Endpoint
from drawbar.driving.messaging.heartbeat import HeartbeatSender
from drawbar.driving.messaging.process_options import (
    CONSOLE,
    CONTROLLER,
    GATE,
    RECEIVERS,
    RECORDER,
    SENTENCES,
    ProcessOptions,
)
from drawbar.driving.processes.corrections_relay import CorrectionsRelay
from drawbar.driving.processes.input_recorder import InputRecorder
from drawbar.driving.processes.shutdown import ShutdownRequest, run_program
from drawbar.machine.hardware.device_news import LineNews, ReceiverNews
from drawbar.machine.hardware.devices import DeviceSettings
from drawbar.machine.hardware.navigation import Navigation
from drawbar.machine.hardware.receiver import Receiver
from drawbar.machine.hardware.sensor_line import SensorLine
from drawbar.messages import Fixes, Role
from drawbar.messages.records import encode
from drawbar.nanoseconds import seconds
from drawbar.realtime import prepare, say, step_back_when_busy
from drawbar.transports.open import open_transport

_BELOW_THE_GATE = 15
"""its priority of scheduling, and so below the controller"""
_BUSY = 0.5
"""without waiting for more bytes: it is flooded with them, and scheduled as any other process from then on, s"""
_CORRECTIONS = 0.02
"""between two looks at the caster, s"""
_ASK_AGAIN = 0.05
"""between two looks at transports that have no descriptor, s"""


def main() -> int:
    """Read the receivers until told to end."""
    options = ProcessOptions.model_validate_json(sys.stdin.buffer.read())
    configuration = load_configuration(options.configuration)
    devices = configuration.devices
    assert devices is not None
    clock = options.clock
    lines = open_receivers(devices, options.socket(SENTENCES), clock)
    sensor_line = open_transport(devices.sensors.transport, clock) if devices.sensors is not None else None
    endpoint = Endpoint(options.socket(RECEIVERS))  # only now: it shows that the process runs
    inputs = InputRecorder(endpoint, options.socket(RECORDER), clock)
    receivers = [
        Receiver(inputs.tap(line, device), settings)
        for line, (device, settings) in zip(lines, receiver_settings(devices).items(), strict=True)
    ]
    sensors = None
    if devices.sensors is not None and sensor_line is not None:
        sensors = SensorLine(inputs.tap(sensor_line, Device.SENSORS), devices.sensors)
    navigation = Navigation(receivers, local_frame(configuration), sensors)
    heartbeat, shutdown = HeartbeatSender(Role.RECEIVERS, endpoint, options.socket(GATE)), ShutdownRequest()
    show = partial(endpoint.send, options.socket(CONSOLE))
    corrections = CorrectionsRelay(devices.corrections, receivers, clock, show) if devices.corrections else None
    of_devices = _news(devices, receivers, sensors, configuration.sample_time)
    for word in prepare(max(configuration.safety.timing.priority - _BELOW_THE_GATE, 0)):
        say(f"receivers: {word}")
    step_back_when_busy(_BUSY, "receivers: bytes come faster than they can be read")
    while not shutdown.asked:
        now = clock.nanoseconds()
        was_due = navigation.due <= seconds(now)
        found = navigation.poll(seconds(now))
        inputs.note_look(now, was_due=was_due, found=bool(found))
        _send(found, endpoint, options)
        for word in chain.from_iterable(device.update() for device in of_devices):
            say(f"receivers: {word}")
        heartbeat.pass_time(now)
        if corrections is not None:
            corrections.update()
        watched = [*(each.transport for each in receivers), *([sensors.transport] if sensors else [])]
        descriptors = [each for each in (line.fileno() for line in watched) if each >= 0]
        longest = _CORRECTIONS if corrections is not None else _ASK_AGAIN
        clock.wait(descriptors, min(min(navigation.due, seconds(heartbeat.due)) - clock(), longest))
    for each in (*receivers, corrections, sensors, endpoint):
        if each is not None:
            each.close()
    return 0


def _send(found: Sequence[Fixes], endpoint: Endpoint, options: ProcessOptions) -> None:
    """Send epochs to the controller, the console and the recorder."""
    for fixes in found:
        record = encode(fixes)
        for reader in (CONTROLLER, CONSOLE):
            endpoint.send(options.socket(reader), record)
        endpoint.send_queued(options.socket(RECORDER), record)


def _news(
    devices: DeviceSettings, receivers: Sequence[Receiver], sensors: SensorLine | None, sample_time: float
) -> list[LineNews | ReceiverNews]:
    """Return what reports to the operator how the devices are."""
    news: list[LineNews | ReceiverNews] = [] if sensors is None else [LineNews("sensor board", sensors.transport)]
    for device, receiver in zip(receiver_settings(devices), receivers, strict=True):
        name = device.topic.replace("_", " ")
        news += [LineNews(name, receiver.transport), ReceiverNews(name, receiver, sample_time)]
    return news


if __name__ == "__main__":
    sys.exit(run_program(main))
