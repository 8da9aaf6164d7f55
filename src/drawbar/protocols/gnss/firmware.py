"""Firmware: make and version that a receiver reports: u-blox's MON-VER, Septentrio's ReceiverSetup. Pure."""

from pysbf2 import SBFReader

from drawbar.protocols.gnss.framing import Frame, Protocol

ASK_UBX = bytes.fromhex("b5620a0400000e34")
"""asks a u-blox receiver for MON-VER, and changes nothing"""
_MON_VER = b"\x0a\x04"
_HEADER, _CHECKSUM = 6, 2
_SOFTWARE, _FIXED, _EXTENSION = 30, 40, 30
"""bytes of MON-VER: of the software's version, of all before the extensions, of each extension"""
_TOLD = ("MOD", "FWVER")
"""extensions that name the receiver and its firmware"""
_RECEIVER_SETUP = 5902


def firmware(frame: Frame) -> str:
    """Return the make and version in a frame; empty: there is none."""
    if frame.protocol is Protocol.UBX and frame.data[2:4] == _MON_VER:
        return _ubx(frame.data[_HEADER:-_CHECKSUM])
    if frame.protocol is Protocol.SBF and int.from_bytes(frame.data[4:6], "little") & 0x1FFF == _RECEIVER_SETUP:
        return _sbf(frame.data)
    return ""


def _ubx(payload: bytes) -> str:
    texts = [_text(payload[at : at + _EXTENSION]) for at in range(_FIXED, len(payload), _EXTENSION)]
    named = dict(text.split("=", 1) for text in texts if "=" in text)
    stated = [named[key] for key in _TOLD if key in named]
    return ", ".join(stated) or _text(payload[:_SOFTWARE])


def _sbf(block: bytes) -> str:
    try:
        fields = vars(SBFReader.parse(block))
    except Exception:  # the parser raises errors that it does not declare
        return ""
    texts = (_text(fields.get(name, b"")) for name in ("RxName", "RxVersion"))
    return ", ".join(text for text in texts if text)


def _text(padded: bytes | str) -> str:
    text = padded if isinstance(padded, str) else padded.decode("ascii", "replace")
    return "".join(each for each in text.split("\0", 1)[0].strip() if each.isprintable())
