"""Fuzzing of all parsers but the receivers' (gnss/fuzz.py) at length: python tests/protocols/fuzz.py [COUNT [SEED]].

RTCM frames, casters' replies, AgOpenGPS frames, CAN frames of NMEA 2000 and ISO 11783, sentences of sensor board and
bare valve, records between the processes, device sections of a configuration: COUNT inputs of each, made from right
ones by altering bytes, cutting and lengthening, some with the checksum that belongs to them, some of noise alone.
Nothing may raise but what a section's reader declares, and where a right input stands behind it is understood: RTCM,
sentences, records. Prints how long one takes, CPU time.
"""

import math
import random
import struct
import sys
import tempfile
import time
import zlib
from collections.abc import Callable

from drawbar.config import load_configuration
from drawbar.driving.messaging.datagrams import unpack
from drawbar.driving.stand_in.demonstration import with_isobus, with_stand_ins
from drawbar.errors import ConfigurationError
from drawbar.messages import KINDS
from drawbar.messages.records import LAYOUTS, MARK, VERSION, Flaw, decode
from drawbar.protocols.actuator import Readiness, SteeringRequest
from drawbar.protocols.agopengps.board_settings import decode_steer_config, decode_steer_settings
from drawbar.protocols.agopengps.frame import COMPUTER, PREFIX, STEER_BOARD, Frame, Pgn, checksum, parse
from drawbar.protocols.agopengps.network import decode_scan_reply
from drawbar.protocols.agopengps.steer_board import SteerBoard
from drawbar.protocols.agopengps.steering import decode_steer, decode_steer_reply
from drawbar.protocols.bare_valve import ValveBoard
from drawbar.protocols.gnss.checksums import xor
from drawbar.protocols.gnss.settings import EpochSettings
from drawbar.protocols.isobus.address import CLAIM, REQUEST, AddressClaim
from drawbar.protocols.isobus.curvature import WheelbaseCurvature
from drawbar.protocols.isobus.guidance import GuidanceValve
from drawbar.protocols.isobus.guidance_messages import MACHINE_INFO, SYSTEM_COMMAND
from drawbar.protocols.isobus.name import Name
from drawbar.protocols.isobus.node import IsobusNode
from drawbar.protocols.isobus.speed_actuator import MachineSpeed
from drawbar.protocols.isobus.tractor_messages import SELECTED_SPEED, WHEEL_SPEED
from drawbar.protocols.nmea2000.stream import Nmea2000Stream
from drawbar.protocols.ntrip import ReplyReader
from drawbar.protocols.own_sentence import own_sentence
from drawbar.protocols.rtcm import RtcmFramer, RtcmStatus, rtcm_frame
from drawbar.protocols.sensor_board import SensorBoard
from drawbar.protocols.sensors import Encoder, Potentiometer
from drawbar.protocols.speed_actuator import SpeedRequest
from drawbar.transports.base import CanFrame

_BATCH = 100
"""inputs between two looks at the clock"""
_REPLIES = (
    b"ICY 200 OK\r\n\r\n",
    b"HTTP/1.1 200 OK\r\nNtrip-Version: Ntrip/2.0\r\nTransfer-Encoding: chunked\r\n\r\n5\r\nabcde\r\n10;x=1\r\n",
    b"HTTP/1.0 401 Unauthorized\r\nWWW-Authenticate: Basic\r\n\r\n",
    b"SOURCETABLE 200 OK\r\nContent-Length: 20\r\n\r\nSTR;A;B;RTCM 3\r\nENDSOURCETABLE\r\n",
)


def changed(data: bytes, chance: random.Random) -> bytes:
    """Return other bytes: some replaced, cut off, put on, put in, or all of them anything."""
    new = bytearray(data)
    match chance.randrange(5):
        case 0:
            return chance.randbytes(chance.randrange(len(data) + 20))
        case 1:
            return bytes(new[: chance.randrange(len(new) + 1)])
        case 2:
            return bytes(new) + chance.randbytes(chance.randrange(100))
        case 3:
            place = chance.randrange(len(new) + 1)
            new[place:place] = chance.choice((b"\xff", b"\0", b"\x80", b"\r\n", b"$", b"9" * 400)) * chance.randrange(9)
        case _:
            for _ in range(chance.randrange(1, 6) if new else 0):
                new[chance.randrange(len(new))] = chance.randrange(256)
    return bytes(new)


def pieces(data: bytes, chance: random.Random) -> list[bytes]:
    """Return bytes as a stream delivers them, cut anywhere."""
    cut = chance.randrange(len(data) + 1)
    return [data[:cut], data[cut:]]


