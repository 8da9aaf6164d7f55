"""Fuzzing of the receivers' parsers at length: python tests/protocols/gnss/fuzz.py [FRAMES [SEED]].

Frames of the stand-in are altered in their bodies and given right checksums, altered without, cut, joined and mixed
with noise; all go the whole way from bytes to epochs. Between them stand intact frames, which must all come out.
Nothing may raise. Prints how many frames there were, how long one took and what was dropped.
"""

import datetime
import math
import random
import sys
import time
from collections import Counter

from drawbar.machine.stand_in import nmea, sbf, ubx
from drawbar.machine.stand_in.receiver import Report
from drawbar.protocols.gnss.assembly import Assembler
from drawbar.protocols.gnss.checksums import crc24q, crc_ccitt
from drawbar.protocols.gnss.decoding import Decoder
from drawbar.protocols.gnss.framing import Framer
from drawbar.protocols.gnss.settings import EpochSettings
from drawbar.signals import FixQuality

_BATCH = 100
"""frames between two intact ones and a look at the clock"""
_TOKENS = (
    "",
    "nan",
    "inf",
    "-inf",
    "1e999",
    "-1",
    "0",
    "999999999999",
    "abc",
    "-",
    ".",
    "65535",
    "1_0",
    " 1",
    "9" * 60,
)
_BEGIN = datetime.datetime(2026, 11, 22, 12, tzinfo=datetime.UTC)
_SENTENCES = (nmea.gga, nmea.vtg, nmea.gst, nmea.rmc, nmea.zda, nmea.hdt, nmea.ths, nmea.hrp, nmea.hpr, nmea.avr)
_ENCODERS = (*_SENTENCES, nmea.rot, nmea.ksxt, nmea.panda, nmea.paogi, ubx.pvt, ubx.hpposllh, ubx.relposned)
_BLOCKS = (sbf.pvt_geodetic, sbf.pos_cov_geodetic, sbf.att_euler, sbf.att_cov_euler)


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
    match chance.randrange(6):
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
        case _:
            for _ in range(chance.randrange(1, 6)):
                if changed:
                    changed[chance.randrange(len(changed))] = chance.randrange(256)
    return bytes(changed)


def _sentence(body: str, chance: random.Random) -> bytes:
    """Return a sentence with other fields: replaced, missing, doubled, or with other characters."""
    fields = body.split(",")
    place = chance.randrange(len(fields))
    match chance.randrange(5):
        case 0:
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


def fuzz(count: int, seed: int) -> tuple[int, float, Counter[str]]:
    """Fuzz with at least `count` frames; return how many came out whole, CPU time of each of the slowest 100, counts.

    Raises whatever a parser raises, and AssertionError if an intact frame does not come out.
    """
    chance = random.Random(seed)
    frames = corpus(chance)
    framer, decoder, assembler = Framer(), Decoder(), Assembler(EpochSettings())
    whole, longest = 0, 0.0
    for batch in range(-(-count // _BATCH)):
        control = nmea.sentence(
            f"GNGGA,{batch % 86400:06d}.00,5052.6123456,N,00442.1234567,E,4,17,0.7,42.3,M,45.7,M,1.2,0"
        )
        chosen = [altered(chance.choice(frames), chance) for _ in range(_BATCH)]
        data = b"".join(broken(each, chance) if chance.random() < 0.2 else each for each in chosen)
        cuts = sorted(chance.randrange(len(data)) for _ in range(8))
        started, found = time.process_time(), []
        for start, end in zip([0, *cuts], [*cuts, len(data)], strict=True):
            found += framer.push(data[start:end], float(batch))
        found += framer.push(control, float(batch)) + framer.settle()
        for frame in found:
            message = decoder.decode(frame)
            if message is not None:
                assembler.add(message, frame.time)
        assembler.close()
        longest = max(longest, time.process_time() - started)
        assert control.rstrip() in [frame.data for frame in found], f"batch {batch} of seed {seed} lost an intact frame"
        whole += len(found)
    return whole, longest / _BATCH, framer.dropped + decoder.dropped + assembler.dropped


def main(arguments: list[str]) -> None:
    """Fuzz with as many frames as are asked for, in steps, and say after each what has been done."""
    count, seed = int(arguments[0]) if arguments else 100_000, int(arguments[1]) if arguments[1:] else 0
    done, intact, slowest, total, begin = 0, 0, 0.0, Counter[str](), time.perf_counter()
    while done < count:
        step = min(100_000, count - done)
        whole, longest, dropped = fuzz(step, seed)
        done, intact, slowest, total, seed = (
            done + step,
            intact + whole,
            max(slowest, longest),
            total + dropped,
            seed + 1,
        )
        mean = (time.perf_counter() - begin) / done
        print(
            f"{done} frames, {intact} with right checksums, {mean * 1e6:.0f} µs each with their making, none raised; ",
            end="",
        )
        print(f"slowest hundred {slowest * 1e6:.0f} µs each", flush=True)
    for kind, number in total.most_common():
        print(f"{number:12d}  {kind}")


if __name__ == "__main__":
    main(sys.argv[1:])
