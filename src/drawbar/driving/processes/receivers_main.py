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
from drawbar.transports.base import Transport
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
    configuration, clock = load_configuration(options.configuration), options.clock
    settings = configuration.devices
    assert settings is not None
    lines = open_receivers(settings, options.socket(SENTENCES), clock)
    sensor_line = open_transport(settings.sensors.transport, clock) if settings.sensors is not None else None
    endpoint = Endpoint(options.socket(RECEIVERS))  # only now: it shows that the process runs
    inputs = InputRecorder(endpoint, options.socket(RECORDER), clock)
    devices = _Devices(settings, lines, sensor_line, inputs, configuration.sample_time)
    navigation = Navigation(devices.receivers, local_frame(configuration), devices.sensors)
    heartbeat, shutdown = HeartbeatSender(Role.RECEIVERS, endpoint, options.socket(GATE)), ShutdownRequest()
    show = partial(endpoint.send, options.socket(CONSOLE))
    corrections = (
        CorrectionsRelay(settings.corrections, devices.receivers, clock, show) if settings.corrections else None
    )
    longest = _CORRECTIONS if corrections is not None else _ASK_AGAIN
    for word in prepare(max(configuration.safety.timing.priority - _BELOW_THE_GATE, 0)):
        say(f"receivers: {word}")
    step_back_when_busy(_BUSY, "receivers: bytes come faster than they can be read")
    while not shutdown.asked:
        now = clock.nanoseconds()
        was_due = navigation.due <= seconds(now)
        found = navigation.poll(seconds(now))
        inputs.note_look(now, was_due=was_due, found=bool(found))
        _send(found, endpoint, options)
        devices.tell_news()
        heartbeat.pass_time(now)
        if corrections is not None:
            corrections.update()
        clock.wait(devices.descriptors, min(min(navigation.due, seconds(heartbeat.due)) - clock(), longest))
    for each in (devices, corrections, endpoint):
        if each is not None:
            each.close()
    return 0


class _Devices:
    """The receivers and, where there is one, the sensor board; what comes from them goes to the recorder too."""

    def __init__(
        self,
        settings: DeviceSettings,
        lines: Sequence[Transport],
        sensor_line: Transport | None,
        inputs: InputRecorder,
        sample_time: float,
    ) -> None:
        """Take their open transports; `sample_time` of the controller in s."""
        self.receivers: list[Receiver] = []
        self.sensors: SensorLine | None = None
        self._news: list[LineNews | ReceiverNews] = []
        if settings.sensors is not None and sensor_line is not None:
            self.sensors = SensorLine(inputs.tap(sensor_line, Device.SENSORS), settings.sensors)
            self._news.append(LineNews("sensor board", self.sensors.transport))
        for line, (device, own) in zip(lines, receiver_settings(settings).items(), strict=True):
            receiver, name = Receiver(inputs.tap(line, device), own), device.topic.replace("_", " ")
            self.receivers.append(receiver)
            self._news += [LineNews(name, receiver.transport), ReceiverNews(name, receiver, sample_time)]

    @property
    def _all(self) -> list[Receiver | SensorLine]:
        return [*self.receivers, *([self.sensors] if self.sensors is not None else [])]

    @property
    def descriptors(self) -> list[int]:
        """Where bytes come, of those that have a descriptor."""
        return [each for each in (device.transport.fileno() for device in self._all) if each >= 0]

    def tell_news(self) -> None:
        """Tell the operator what has changed."""
        for word in chain.from_iterable(each.update() for each in self._news):
            say(f"receivers: {word}")

    def close(self) -> None:
        """Give the transports back."""
        for each in self._all:
            each.close()


def _send(found: Sequence[Fixes], endpoint: Endpoint, options: ProcessOptions) -> None:
    """Send epochs to the controller, the console and the recorder."""
    for fixes in found:
        record = encode(fixes)
        for reader in (CONTROLLER, CONSOLE):
            endpoint.send(options.socket(reader), record)
        endpoint.send_queued(options.socket(RECORDER), record)


if __name__ == "__main__":
    sys.exit(run_program(main))
