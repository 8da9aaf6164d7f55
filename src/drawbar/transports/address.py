"""Addresses of transports and CAN buses, as configurations write them: parsed, or refused in plain words. Pure."""

import math
from collections.abc import Callable
from dataclasses import dataclass
from ipaddress import IPv4Address, ip_address
from typing import Annotated
from urllib.parse import parse_qsl

from pydantic import AfterValidator

from drawbar.errors import ConfigurationError

TRANSPORTS = (
    "serial:/dev/ttyUSB0@460800, tcp://host:port[?silence=seconds], "
    "udp://address:port[?peer=address:port][&broadcast=1], file:path or, to listen to, a CAN bus can:interface:channel"
)
BUSES = "can:socketcan:can0, can:slcan:/dev/ttyACM0@115200, can:udp_multicast:239.74.163.2:43113 or can:virtual:name"
SLOWEST, FASTEST = 300, 4_000_000
"""baud rates of serial lines"""


@dataclass(frozen=True, slots=True, kw_only=True)
class SerialAddress:
    """A serial line, 8 data bits, no parity, 1 stop bit."""

    device: str
    baud: int
    """bit/s"""


@dataclass(frozen=True, slots=True, kw_only=True)
class TcpAddress:
    """A server to connect to."""

    host: str
    port: int
    silence: float = 1.0
    """without a byte for so long, the connection is taken for lost, s"""


@dataclass(frozen=True, slots=True, kw_only=True)
class UdpAddress:
    """Where to listen, and whom to send to."""

    host: str
    """IPv4 address of this computer; 0.0.0.0: all of them, the only one that also receives broadcasts"""
    port: int
    """0: any free one"""
    peer: tuple[str, int] | None = None
    """IPv4 address and port that `write` sends to; None: it only listens"""
    broadcast: bool = False
    """the peer is a broadcast address"""


@dataclass(frozen=True, slots=True, kw_only=True)
class FileAddress:
    """A recording to play back."""

    path: str


@dataclass(frozen=True, slots=True, kw_only=True)
class CanAddress:
    """A CAN bus of python-can."""

    interface: str
    """socketcan, slcan, udp_multicast or virtual"""
    channel: str
    number: int = 0
    """baud rate of slcan's serial line; port of udp_multicast"""


TransportAddress = SerialAddress | TcpAddress | UdpAddress | FileAddress


class _RefusedError(Exception):
    """Why a part of an address is refused."""


def parse_transport(text: str) -> TransportAddress:
    """Return the parts of an address of a transport.

    Raises ConfigurationError with the address, what is wrong with it and the forms that are allowed.
    """
    kind, colon, rest = text.partition(":")
    parsers: dict[str, Callable[[str], TransportAddress]]
    parsers = {"serial": _serial, "tcp": _tcp, "udp": _udp, "file": _file}
    parse = parsers.get(kind)
    try:
        if parse is None or not colon:
            raise _RefusedError(f"{kind!r} is no kind of transport")
        return parse(rest)
    except _RefusedError as reason:
        raise ConfigurationError(f"transport {text!r}: {reason}; give {TRANSPORTS}") from None


def parse_can(text: str) -> CanAddress:
    """Return the parts of an address of a CAN bus.

    Raises ConfigurationError with the address, what is wrong with it and the forms that are allowed.
    """
    kind, _, rest = text.partition(":")
    interface, _, channel = rest.partition(":")
    try:
        if kind != "can" or interface not in ("socketcan", "slcan", "udp_multicast", "virtual"):
            raise _RefusedError(f"{kind}:{interface} is no kind of CAN bus")
        return _bus(interface, channel)
    except _RefusedError as reason:
        raise ConfigurationError(f"CAN bus {text!r}: {reason}; give {BUSES}") from None


def stays_here(text: str) -> bool:
    """Return whether what goes to an address of a transport or a CAN bus cannot leave this computer.

    Raises ConfigurationError where the address is none.
    """
    if text.startswith("can:"):
        bus = parse_can(text)
        virtual = bus.interface == "socketcan" and bus.channel.startswith("vcan")
        return bus.interface in ("udp_multicast", "virtual") or virtual  # the hop limit of multicast is 0
    address = parse_transport(text)
    if isinstance(address, UdpAddress):
        return is_loopback(address.peer[0] if address.peer else address.host)
    return isinstance(address, TcpAddress) and is_loopback(address.host)


