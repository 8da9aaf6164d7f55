"""Hostile frames of receivers: intact round impossible contents, or broken as a bad line breaks them."""

import datetime
import math
import random
import struct

from receiver_frames import nmea, sbf, ubx

from drawbar.machine.stand_in.receiver import Report
from drawbar.protocols.crc24q import crc24q
from drawbar.protocols.gnss.checksums import crc_ccitt
from drawbar.signals import FixQuality

_TOKENS = (
    *("", "0", "-0.0", "-1", "1", "91", "181", "9100.0", "5099.9999999", "65535", "9999.9", "999999999999", "9" * 60),
    *("nan", "inf", "-inf", "1e999", "1e308", "-1e308", "1e-310", "1_0", " 1", "abc", "-", ".", "X", "235960.00"),
)
"""what a field of a sentence may hold"""
_NUMBERS = (
    *(struct.pack("<d", number) for number in (math.nan, math.inf, -math.inf, 1e308, -1e308, 5e-324, -0.0, 2.0, 1e9)),
    *(struct.pack("<f", number) for number in (math.nan, math.inf, -math.inf, 3e38, -3e38, 1e-45, -0.0, -2e10, 1e-9)),
    *(struct.pack("<I", number) for number in (0, 1, 0x7FFFFFFF, 0x80000000, 0xFFFFFFFF, 604_799_999, 604_800_000)),
    *(struct.pack("<H", number) for number in (0, 0x7FFF, 0x8000, 0xFFFF, 0xFFFE)),
)
"""what a field of a binary frame may hold"""
_BEGIN = datetime.datetime(2026, 11, 22, 12, tzinfo=datetime.UTC)
_SENTENCES = (nmea.gga, nmea.vtg, nmea.gst, nmea.rmc, nmea.zda, nmea.hdt, nmea.ths, nmea.hrp, nmea.hpr, nmea.avr)
_ENCODERS = (*_SENTENCES, nmea.rot, nmea.ksxt, nmea.panda, nmea.paogi, ubx.pvt, ubx.hpposllh, ubx.relposned)
_BLOCKS = (sbf.pvt_geodetic, sbf.pos_cov_geodetic, sbf.att_euler)


def corpus(chance: random.Random) -> list[bytes]:
    """Return frames of every kind, of reports with and without fix and attitude."""
    frames = []
    for index in range(40):
        angles = [math.nan] * 5 if index % 5 == 0 else [chance.uniform(-0.5, 0.5) for _ in range(5)]
        report = Report(
            time=_BEGIN + datetime.timedelta(milliseconds=100 * index),
            latitude=chance.uniform(-89.0, 89.0),
            longitude=chance.uniform(-180.0, 180.0),
            height=chance.uniform(-100.0, 4000.0),
            quality=chance.choice(list(FixQuality)[1:]),
            speed=chance.uniform(0.0, 5.0),
            course=chance.uniform(-3.0, 3.0),
            **dict(zip(("yaw", "roll", "pitch", "inertial_yaw", "yaw_rate"), angles, strict=True)),
        )
        frames += [encode(report) for encode in (*_ENCODERS, *_BLOCKS)]
    frames += [rtcm(chance.randbytes(chance.randrange(60))) for _ in range(40)]
    return [frame for frame in frames if frame]


def rtcm(payload: bytes) -> bytes:
    """Return a payload with RTCM's frame."""
    body = b"\xd3" + len(payload).to_bytes(2, "big") + payload
    return body + crc24q(body).to_bytes(3, "big")


def altered(frame: bytes, chance: random.Random) -> bytes:
    """Return a frame with another body, and the checksum that belongs to it."""
    if frame[:2] == b"\xb5b":
        return ubx.frame(frame[2], frame[3], _bytes(frame[6:-2], chance))
    if frame[:2] == b"$@":
        body = _bytes(frame[8:], chance)[:2000]
        body += bytes(-len(body) % 4)
        tail = frame[4:6] + (8 + len(body)).to_bytes(2, "little") + body
        return b"$@" + crc_ccitt(tail).to_bytes(2, "little") + tail
    if frame[:1] == b"$":
        return _sentence(frame[1 : frame.rindex(b"*")].decode(), chance)
    return rtcm(_bytes(frame[3:-3], chance)[:1023])


def _bytes(body: bytes, chance: random.Random) -> bytes:
    """Return other bytes: some replaced, cut off, put on, or all of them anything."""
    changed = bytearray(body)
    match chance.randrange(9):
        case 0:
            return chance.randbytes(len(body))
        case 1:
            return bytes(body[: chance.randrange(len(body) + 1)])
        case 2:
            return bytes(body) + chance.randbytes(chance.randrange(100))
        case 3:
            start = chance.randrange(len(body) + 1)
            changed[start : start + 8] = chance.choice((b"\xff", b"\0", b"\x7f", b"\x80")) * len(
                changed[start : start + 8]
            )
        case 4 | 5 | 6 if len(body) >= 8:
            value = chance.choice(_NUMBERS)
            place = 2 * chance.randrange((len(body) - len(value)) // 2 + 1)
            changed[place : place + len(value)] = value
        case _:
            for _ in range(chance.randrange(1, 6)):
                if changed:
                    changed[chance.randrange(len(changed))] = chance.randrange(256)
    return bytes(changed)


def _sentence(body: str, chance: random.Random) -> bytes:
    """Return a sentence with other fields: replaced, missing, doubled, or with other characters."""
    fields = body.split(",")
    place = chance.randrange(len(fields))
    match chance.randrange(7):
        case 0 | 5 | 6:
            for place in chance.sample(range(len(fields)), min(chance.choice((1, 1, 2, 3)), len(fields))):
                fields[place] = chance.choice(_TOKENS)
        case 1:
            del fields[place]
        case 2:
            fields.insert(place, chance.choice(fields))
        case 3:
            fields = fields[:place]
        case _:
            text = list(fields[place] or "0")
            text[chance.randrange(len(text))] = chr(chance.randrange(0x20, 0x7F))
            fields[place] = "".join(text)
    return nmea.sentence(",".join(fields).replace("$", "").replace("*", ""))


def broken(data: bytes, chance: random.Random) -> bytes:
    """Return bytes as a bad line delivers them: a bit flipped, a part lost, some noise put in."""
    changed = bytearray(data)
    place = chance.randrange(len(changed))
    match chance.randrange(3):
        case 0:
            changed[place] ^= 1 << chance.randrange(8)
        case 1:
            del changed[place : place + chance.randrange(1, 20)]
        case _:
            changed[place:place] = chance.randbytes(chance.randrange(1, 40))
    return bytes(changed)
