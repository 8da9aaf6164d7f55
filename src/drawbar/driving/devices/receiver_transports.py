"""Receiver transports: those at one UDP port share it, those on boards get their sentences from the gate."""

import time
from collections.abc import Sequence

from drawbar.driving.messaging.datagrams import Device
from drawbar.machine.hardware.devices import DeviceSettings
from drawbar.machine.hardware.receiver import ReceiverSettings
from drawbar.machine.hardware.sentences import RelayedSentences
from drawbar.machine.hardware.shared_socket import share
from drawbar.transports.base import Transport
from drawbar.transports.clock import Clock
from drawbar.transports.open import open_transport
from drawbar.transports.udp import UdpTransport

_NOBODY = ("0.0.0.0", 0)
"""whom a socket that only listens sends to"""


def receiver_settings(devices: DeviceSettings) -> dict[Device, ReceiverSettings]:
    """Return the settings of the receivers by the names that logs give them, the tractor's first."""
    return dict(zip((Device.TRACTOR_RECEIVER, Device.TRAILER_RECEIVER), devices.receivers, strict=False))


def open_receivers(devices: DeviceSettings, sentences: str, clock: Clock = time.monotonic) -> Sequence[Transport]:
    """Return the transports of the tractor's receiver and, where there is one, of the trailer's.

    Args:
        devices: of the configuration.
        sentences: path of the socket by which the gate hands on what comes to the boards' port.
        clock: of what comes, s.

    Raises:
        HardwareError: a port is taken.
    """
    receivers, on_boards = devices.receivers, devices.receivers_on_boards
    if on_boards:
        relayed = share(RelayedSentences(sentences), [_NOBODY] * len(on_boards))
        return [relayed.pop() if each in on_boards else open_transport(each.transport, clock) for each in receivers]
    first = open_transport(receivers[0].transport, clock)
    others = [receiver.transport for receiver in receivers[1:]]
    if receivers[0].transport in others and isinstance(first, UdpTransport):
        return share(first, [first.address.peer or _NOBODY] * 2)
    return [first, *(open_transport(each, clock) for each in others)]