def is_loopback(host: str) -> bool:
    """Return whether a host is this computer, by an address that nothing outside of it has."""
    try:
        return ip_address(host).is_loopback
    except ValueError:
        return host == "localhost"


def _checked_by(parse: Callable[[str], object]) -> AfterValidator:
    """Return the check of a text in settings, which need ValueError: it can be parsed, and stays as it is."""

    def check(text: str) -> str:
        try:
            parse(text)
        except ConfigurationError as refusal:
            raise ValueError(str(refusal)) from None
        return text

    return AfterValidator(check)


BusText = Annotated[str, _checked_by(parse_can)]
"""The address of a CAN bus in a configuration"""
TransportText = Annotated[
    str, _checked_by(lambda text: parse_can(text) if text.startswith("can:") else parse_transport(text))
]
"""The address of a transport in a configuration, or of a CAN bus to listen to"""


def _serial(rest: str) -> SerialAddress:
    device, at, baud = rest.rpartition("@")
    if not at or not device:
        raise _RefusedError("it needs a device and a baud rate")
    return SerialAddress(device=device, baud=_integer(baud, "baud rate", SLOWEST, FASTEST))


def _tcp(rest: str) -> TcpAddress:
    place, options = _with_options(rest, "silence")
    host, port = _endpoint(place, lowest=1)
    silence = _seconds(options["silence"]) if "silence" in options else 1.0
    return TcpAddress(host=host, port=port, silence=silence)


def _udp(rest: str) -> UdpAddress:
    place, options = _with_options(rest, "peer", "broadcast")
    host, port = _internet(*_endpoint(place, lowest=0))
    peer = _internet(*_endpoint(options["peer"], lowest=1)) if "peer" in options else None
    if options.get("broadcast", "0") not in ("0", "1"):
        raise _RefusedError(f"broadcast = {options['broadcast']!r} is neither 0 nor 1")
    return UdpAddress(host=host, port=port, peer=peer, broadcast=options.get("broadcast") == "1")


def _file(rest: str) -> FileAddress:
    if not rest:
        raise _RefusedError("it needs a path")
    return FileAddress(path=rest)


def _bus(interface: str, channel: str) -> CanAddress:
    if not channel:
        raise _RefusedError("it needs a channel")
    if interface == "slcan":
        line = _serial(channel)
        return CanAddress(interface=interface, channel=line.device, number=line.baud)
    if interface == "udp_multicast":
        group, port = _internet(*_endpoint(channel, lowest=1))
        if not IPv4Address(group).is_multicast:
            raise _RefusedError(f"{group} is no multicast group (224.0.0.0 to 239.255.255.255)")
        return CanAddress(interface=interface, channel=group, number=port)
    return CanAddress(interface=interface, channel=channel)


def _with_options(rest: str, *allowed: str) -> tuple[str, dict[str, str]]:
    if not rest.startswith("//"):
        raise _RefusedError("// is missing after the colon")
    place, _, query = rest[2:].partition("?")
    try:
        pairs = parse_qsl(query, keep_blank_values=True, strict_parsing=bool(query))
    except ValueError:
        raise _RefusedError(f"{query!r} is not of the form name=value&name=value") from None
    options = dict(pairs)
    unknown = [name for name in options if name not in allowed]
    if unknown or len(options) < len(pairs):
        raise _RefusedError(f"{', '.join(unknown) or 'an option given twice'} is not among its options")
    return place, options


def _endpoint(text: str, lowest: int) -> tuple[str, int]:
    host, colon, port = text.rpartition(":")
    host = host.removeprefix("[").removesuffix("]")
    if not colon or not host or any(sign in host for sign in "/@ "):
        raise _RefusedError(f"{text!r} is no host and port")
    return host, _integer(port, "port", lowest, 65535)


def _internet(host: str, port: int) -> tuple[str, int]:
    try:
        return str(IPv4Address(host)), port
    except ValueError:
        raise _RefusedError(f"{host!r} is no IPv4 address") from None


def _integer(text: str, name: str, lowest: int, highest: int) -> int:
    if not (text.isascii() and text.isdigit() and lowest <= int(text[:9]) <= highest and len(text) < 9):
        raise _RefusedError(f"{name} {text!r} is no whole number from {lowest} to {highest}")
    return int(text)


def _seconds(text: str) -> float:
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not 0.0 < value <= 3600.0:
        raise _RefusedError(f"silence = {text!r} is not a number of seconds above 0 and up to 3600")
    return value