class Rtcm:
    """Correction frames: bytes, and payloads with the right checksum."""

    def __init__(self) -> None:
        self.framer, self.status = RtcmFramer(), RtcmStatus()

    def __call__(self, chance: random.Random) -> None:
        """Take one."""
        payload = changed(struct.pack(">H", chance.choice((1005, 1077, 1087, 1230, 4072)) << 4) + bytes(30), chance)
        frame = rtcm_frame(payload[:1023])
        for piece in pieces(frame if chance.random() < 0.5 else changed(frame, chance), chance):
            for found in self.framer.feed(piece):
                self.status.take(0.0, found)
        if chance.random() < 0.01:  # whatever a broken head has claimed ends within the longest frame
            mark = rtcm_frame(chance.randbytes(20))
            assert mark in [found for _ in range(60) for found in self.framer.feed(mark)]


def caster(chance: random.Random) -> None:
    """A caster's reply."""
    reader, reply = ReplyReader(), chance.choice(_REPLIES)
    for piece in pieces(changed(reply, chance) + chance.choice((b"", reply, chance.randbytes(40))), chance):
        reader.feed(piece)


class Boards:
    """AgOpenGPS frames, as a board's adapter and `drawbar check` take them."""

    def __init__(self) -> None:
        self.board, self.now = SteerBoard(board="127.0.0.1", max_angle=0.5), 0.0

    def __call__(self, chance: random.Random) -> None:
        """Take one."""
        self.now += 0.01
        pgn, source = chance.choice([*Pgn, chance.randrange(256)]), chance.choice((COMPUTER, STEER_BOARD, 0x7B))
        body = chance.randbytes(chance.choice((8, 8, 8, 5, 7, chance.randrange(60))))
        frame = PREFIX + bytes((source, pgn, len(body))) + body
        frame += bytes((checksum(frame + b"\0"),))
        frame = frame if chance.random() < 0.6 else changed(frame, chance)
        parsed = parse(frame)
        if isinstance(parsed, Frame):
            for reader in (decode_steer, decode_steer_reply, decode_scan_reply, decode_steer_config):
                reader(parsed)
            decode_steer_settings(parsed)
        self.board.receive(self.now, frame, chance.choice(("127.0.0.1:8888", "127.0.0.2:8888", "", "::1")))
        self.board.report(self.now)


class Nmea2000:
    """CAN frames of the NMEA 2000 receiver's reader, packed as a recording holds them, whole positions among them."""

    PGNS = (129029, 129025, 129026, 127250, 127257, 127251, 126992, 60928, 59904)

    def __init__(self) -> None:
        self.stream, self.now, self.last = Nmea2000Stream(EpochSettings(), 32), 0.0, -math.inf

    def __call__(self, chance: random.Random) -> None:
        """Take one, or all of a position."""
        self.now += 0.01
        identifier = 3 << 26 | chance.choice(self.PGNS) << 8 | chance.choice((32, 33, 254))
        frames = [bytes((chance.randrange(256), chance.choice((43, 8, 0, 223)))) + chance.randbytes(6)]
        if chance.random() < 0.3:
            identifier, sequence = 3 << 26 | 129029 << 8 | 32, chance.randrange(8) << 5
            said = bytearray(chance.randbytes(43)[:-1] + b"\0")
            if chance.random() < 0.8:  # a place and a time that may be
                said[3:7], said[31:33] = chance.randrange(864_000_000).to_bytes(4, "little"), b"\x40\0"
                said[7:23] = struct.pack("<qq", round(50e16), round(4e16))
            body = bytes((43,)) + said
            cuts = [body[:7], *(body[place : place + 7] for place in range(7, 44, 7))]
            frames = [bytes((sequence | index,)) + cut.ljust(7, b"\xff") for index, cut in enumerate(cuts)]
        for frame in frames:
            packed = struct.pack("<I", identifier) + frame
            packed = packed if chance.random() < 0.9 else changed(packed, chance)
            for epoch in self.stream.push(packed, self.now) + self.stream.poll(self.now):
                assert not abs(epoch.latitude) > 90.0
                assert not abs(epoch.longitude) > 180.0
                assert math.isnan(epoch.speed) or 0.0 <= epoch.speed <= 50.0
                assert self.last < epoch.time <= self.now
                self.last = epoch.time


class Isobus:
    """CAN frames of ISO 11783, as a node with a steering valve and a tractor's speed takes and answers them."""

    PGNS = (CLAIM, REQUEST, MACHINE_INFO, SYSTEM_COMMAND, SELECTED_SPEED, WHEEL_SPEED, 0xFE45, 0xFE43, 0xFD43, 0xEC00)

    def __init__(self) -> None:
        name = Name(identity=1, manufacturer=1407, function=29, device_class=1, self_configurable=True)
        self.node, self.now = IsobusNode(AddressClaim(name, 128)), 0.0
        self.valve = GuidanceValve(self.node, WheelbaseCurvature(2.5))
        self.speed = MachineSpeed(self.node, 3.0)

    def __call__(self, chance: random.Random) -> None:
        """Take one, and ask for something."""
        self.now += chance.choice((0.001, 0.01, 0.1, 0.1))
        pgn, source = chance.choice((*self.PGNS, chance.randrange(1 << 18))), chance.choice((0, 19, 38, 128, 129, 254))
        data = chance.choice((chance.randbytes(8), b"\xff" * 8, bytes(8), b"\0\xee\0", chance.randbytes(5), b""))
        self.valve.receive(self.now, CanFrame(chance.randrange(8) << 26 | pgn << 8 | source, data))
        angle = chance.choice((0.1, -0.5, 0.0, math.nan, math.inf))
        frames = self.valve.send(self.now, SteeringRequest(steer=chance.random() < 0.9, angle=angle, speed=1.0))
        wanted = SpeedRequest(drive=chance.random() < 0.9, speed=chance.choice((1.0, angle)), deceleration=1.0)
        frames += self.speed.send(self.now, wanted)
        assert len(frames) <= 6
        assert all(len(frame.data) <= 8 and frame.identifier & 0xFF in (*range(128, 248), 254) for frame in frames)
        report = self.valve.report(self.now)
        assert math.isnan(report.angle) or abs(report.angle) < math.pi / 2.0
        assert not (report.engaged and report.readiness is Readiness.SILENT)
        self.speed.report(self.now)


