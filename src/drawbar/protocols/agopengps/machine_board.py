"""Machine board: relays, lift and tram lines (239, 238, 236, 235, 229), its replies (237, 123), switches and texts.

A relay follows its section's bit and falls 4.2 s after the last 239: good for a horn or a lamp, not for an emergency
stop.
"""

import struct
from collections.abc import Collection, Sequence
from dataclasses import dataclass

from drawbar.protocols.agopengps.frame import COMPUTER, Frame, Pgn, byte, pack, scaled

RELAYS = 16
PIN_FUNCTIONS = 21
"""0 none, 1 to 16 relay, 17 lift lower, 18 lift raise, 19 tram right, 20 tram left, 21 stop at the field's edge"""


def encode_machine(
    relays: Collection[int], *, speed: float = 0.0, u_turn: int = 0, lift: int = 0, tram: int = 0, edge_stop: int = 0
) -> bytes:
    """Return the datagram that switches on the given relays, 1 to 16, and no others (239); send it at 5 to 10 Hz.

    speed: m/s, up to 7 m/s; lift: 0 leave, 1 lower, 2 raise; tram: bit 0 right, bit 1 left.
    Raises HardwareError when a value does not fit the wire.
    """
    bits = sum(1 << (byte("relay", relay, 1, RELAYS) - 1) for relay in set(relays))
    data = struct.pack(
        "<6BH",
        byte("u_turn", u_turn),
        scaled("speed, m/s,", abs(speed), 36.0, 0, 0xFF),
        byte("lift", lift, 0, 2),
        byte("tram", tram, 0, 3),
        byte("edge_stop", edge_stop, 0, 1),
        0,
        bits,
    )
    return pack(COMPUTER, Pgn.MACHINE, data)


def encode_machine_config(
    *, raise_time: int, lower_time: int, lift: bool, relay_active_high: bool = False, user: bytes = bytes(4)
) -> bytes:
    """Return the datagram of the lift's times in s and of the relays' level (238); the board stores it.

    Raises HardwareError when a value does not fit the wire.
    """
    if len(user) != 4:
        byte("length of user", len(user), 4, 4)
    times = (byte("raise_time", raise_time), byte("lower_time", lower_time))
    return pack(COMPUTER, Pgn.MACHINE_CONFIG, bytes((*times, lift, relay_active_high)) + user)


def encode_machine_pins(functions: Sequence[int]) -> bytes:
    """Return the datagram of what each of the 24 pins does (236), absent ones nothing; the board stores it.

    Raises HardwareError for more than 24, and for numbers above 21, with which boards read beyond their table.
    """
    byte("number of pins", len(functions), 0, 24)
    pins = bytes(byte("function of a pin", function, 0, PIN_FUNCTIONS) for function in functions)
    return pack(COMPUTER, Pgn.MACHINE_PINS, pins.ljust(24, b"\0"))


def encode_section_widths(widths: Sequence[float]) -> bytes:
    """Return the datagram of up to 16 sections' widths in m (235); raises HardwareError when one does not fit."""
    count = byte("number of sections", len(widths), 0, 16)
    counts = [scaled("width of a section, m,", width, 100.0, 0, 0xFFFF) for width in widths]
    data = struct.pack("<16HB", *counts, *[0] * (16 - count), count)
    return pack(COMPUTER, Pgn.SECTION_WIDTHS, data)


def encode_sections(sections: Collection[int], *, left_speed: int, right_speed: int) -> bytes:
    """Return the datagram of up to 64 sections that are on, and of the tool's ends' speeds as counts (229).

    Raises HardwareError when a value does not fit the wire.
    """
    bits = sum(1 << (byte("section", section, 1, 64) - 1) for section in set(sections))
    speeds = byte("left_speed", left_speed), byte("right_speed", right_speed)
    return pack(COMPUTER, Pgn.SECTIONS_64, bits.to_bytes(8, "little") + bytes(speeds))


def decode_machine_reply(frame: Frame) -> bytes | None:
    """Return the four bytes a machine board reports at 5 Hz (237); None: not such a message.

    The published firmware sends it with the source of a computer, so the source is not looked at.
    """
    if frame.pgn != Pgn.MACHINE_REPLY or len(frame.data) < 4:
        return None
    return frame.data[:4]


def decode_machine_hello(frame: Frame) -> frozenset[int] | None:
    """Return the relays that are on, 1 to 16, from a machine board's answer to a hello (123); None: another message."""
    if frame.pgn != Pgn.MACHINE_HELLO_REPLY or len(frame.data) < 2:
        return None
    bits = int.from_bytes(frame.data[:2], "little")
    return frozenset(relay for relay in range(1, RELAYS + 1) if bits >> (relay - 1) & 1)


@dataclass(frozen=True, slots=True, kw_only=True)
class SwitchBox:
    """A box of section switches (234), bytes as it sends them."""

    main: int
    auto: bytes
    """of both groups"""
    sections: int
    """how many it has"""
    on: bytes
    """of both groups"""
    off: bytes
    """of both groups"""


def decode_switch_box(frame: Frame) -> SwitchBox | None:
    """Return what a switch box says; None: not such a message."""
    if (frame.pgn, len(frame.data)) != (Pgn.SWITCH_BOX, 8):
        return None
    main, auto_0, auto_1, sections, on_0, off_0, on_1, off_1 = frame.data
    return SwitchBox(
        main=main, auto=bytes((auto_0, auto_1)), sections=sections, on=bytes((on_0, on_1)), off=bytes((off_0, off_1))
    )


def decode_text(frame: Frame) -> str | None:
    """Return a message of a board to the operator (221), what cannot be shown replaced; None: not such a message."""
    if frame.pgn != Pgn.TEXT:
        return None
    return "".join(c if c.isprintable() else "?" for c in frame.data.decode("utf-8", "replace").rstrip("\0"))
