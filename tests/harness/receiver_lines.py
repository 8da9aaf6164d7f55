"""Lines of receivers with all that may befall them, from one seed: bursts of frames, each with what was true of it.

The longitude tells which epoch a position is of, the yaw which one a heading is of, so whatever comes out can be held
against the truth. A mishap befalls some epochs at the beginning; the last ones are clean.
"""

import datetime
import random
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from functools import partial

from hostile_frames import altered, broken
from receiver_frames import nmea, sbf, ubx

from drawbar.machine.stand_in.receiver import Report
from drawbar.signals import FixQuality

LATITUDE, LONGITUDE = 50.87, 4.7
STEP = 1e-5
"""degrees of longitude from an epoch to the next, 0.7 m"""
TURN = 0.02
"""rad from an epoch to the next"""
SPEED = 3.5
"""m/s"""
INTERVAL = 0.2
"""of epochs, s"""
DELAY = 0.05
"""from an epoch to its first byte, s"""
CLEAN = 24
"""epochs at the end that nothing befalls"""
QUIET = 6
"""epochs that nothing befalls at the beginning, and after the receiver has set its clock: they tell what time it is;
after one with a wrong time nothing befalls the next"""

Encoder = Callable[[Report], list[bytes]]


def _of(*encoders: Callable[[Report], bytes]) -> Encoder:
    return lambda report: [encode(report) for encode in encoders]


DIALECTS: dict[str, Encoder] = {
    "GGA VTG GST HRP": _of(nmea.gga, nmea.vtg, nmea.gst, nmea.hrp),
    "RMC GGA GST THS": _of(nmea.rmc, nmea.gga, nmea.gst, nmea.ths),
    "ZDA GGA VTG HDT": _of(nmea.zda, nmea.gga, nmea.vtg, nmea.hdt),
    "GGA HPR": _of(nmea.gga, nmea.hpr),
    "GGA VTG AVR": _of(nmea.gga, nmea.vtg, nmea.avr),
    "RMC": _of(nmea.rmc),
    "KSXT": _of(nmea.ksxt),
    "PANDA": _of(nmea.panda),
    "PAOGI": _of(nmea.paogi),
    "SBF": _of(sbf.pvt_geodetic, sbf.pos_cov_geodetic, sbf.att_euler),
    "SBF alone": _of(sbf.pvt_geodetic),
    "UBX": _of(ubx.pvt, ubx.hpposllh, ubx.relposned),
    "GGA UBX": _of(nmea.gga, nmea.vtg, ubx.relposned),
    "SBF GGA": _of(sbf.pvt_geodetic, nmea.gga, nmea.gst, sbf.att_euler),
    "UBX SBF NMEA": _of(ubx.pvt, sbf.att_euler, nmea.gst, nmea.zda),
}
"""what receivers send of one epoch"""
BEGINS = (
    datetime.datetime(2026, 11, 22, 12, 0, 0, tzinfo=datetime.UTC),
    datetime.datetime(2026, 11, 22, 23, 59, 56, tzinfo=datetime.UTC),  # midnight
    datetime.datetime(2026, 11, 21, 23, 59, 38, tzinfo=datetime.UTC),  # end of the GPS week
)


@dataclass(slots=True)
class Burst:
    """What comes of one epoch."""

    index: int
    time: float
    """when its first byte comes, s"""
    frames: list[bytes] = field(default_factory=list)
    mishap: str = ""
    """empty: none"""


_QUALITIES = (FixQuality.NONE, FixQuality.SINGLE, FixQuality.DIFFERENTIAL, FixQuality.FLOAT)
Hop = Callable[[float], list[bytes]]
"""frames of the burst as they were if its time were so much later, s"""
Mishap = Callable[[Burst, random.Random, Hop], None]


def truth(index: int, begin: datetime.datetime, quality: FixQuality = FixQuality.FIXED) -> Report:
    """Return what the receiver is to report of an epoch."""
    return Report(
        time=begin + datetime.timedelta(seconds=INTERVAL * index),
        latitude=LATITUDE,
        longitude=LONGITUDE + STEP * index,
        height=60.0,
        quality=quality,
        speed=SPEED,
        course=0.0,
        yaw=TURN * (index - 60),
        roll=0.02,
        pitch=-0.01,
        inertial_yaw=TURN * (index - 60),
        yaw_rate=TURN / INTERVAL,
    )


