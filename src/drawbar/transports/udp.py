"""UDP sockets: datagrams with their sender and the kernel's receive stamp; a taken port is refused in plain words."""

import errno
import socket
import struct
import sys
import time
from contextlib import suppress

from drawbar.errors import HardwareError
from drawbar.transports.address import UdpAddress
from drawbar.transports.base import Received, Transport
from drawbar.transports.clock import Clock, StampConverter

SO_TIMESTAMPNS = 35
"""Linux; Python has no name for it"""
IP_PKTINFO = 8
"""the same; selects the interface by which a datagram leaves"""
EVERYONE = "255.255.255.255"
STAMP = struct.Struct("@ll")
"""seconds and nanoseconds of the wall clock"""
_BY_INTERFACE = struct.Struct("@iII")
"""number of the interface, then addresses that the system is to choose"""
LONGEST = 65536
AT_ONCE = 1000
"""datagrams that one call of `read` takes at most"""
KNOWN_PORTS = {9999: "AgIO", 17777: "AgIO", 15555: "AgOpenGPS"}
"""programs of AgOpenGPS that listen there"""


class UdpTransport(Transport):
    """A UDP socket that no other program shares: SO_REUSEADDR is off, so a program that has the port is noticed."""

    def __init__(self, address: UdpAddress, clock: Clock = time.monotonic, wall_clock: Clock = time.time) -> None:
        """Bind; raises HardwareError where the port is taken or the address is not this computer's."""
        self.address = address
        self._clock = clock
        self._stamps = StampConverter(clock, wall_clock)
        self._socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self._socket.setblocking(False)
        if address.broadcast:
            self._socket.setsockopt(socket.SOL_SOCKET, socket.SO_BROADCAST, 1)
        self._stamped = sys.platform == "linux"
        if self._stamped:
            self._socket.setsockopt(socket.SOL_SOCKET, SO_TIMESTAMPNS, 1)
        self._bind()
        self.connected = True

    @property
    def port(self) -> int:
        """The port that it listens on."""
        return int(self._socket.getsockname()[1])

    def fileno(self) -> int:
        """Return the descriptor to wait on, -1 once closed."""
        return self._socket.fileno()

    def read(self) -> list[Received]:
        """Return the datagrams that have arrived."""
        received: list[Received] = []
        for _ in range(AT_ONCE if self.connected else 0):
            try:
                data, ancillary, _, source = self._socket.recvmsg(LONGEST, socket.CMSG_SPACE(STAMP.size))
            except (BlockingIOError, InterruptedError):
                break
            except OSError:
                continue  # the network's answer to something sent earlier; reading it takes it away
            received.append(Received(self._time(ancillary), data, f"{source[0]}:{source[1]}"))
        return received

    def write(self, data: bytes) -> bool:
        """Send one datagram to the peer of the address, and return whether it was taken."""
        if self.address.peer is None:
            self.trouble = "not sent: the address has no peer"
            self.unsent += len(data)
            return False
        return self.write_to(data, self.address.peer)

    def write_to(self, data: bytes, peer: tuple[str, int]) -> bool:
        """Send one datagram to an IPv4 address and port, and return whether it was taken."""
        try:
            self._socket.sendto(data, peer)
        except OSError as error:
            hint = "; a broadcast address needs broadcast=1" if error.errno == errno.EACCES else ""
            self.trouble = f"not sent to {peer[0]}:{peer[1]}: {error.strerror}{hint}"
            self.unsent += len(data)
            return False
        self.trouble = ""
        return True

    def write_everywhere(self, data: bytes, port: int) -> None:
        """Broadcast one datagram to a port, on every network of this computer that takes it.

        Off Linux only on the network that the system prefers.
        """
        ways: list[list[tuple[int, int, bytes]]] = [[]]
        if sys.platform == "linux":
            numbers = [number for number, _ in socket.if_nameindex()]
            ways = [[(socket.IPPROTO_IP, IP_PKTINFO, _BY_INTERFACE.pack(number, 0, 0))] for number in numbers]
        for way in ways:
            with suppress(OSError):  # an interface that is down, or has no address
                self._socket.sendmsg([data], way, 0, (EVERYONE, port))

    def close(self) -> None:
        """Close the socket."""
        self.connected = False
        self._socket.close()

    def _bind(self) -> None:
        host, port = self.address.host, self.address.port
        try:
            self._socket.bind((host, port))
        except OSError as error:
            self._socket.close()
            raise _refusal(host, port, error) from None

    def _time(self, ancillary: list[tuple[int, int, bytes]]) -> float:
        for level, kind, data in ancillary:
            if level == socket.SOL_SOCKET and kind == SO_TIMESTAMPNS and len(data) == STAMP.size:
                seconds, nanoseconds = STAMP.unpack(data)
                return self._stamps.monotonic(seconds + 1e-9 * nanoseconds)
        return self._clock()


def _refusal(host: str, port: int, error: OSError) -> HardwareError:
    if error.errno == errno.EADDRINUSE:
        program = f" ({KNOWN_PORTS[port]}?)" if port in KNOWN_PORTS else ""
        return HardwareError(
            f"port {port} is taken: another program{program} listens there; stop it or give another port"
        )
    if error.errno == errno.EADDRNOTAVAIL:
        return HardwareError(f"{host} is no address of this computer; give one of its own, or 0.0.0.0 for all of them")
    return HardwareError(f"cannot listen on {host}:{port}: {error.strerror}")
