"""Opening: from an address of the configuration to the open transport or CAN bus."""

import time

from drawbar.transports.address import FileAddress, SerialAddress, TcpAddress, parse_can, parse_transport
from drawbar.transports.base import CanBus, Transport
from drawbar.transports.can import PythonCanBus
from drawbar.transports.can_listener import CanListener
from drawbar.transports.clock import Clock
from drawbar.transports.file import FileTransport
from drawbar.transports.serial import SerialTransport
from drawbar.transports.tcp import TcpTransport
from drawbar.transports.udp import UdpTransport


def open_transport(text: str, clock: Clock = time.monotonic) -> Transport:
    """Open `serial:DEVICE@BAUD`, `tcp://HOST:PORT`, `udp://ADDRESS:PORT`, `file:PATH`, or a CAN bus to listen to.

    A device that is not there, or a server that does not answer, is no error: `connected` is False, `trouble` holds
    why, and `read` tries again.

    Args:
        text: the address; its options are in `address.py`.
        clock: returns monotonic time, s.

    Raises:
        ConfigurationError: the address is none; names what is allowed.
        HardwareError: a UDP port is taken or a file cannot be read; names what to do.
    """
    if text.startswith("can:"):
        return CanListener(open_can(text, clock))
    address = parse_transport(text)
    if isinstance(address, SerialAddress):
        return SerialTransport(address, clock)
    if isinstance(address, TcpAddress):
        return TcpTransport(address, clock)
    if isinstance(address, FileAddress):
        return FileTransport(address, clock)
    return UdpTransport(address, clock)


def open_can(text: str, clock: Clock = time.monotonic) -> CanBus:
    """Open `can:socketcan:can0`, `can:slcan:DEVICE@BAUD`, `can:udp_multicast:GROUP:PORT` or `can:virtual:NAME`.

    A bus that is not there is no error: `connected` is False, `trouble` holds why, and `read` tries again.

    Raises ConfigurationError where the address is none; names what is allowed.
    """
    return PythonCanBus(parse_can(text), clock)