class Sentences:
    """Sentences of the sensor board and of a bare valve's board."""

    def __init__(self) -> None:
        self.valve, self.now = ValveBoard(), 0.0
        hitch = Potentiometer(counts=(0.0, 1024.0, 2048.0, 3072.0, 4096.0), angles=(-1.0, -0.5, 0.0, 0.5, 1.0))
        self.sensors = SensorBoard(hitch, Encoder(pulses_per_metre=100.0))

    def __call__(self, chance: random.Random) -> None:
        """Take one."""
        self.now += 0.02
        fields = [str(chance.choice((0, 1, 2048, 2**32, -1, "", "nan", "1e9", "9" * 80))) for _ in range(3)]
        for reader, kind in ((self.sensors, "PDBS"), (self.valve, "PDBV")):
            body = ",".join([kind, *fields[: chance.randrange(4)]]).encode()
            sentence = b"$" + body + b"*%02X\r\n" % xor(body)
            for piece in pieces(sentence if chance.random() < 0.5 else changed(sentence, chance), chance):
                reader.push(piece, self.now)
        assert len(self.valve.push(b"\r\n" + own_sentence("PDBV", 1, 2, 1), self.now)) >= 1


def records(chance: random.Random) -> None:
    """Records between the processes, those of the operator's socket among them, and datagrams to the recorder."""
    kind = chance.choice(list(KINDS))
    record = struct.pack("<HBB", MARK, VERSION, kind) + chance.randbytes(LAYOUTS[kind].size - 8)
    if chance.random() < 0.3:
        record = changed(record, chance)
    if chance.random() < 0.8:
        record += struct.pack("<I", zlib.crc32(record))
    found = decode(record, *KINDS.values())
    assert isinstance(found, (Flaw, *KINDS.values()))
    unpack(record)
    unpack(changed(record, chance))


class Sections:
    """Device sections of a configuration, written to a file."""

    def __init__(self, path: str) -> None:
        self.path = path
        plain = load_configuration("articulated")
        self.texts = [made.to_toml().encode() for made in (with_stand_ins(plain), with_isobus(plain))]

    def __call__(self, chance: random.Random) -> None:
        """Take one."""
        text = chance.choice(self.texts)
        place = chance.randrange(text.index(b"[devices"), len(text) - 1)
        end = min(place + chance.randrange(1, 200), len(text))
        with open(self.path, "wb") as file:
            file.write(text[:place] + changed(text[place:end], chance) + text[end:])
        try:
            load_configuration(self.path)
        except ConfigurationError:
            return


def fuzz(target: Callable[[random.Random], None], count: int, seed: int) -> str:
    """Fuzz one; return its name, and how long an input took."""
    chance, slowest, name = random.Random(seed), 0.0, getattr(target, "__name__", type(target).__name__)
    begin = last = time.process_time()
    for index in range(1, count + 1):
        try:
            target(chance)
        except Exception as error:
            raise AssertionError(f"{name}: input {index} of seed {seed}") from error
        if index % _BATCH == 0:
            now = time.process_time()
            slowest, last = max(slowest, (now - last) / _BATCH), now
    mean = (time.process_time() - begin) / count
    return (
        f"{name}: {count}, none raised, {mean * 1e6:.0f} µs each with their making; "
        f"slowest hundred {slowest * 1e6:.0f} µs each"
    )


def main(arguments: list[str]) -> None:
    """Fuzz each as often as is asked for; sections, each of which is a file, a thousandth of that."""
    count, seed = int(arguments[0]) if arguments else 100_000, int(arguments[1]) if arguments[1:] else 0
    with tempfile.TemporaryDirectory(prefix="drawbar-fuzz-") as folder:
        print(fuzz(Sections(f"{folder}/machine.toml"), max(count // 1000, 1), seed), flush=True)
    for target in (Rtcm(), caster, Boards(), Nmea2000(), Isobus(), Sentences(), records):
        print(fuzz(target, count, seed), flush=True)


if __name__ == "__main__":
    main(sys.argv[1:])