def line(
    encode: Encoder,
    chance: random.Random,
    *,
    begin: datetime.datetime,
    mishaps: Sequence[Mishap],
    count: int = 60,
    share: float = 0.4,
) -> list[Burst]:
    """Return the bursts of a line, in the order of their arrival, `share` of them with a mishap but for the last."""
    shift, arrived, quiet = 0.0, 0.0, QUIET
    bursts: list[Burst] = []
    for index in range(count):
        burst = Burst(index, 100.0 + INTERVAL * index + DELAY + chance.uniform(0.0, 0.004))
        hurt = quiet <= index < count - CLEAN and chance.random() < share
        mishap = chance.choice(mishaps) if hurt else None
        at = begin + datetime.timedelta(seconds=shift)
        if mishap is jump:
            quiet = index + 2
        if mishap is set_clock:
            quiet = index + 1 + QUIET
            shift += chance.choice((-3.0, 1.0, 0.35, 40_000.0, -7200.0))
        burst.frames = encode(truth(index, at, chance.choice(_QUALITIES) if mishap is flip else FixQuality.FIXED))
        if mishap is not None:
            burst.mishap = mishap.__name__
            mishap(burst, chance, partial(_later, encode, index, at))
        burst.time = arrived = max(burst.time, arrived)
        bursts.append(burst)
    return bursts


def _later(encode: Encoder, index: int, begin: datetime.datetime, hop: float) -> list[bytes]:
    return encode(truth(index, begin + datetime.timedelta(seconds=hop)))


def index_of(longitude: float) -> int:
    """Return the epoch that a longitude tells of."""
    return round((longitude - LONGITUDE) / STEP)


def flip(burst: Burst, chance: random.Random, hop: Hop) -> None:
    """The quality is another one."""


def set_clock(burst: Burst, chance: random.Random, hop: Hop) -> None:
    """The receiver's clock is another one from the next epoch on."""


def alter(burst: Burst, chance: random.Random, hop: Hop) -> None:
    """A frame says something else, with the checksum that belongs to it."""
    for _ in range(chance.randrange(1, 3)):
        place = chance.randrange(len(burst.frames))
        burst.frames[place] = altered(burst.frames[place], chance)


def break_frame(burst: Burst, chance: random.Random, hop: Hop) -> None:
    """A frame loses or gets bytes."""
    place = chance.randrange(len(burst.frames))
    burst.frames[place] = broken(burst.frames[place], chance)


def lose(burst: Burst, chance: random.Random, hop: Hop) -> None:
    """Some frames, or all, do not come."""
    burst.frames = [frame for frame in burst.frames if chance.random() < 0.4]


def repeat(burst: Burst, chance: random.Random, hop: Hop) -> None:
    """All comes twice, or more often."""
    burst.frames *= chance.randrange(2, 5)


def shuffle(burst: Burst, chance: random.Random, hop: Hop) -> None:
    """Frames come in another order."""
    chance.shuffle(burst.frames)


def delay(burst: Burst, chance: random.Random, hop: Hop) -> None:
    """The burst comes later, and others with it."""
    burst.time += chance.uniform(0.0, 0.9)


def jump(burst: Burst, chance: random.Random, hop: Hop) -> None:
    """The time of this epoch alone is another one."""
    burst.frames = hop(chance.choice((0.05, 0.3, 0.7, 3.0, 100.0, 40_000.0, -0.1, -0.5, -5.0, -40_000.0)))


def add_noise(burst: Burst, chance: random.Random, hop: Hop) -> None:
    """Bytes of no meaning, or the beginning of a long frame, stand between the frames."""
    noise = (chance.randbytes(chance.randrange(1, 300)), b"\xb5b\x01\x07\xff\x03", b"\xd3\x03\xff", b"$@\0\0\0\0\0\x08")
    burst.frames.insert(chance.randrange(len(burst.frames) + 1), chance.choice(noise))


MISHAPS: tuple[Mishap, ...] = (
    *(
        flip,
        set_clock,
        *[alter] * 6,
        break_frame,
        break_frame,
        lose,
        lose,
        repeat,
        shuffle,
        delay,
        jump,
        jump,
        add_noise,
    ),
)
"""the more often one stands here, the more often it happens"""
