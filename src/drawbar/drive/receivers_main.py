"""The receivers' process as a program: reads the receivers, and sends what they say of each instant to the controller.

`python -m drawbar.drive.receivers_main`, with its orders on standard input.
"""

import select
import sys
import time

from drawbar.config import load_configuration
from drawbar.drive.beat import Beat
from drawbar.drive.ending import Ending
from drawbar.drive.letters import Device, Raw, pack
from drawbar.drive.mail import Mailbox
from drawbar.drive.orders import CONTROLLER, GATE, RECORDER, Orders
from drawbar.drive.place import local_frame
from drawbar.machine.hardware.devices import DeviceSettings
from drawbar.machine.hardware.navigation import Navigation
from drawbar.machine.hardware.receiver import Receiver, ReceiverSettings
from drawbar.messages import Role, encode
from drawbar.realtime import prepare
from drawbar.transports.base import Received
from drawbar.transports.open import open_transport
from drawbar.transports.tapped import Direction, TappedTransport

_ASK_AGAIN = 0.05
"""between two looks at transports that have no descriptor, s"""


def main() -> int:
    """Read the receivers until told to end."""
    orders = Orders.model_validate_json(sys.stdin.read())
    configuration = load_configuration(orders.configuration)
    devices = configuration.devices
    assert devices is not None
    mailbox = Mailbox(orders.socket("receivers"))
    tractor, trailer = (_receiver(settings, device, mailbox, orders) for settings, device in _receivers(devices))
    navigation = Navigation(tractor, trailer, local_frame(configuration))
    beat, ending = Beat(Role.RECEIVERS, mailbox, orders.socket(GATE)), Ending()
    for word in prepare(0):
        print(f"receivers: {word}", file=sys.stderr)
    while not ending.asked:
        now = time.monotonic_ns()
        for fixes in navigation.poll(now * 1e-9):
            record = encode(fixes)
            mailbox.send(orders.socket(CONTROLLER), record)
            mailbox.send(orders.socket(RECORDER), record)
        beat.pass_time(now)
        descriptors = [each for each in (tractor.transport.fileno(), trailer.transport.fileno()) if each >= 0]
        wait = min(navigation.due - time.monotonic(), beat.due * 1e-9 - time.monotonic(), _ASK_AGAIN)
        select.select(descriptors, [], [], max(wait, 0.0))
    tractor.close()
    trailer.close()
    mailbox.close()
    return 0


def _receivers(devices: DeviceSettings) -> tuple[tuple[ReceiverSettings, Device], tuple[ReceiverSettings, Device]]:
    return (devices.tractor_receiver, Device.TRACTOR_RECEIVER), (devices.trailer_receiver, Device.TRAILER_RECEIVER)


def _receiver(settings: ReceiverSettings, device: Device, mailbox: Mailbox, orders: Orders) -> Receiver:
    """Open a receiver, every byte of which goes to the recorder too."""

    def tap(direction: Direction, received: Received) -> None:
        raw = Raw(time=round(received.time * 1e9), device=device, direction=direction, data=received.data)
        mailbox.send(orders.socket(RECORDER), pack(raw))

    return Receiver(TappedTransport(open_transport(settings.transport), tap), settings)


if __name__ == "__main__":
    sys.exit(main())
