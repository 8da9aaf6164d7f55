"""Addresses of transports and buses: what each says, and every refusal with what was given and what is allowed."""

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from drawbar.errors import ConfigurationError
from drawbar.transports.address import (
    CanAddress,
    FileAddress,
    SerialAddress,
    TcpAddress,
    UdpAddress,
    parse_can,
    parse_transport,
)

GOOD = {
    "serial:/dev/ttyUSB0@460800": SerialAddress(device="/dev/ttyUSB0", baud=460800),
    "serial:/dev/serial/by-id/usb-a@b@115200": SerialAddress(device="/dev/serial/by-id/usb-a@b", baud=115200),
    "tcp://192.168.3.1:28784": TcpAddress(host="192.168.3.1", port=28784),
    "tcp://receiver.local:28784?silence=2.5": TcpAddress(host="receiver.local", port=28784, silence=2.5),
    "tcp://[::1]:5000": TcpAddress(host="::1", port=5000),
    "udp://0.0.0.0:9999": UdpAddress(host="0.0.0.0", port=9999),
    "udp://0.0.0.0:9999?peer=192.168.5.255:8888&broadcast=1": UdpAddress(
        host="0.0.0.0", port=9999, peer=("192.168.5.255", 8888), broadcast=True
    ),
    "file:/tmp/a b.txt": FileAddress(path="/tmp/a b.txt"),
}
BAD = {
    "ttyUSB0": "'ttyUSB0' is no kind of transport",
    "": "'' is no kind of transport",
    "usb:/dev/ttyUSB0@9600": "'usb' is no kind of transport",
    "can:socketcan:can0": "'can' is no kind of transport",
    "serial:/dev/ttyUSB0": "it needs a device and a baud rate",
    "serial:@115200": "it needs a device and a baud rate",
    "serial:/dev/ttyUSB0@fast": "baud rate 'fast' is no whole number from 300 to 4000000",
    "serial:/dev/ttyUSB0@²": "baud rate '²' is no whole number",
    "serial:/dev/ttyUSB0@115200000000000": "is no whole number from 300",
    "tcp:host:80": "// is missing after the colon",
    "tcp://host": "'host' is no host and port",
    "tcp://:80": "':80' is no host and port",
    "tcp://me@host:80": "is no host and port",
    "tcp://host:0": "port '0' is no whole number from 1 to 65535",
    "tcp://host:80?silence=0": "silence = '0' is not a number of seconds",
    "tcp://host:80?silence=nan": "silence = 'nan' is not a number of seconds",
    "tcp://host:80?silence=x": "silence = 'x' is not a number of seconds",
    "tcp://host:80?wait=1": "wait is not among its options",
    "tcp://host:80?silence": "'silence' is not of the form name=value",
    "tcp://host:80?silence=1&silence=2": "an option given twice",
    "udp://board:9999": "'board' is no IPv4 address",
    "udp://0.0.0.0:9999?peer=1.2.3.4:0": "port '0' is no whole number from 1",
    "udp://0.0.0.0:9999?broadcast=yes": "broadcast = 'yes' is neither 0 nor 1",
    "udp://0.0.0.0:99999": "port '99999' is no whole number from 0 to 65535",
    "file:": "it needs a path",
}
GOOD_BUSES = {
    "can:socketcan:can0": CanAddress(interface="socketcan", channel="can0"),
    "can:slcan:/dev/ttyACM0@115200": CanAddress(interface="slcan", channel="/dev/ttyACM0", number=115200),
    "can:udp_multicast:239.74.163.2:43113": CanAddress(interface="udp_multicast", channel="239.74.163.2", number=43113),
    "can:virtual:name": CanAddress(interface="virtual", channel="name"),
}
BAD_BUSES = {
    "serial:/dev/ttyUSB0@9600": "is no kind of CAN bus",
    "can:can0": "can:can0 is no kind of CAN bus",
    "can:pcan:1": "can:pcan is no kind of CAN bus",
    "can:virtual:": "it needs a channel",
    "can:slcan:/dev/ttyACM0": "it needs a device and a baud rate",
    "can:udp_multicast:10.0.0.1:43113": "10.0.0.1 is no multicast group",
    "can:udp_multicast:239.74.163.2": "is no host and port",
}


KINDS = {
    "transport": (parse_transport, GOOD, BAD, "serial:/dev/ttyUSB0@460800"),
    "bus": (parse_can, GOOD_BUSES, BAD_BUSES, "can:socketcan:can0"),
}
"""how an address is parsed, which are right, which are wrong and why, and what is told to be a right one"""


@pytest.mark.parametrize(("kind", "text"), [(kind, text) for kind in KINDS for text in KINDS[kind][1]])
def test_an_address_is_understood(kind: str, text: str) -> None:
    parse, good, _, _ = KINDS[kind]
    assert parse(text) == good[text]


@pytest.mark.parametrize(("kind", "text"), [(kind, text) for kind in KINDS for text in KINDS[kind][2]])
def test_a_wrong_address_is_refused(kind: str, text: str) -> None:
    parse, _, bad, example = KINDS[kind]
    with pytest.raises(ConfigurationError) as caught:
        parse(text)
    for told in (bad[text], repr(text), example):
        assert told in str(caught.value)


@settings(derandomize=True, deadline=None)
@given(st.sampled_from(["serial:", "tcp://", "udp://", "file:", "can:slcan:", "can:udp_multicast:", ""]), st.text())
def test_any_text_is_understood_or_refused(kind: str, rest: str) -> None:
    text = kind + rest
    for parse in (parse_transport, parse_can):
        told = None
        try:
            parse(text)
        except ConfigurationError as refusal:
            told = str(refusal)
        assert told is None or repr(text) in told
