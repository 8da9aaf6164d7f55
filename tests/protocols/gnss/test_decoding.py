"""Decoding: golden sentences and frames become what they must; nothing that comes in raises."""

import math
import struct
from collections.abc import Callable
from dataclasses import asdict
from typing import Any

import pytest
from receiver_frames.ubx import frame

from drawbar.machine.stand_in.nmea import sentence
from drawbar.protocols.gnss.checksums import crc_ccitt
from drawbar.protocols.gnss.decoding import Decoder
from drawbar.protocols.gnss.framing import Framer
from drawbar.protocols.gnss.messages import Accuracy, Attitude, InertialAttitude, Message, Position, Spoofing, Velocity
from drawbar.signals import FixQuality


def decoded(data: bytes) -> Message:
    (frame,) = Framer().push(data, 0.0)
    decoder = Decoder()
    message = decoder.decode(frame)
    assert message is not None, decoder.dropped
    return message


def dropped(data: bytes) -> dict[str, int]:
    (frame,) = Framer().push(data, 0.0)
    decoder = Decoder()
    decoder.decode(frame)
    return decoder.dropped


NAMES = {
    "latitude_deg": (Position, "latitude", 1.0),
    "longitude_deg": (Position, "longitude", 1.0),
    "height_ellipsoid_m": (Position, "height", 1.0),
    "altitude_msl_m": (Position, "altitude", 1.0),
    "geoid_separation_m": (Position, "separation", 1.0),
    "satellites": (None, "satellites", 1.0),
    "correction_age_s": (None, "correction_age", 1.0),
    "hdop": (Position, "hdop", 1.0),
    "station": (Position, "station", 1.0),
    "sigma_major_m": (Accuracy, "major", 1.0),
    "sigma_minor_m": (Accuracy, "minor", 1.0),
    "sigma_latitude_m": (Accuracy, "north", 1.0),
    "sigma_longitude_m": (Accuracy, "east", 1.0),
    "sigma_height_m": (Accuracy, "up", 1.0),
    "tilt_deg": (Attitude, "pitch", math.radians(-1.0)),
    "pitch_deg": (Attitude, "pitch", math.radians(-1.0)),
    "roll_deg": (Attitude, "roll", math.radians(1.0)),
    "roll_right_deg": (Attitude, "roll", math.radians(1.0)),
    "baseline_m": (Attitude, "baseline", 1.0),
    "quality_avr": (Attitude, "code", 1.0),
}
"""where a golden value is found, and its scale"""
HEADINGS = {
    "heading_deg": "yaw",
    "course_deg": "course",
    "imu_heading_deg": "yaw",
    "orientation_deg_from_north": "orientation",
}
YAWS = {"yaw_rad": "yaw", "course_yaw_rad": "course"}


def found(message: Message, kind: type | None, field: str) -> Any:
    """Return a field of the message's contents of a kind, or of any content that has it; None: not there or missing."""
    for content in message.contents:
        values = asdict(content)
        if field in values and (kind is None or isinstance(content, kind)):
            value = values[field]
            return None if isinstance(value, float) and math.isnan(value) else value
    return None


QUALITIES = {0: FixQuality.NONE, 4: FixQuality.FIXED, 5: FixQuality.FLOAT}


def check(message: Message, name: str, value: Any) -> None:
    """Compare one golden value with the message."""
    near = lambda number: pytest.approx(number, abs=1e-9)  # noqa: E731
    if name == "utc_s":
        assert message.utc == (value if value is None else near(value))
    elif name in HEADINGS:
        yaw = found(message, None, HEADINGS[name])
        expected = None if value is None else near(0.0)
        assert (None if yaw is None else math.remainder(yaw - math.radians(90.0 - value), 2.0 * math.pi)) == expected
    elif name in ("yaw_rad", "course_yaw_rad"):
        assert found(message, None, YAWS[name]) == near(value)
    elif name.startswith("sigma_") and name.endswith("_deg"):
        pass  # of the attitude: of no use
    elif name == "quality" and message.kind != "HPR":
        assert found(message, Position, "quality") is QUALITIES[value]
        assert found(message, Position, "code") == value
    elif name in ("quality", "mode") and message.kind in ("HPR", "HRP"):
        assert found(message, Attitude, "code") == value
        assert found(message, Attitude, "fixed") is (value in (2, 4))
    elif name == "mode":  # of RMC
        assert (value, found(message, Position, "quality")) == ("R", FixQuality.FIXED)
    elif name == "valid" and message.kind == "RMC":
        assert (found(message, Position, "quality") is not FixQuality.NONE) is value
    elif name == "valid":
        assert found(message, Attitude, "valid") is value
    elif name == "date":
        assert str(found(message, None, "day")) == value
    elif name == "speed_m_s":
        assert found(message, None, "speed") == near(value)
    elif name == "yaw_rate_raw":
        assert found(message, None, "yaw_rate") is None, "what boards send there goes by their firmware"
    elif message.kind == "PANDA" and name in ("roll_right_deg", "pitch_deg"):
        _, field, scale = NAMES[name]
        assert found(message, InertialAttitude, field) == near(value * scale)
    else:
        kind, field, scale = NAMES[name]
        tolerance = 1.5e-10 if "itude_deg" in name else 1e-9  # of the golden file's last digit
        expected = None if value is None else pytest.approx(value * scale, abs=tolerance)
        assert found(message, kind, field) == expected, name


def test_golden_sentences_are_decoded_to_what_they_say(golden: Callable[[str], Any]) -> None:
    sentences = golden("nmea.json")["sentences"]
    assert len(sentences) == 22
    for each in sentences:
        message = decoded(each["sentence"].encode() + b"\r\n")
        assert each["expected"]
        for name, value in each["expected"].items():
            check(message, name, value)


def frames(golden: Callable[[str], Any]) -> dict[str, Message]:
    file = golden("gnss_binary.json")
    read = [each for each in file["ubx"] + file["sbf"] if each["name"] != "AttCovEuler"]  # which is of no use
    return {each["name"]: decoded(bytes.fromhex(each["hex"])) for each in read}


def test_golden_frames_are_of_one_epoch_at_one_place(golden: Callable[[str], Any]) -> None:
    messages = frames(golden)
    assert len(messages) == 10
    assert {round(message.utc or 0.0, 9) for message in messages.values()} == {36930.2}
    for name, tolerance in (("NAV-PVT", 5e-8), ("NAV-HPPOSLLH", 5e-10), ("PVTGeodetic", 5e-11)):
        assert found(messages[name], Position, "latitude") == pytest.approx(50.8768724267, abs=tolerance)
        assert found(messages[name], Position, "longitude") == pytest.approx(4.7020576117, abs=tolerance)
        assert found(messages[name], Position, "height") == pytest.approx(88.018, abs=5e-4)


EXPECTED = {
    "NAV-PVT": {
        "quality": FixQuality.FIXED,
        "satellites": 17,
        "altitude": 42.318,
        "correction_age": 3.5,  # the middle of its class, 2 to 5 s
        "speed": math.hypot(0.045, 0.998),
        "course": math.atan2(0.045, 0.998),
        "east": 0.014 / math.sqrt(2.0),
        "resolution": 1e-7,
    },
    "NAV-HPPOSLLH": {"quality": FixQuality.UNKNOWN, "height": 88.0183, "altitude": 42.3178, "resolution": 1e-9},
    "NAV-RELPOSNED": {
        "yaw": math.radians(90.0 - 124.0),
        "pitch": math.asin(4.2 / 100.08),
        "baseline": 1.0008,
        "fixed": True,
        "valid": True,
    },
    "PVTGeodetic": {
        "quality": FixQuality.FIXED,
        "satellites": 17,
        "station": 123,
        "correction_age": 1.2,
        "east": 0.01 / math.sqrt(8.0),
        "speed": math.hypot(0.045, 0.998),
        "course": math.atan2(0.045, 0.998),
        "seconds": 0.0085,
    },
    "PVTGeodetic no fix": {
        "quality": FixQuality.NONE,
        **dict.fromkeys(
            ("latitude", "longitude", "height", "satellites", "station", "correction_age", "speed", "east")
        ),
        "seconds": None,
    },
    "PosCovGeodetic": {"east": 0.009, "north": 0.01, "up": math.sqrt(3.2e-4), "impossible": False},
    "AttEuler": {
        "yaw": math.radians(90.0 - 123.456),
        "roll": math.radians(2.5),
        "pitch": math.radians(1.25),
        "fixed": True,
        "valid": True,
    },
    "AttEuler no attitude": {"yaw": None, "roll": None, "pitch": None, "fixed": False, "valid": False},
    "BaseVectorGeod one base": {
        "yaw": math.atan2(-0.5612, 0.835),
        "pitch": -math.asin(0.042 / math.hypot(0.835, 0.5612, 0.042)),
        "baseline": math.hypot(0.835, 0.5612, 0.042),
        "fixed": True,
    },
    "BaseVectorGeod N=0": {},
}


@pytest.mark.parametrize("name", EXPECTED)
def test_golden_frames_are_decoded_to_what_they_say(golden: Callable[[str], Any], name: str) -> None:
    message = frames(golden)[name]
    for field, value in EXPECTED[name].items():
        is_number = isinstance(value, float)
        assert found(message, None, field) == (pytest.approx(value, abs=1e-7) if is_number else value), field
    assert bool(message.contents) == bool(EXPECTED[name])


@pytest.mark.parametrize(
    ("body", "kind"),
    [
        ("GNGGA,101530.20,9952.6123456,N,00442.1234567,E,4,17,0.70,42.3,M,45.7,M,1.2,0123", "GGA: impossible field 2"),
        ("GNGGA,101530.20,5052.6123456,N,00442.1234567,E,4,17,nan,42.3,M,45.7,M,1.2,0123", "GGA: impossible HDOP"),
        ("GNGGA,101530.20,5052.6123456,N,00442.1234567,E,4,17,0.7,inf,M,45.7,M,1.2,0123", "GGA: impossible alt"),
        ("GNGGA,256199.20,5052.6123456,N,00442.1234567,E,4,17,0.7,4.1,M,45.7,M,1.2,0123", "GGA: impossible field 1"),
        ("GNGGA,101560.00,5052.6123456,N,00442.1234567,E,4,17,0.7,4.1,M,45.7,M,1.2,0123", "GGA: impossible field 1"),
        ("GNGGA,101530.20,5060.0000000,N,00442.1234567,E,4,17,0.70,42.3,M,45.7,M,1.2,0123", "GGA: impossible field 2"),
        ("GNGGA,101530.20,5052.6123456,X,00442.1234567,E,4,17,0.70,42.3,M,45.7,M,1.2,0123", "GGA: impossible field 2"),
        ("GNGGA,101530.20,5052.6123456,N,00442.1234567,,4,17,0.70,42.3,M,45.7,M,1.2,0123", "GGA: impossible field 4"),
        ("GNGGA,101530.20,-5052.6123456,N,00442.123456,E,4,17,0.70,42.3,M,45.7,M,1.2,0123", "GGA: impossible field 2"),
        ("GNGGA,101530.20,nan,N,00442.1234567,E,4,17,0.70,42.3,M,45.7,M,1.2,0123", "GGA: impossible field 2"),
        (
            "GNGGA,101530.20,5052.6123456,N,00442.1234567,E,4,17,0.70,42.3,M,45.7,M,1e300,0123",
            "GGA: impossible diffAge",
        ),
        ("GNRMC,101530.20,A,5052.6123,N,18000.0001,E,1.944,87.3,221126,,,R,V", "RMC: impossible field 5"),
        ("GNVTG,87.345,T,85.100,M,1e9,N,3.600,K,R", "VTG: impossible sogn"),
        ("GNZDA,101530.20,31,02,2026,00,00", "ZDA: impossible date"),
        ("PSSN,HRP,101530.20,221126,723.4,,2.345,0.120,,0.300,14,2,1.5,E", "HRP: impossible hdg"),
        (
            "PANDA,101530.20,5099.6123456,N,00442.1234567,E,4,17,0.70,42.318,1.2,1.944,1235,-23,12,5",
            "PANDA: impossible field 2",
        ),
        (
            "PANDA,101530.20,5052.6123456,X,00442.1234567,E,4,17,0.70,42.318,1.2,1.944,1235,-23,12,5",
            "PANDA: impossible field 2",
        ),
        ("PANDA,101530.20,5052.6,N,00442.1,E,4,17,0.70,42.318,1.2,1.944,1235,-23,12", "PANDA with 14 fields"),
        ("PAOGI,101530.20,5052.6,N,00442.1,E,4,17,0.7,42.3,M,1.2,s,1.9,K,12.2,T,1,2,3", "PAOGI with 19 fields"),
        ("KSXT,20261122101530.20,4.7", "KSXT with 2 fields"),
        ("PANDA,101530.20,abc,N,00442.1,E,4,17,0.70,42.318,1.2,1.944,1235,-23,12,5", "PANDA: impossible field 2"),
        ("GNGGA,101530.20", "GGA cut short"),
        ("GPGSV,1,1,00", "NMEA of no use"),
        ("PUBX,00,1", "NMEA of no use"),
        ("PSSN,TFM,101530.20", "NMEA of no use"),
    ],
)
def test_what_is_impossible_is_missing_and_counted(body: str, kind: str) -> None:
    (counted,) = [name for name in dropped(sentence(body)) if name.startswith(kind)] or [None]
    assert counted is not None, dropped(sentence(body))


def test_a_speed_of_less_than_nothing_is_none_and_one_of_minus_nothing_is_nothing() -> None:
    assert found(decoded(sentence("GNVTG,87.345,T,,M,-0.1,N,-0.0,K,R")), Velocity, "speed") == 0.0
    assert math.copysign(1.0, found(decoded(sentence("GNVTG,87.345,T,,M,-0.0,N,,K,R")), Velocity, "speed")) == 1.0


def test_half_a_position_is_none() -> None:
    message = decoded(sentence("GNGGA,101530.20,5052.6123456,N,,,4,17,0.70,42.318,M,45.700,M,1.2,0123"))
    assert found(message, Position, "latitude") is None
    assert found(message, Position, "longitude") is None


@pytest.mark.parametrize("code", [3, 6, 7, 8, 9, 42])
def test_other_qualities_than_satellite_fixes_are_none(code: int) -> None:
    message = decoded(sentence(f"GNGGA,101530.20,5052.612345,N,00442.123456,E,{code},17,0.7,42.3,M,45.7,M,1.2,0"))
    assert found(message, Position, "quality") is FixQuality.NONE


@pytest.mark.parametrize(
    ("gst", "impossible", "east"),
    [
        ("8.5,0.011,0.009,12.5,0.010,0.009,0.018", False, 0.009),
        ("8.5,0.011,0.009,90.0,,,0.018", False, 0.011),
        ("8.5,0.011,0.009,0.0,,,0.018", False, 0.009),
        ("8.5,,,,,,", False, None),
        ("8.5,0.011,0.009,12.5,0.010,0.0,0.018", True, 0.0),
        ("8.5,0.011,0.009,12.5,0.010,-0.2,0.018", True, -0.2),
        ("8.5,0.011,0.009,12.5,0.010,inf,0.018", True, -1.0),
        ("8.5,0.011,0.009,12.5,nan,0.010,0.018", True, 0.01),
        ("8.5,0.011,0.009,12.5,0.010,1e308,0.018", True, -1.0),
    ],
)
def test_deviations_that_are_none_are_distinguished_from_missing_ones(
    gst: str, impossible: bool, east: float | None
) -> None:
    message = decoded(sentence(f"GNGST,101530.20,{gst}"))
    assert found(message, Accuracy, "impossible") is impossible
    assert found(message, Accuracy, "east") == (None if east is None else pytest.approx(east))


def block(number: int, body: bytes) -> bytes:
    tail = struct.pack("<HHIH", number, 14 + len(body), 36930200, 2446) + body
    return b"$@" + crc_ccitt(tail).to_bytes(2, "little") + tail


@pytest.mark.parametrize("up", [1e308, math.nan, 0.0])
def test_a_line_to_a_moving_base_that_no_vehicle_has_is_none(up: float) -> None:
    body = struct.pack("<BBBBBBddd", 1, 52, 17, 0, 7, 0, up, 0.0, 0.0) + bytes(24)
    assert dropped(block(4028, body)) == {
        "BaseVectorGeod: impossible base vector": 1,
        **({"BaseVectorGeod: impossible DeltaEast_01": 1} if math.isnan(up) else {}),
    }


def test_a_latency_of_seconds_and_a_speed_of_two_high_components_are_impossible() -> None:
    body = bytearray(struct.pack("<BBddd3f", 4, 0, 0.8, 0.08, 60.0, 45.7, 40.0, 40.0) + bytes(44))
    body[74:76] = (20_000).to_bytes(2, "little")
    assert dropped(block(4007, bytes(body[:82]))) == {
        "PVTGeodetic: impossible Latency": 1,
        "PVTGeodetic: impossible speed": 1,
    }


def test_unknown_messages_and_weeks_that_are_too_long_are_counted() -> None:
    assert dropped(frame(0x0A, 0x04, bytes(40))) == {"UBX of no use": 1}
    assert dropped(frame(0x01, 0x14, b"\0\0\0\0" + b"\xff" * 4 + bytes(28))) == {
        "NAV-HPPOSLLH: impossible time of week": 1
    }
    assert dropped(frame(0x01, 0x07, bytes(84))) == {"NAV-PVT of another version": 1}
    for number, kind in ((4006, "SBF of no use"), (4007, "PVTGeodetic of another version")):
        body = bytes((number & 255, number >> 8, 16, 0)) + bytes(8)
        counts = dropped(b"$@" + crc_ccitt(body).to_bytes(2, "little") + body)
        assert counts == {kind: 1}


def test_a_base_that_stands_tells_no_attitude(golden: Callable[[str], Any]) -> None:
    block = bytearray.fromhex(golden("gnss_binary.json")["sbf"][6]["hex"])
    block[18] = 4  # fixed, not of a moving base
    block[2:4] = crc_ccitt(block[4:]).to_bytes(2, "little")
    assert decoded(bytes(block)).contents == ()


@pytest.mark.parametrize(("revision", "length"), [(0, 84), (1, 88)])
def test_old_receivers_do_not_say_how_accurate_they_are(
    golden: Callable[[str], Any], revision: int, length: int
) -> None:
    block = bytearray.fromhex(golden("gnss_binary.json")["sbf"][0]["hex"])[4:length]
    block[1:4] = bytes((block[1] & 0x1F | revision << 5, length, 0))
    message = decoded(b"$@" + crc_ccitt(block).to_bytes(2, "little") + block)
    assert found(message, Position, "latitude") == pytest.approx(50.8768724267)
    assert found(message, Accuracy, "east") is None
    assert found(message, Accuracy, "impossible") is False


@pytest.mark.parametrize(
    ("index", "place", "byte", "field", "expected"),
    [
        (0, 15, 1, "quality", FixQuality.NONE),  # an error
        (0, 14, 0x84, "quality", FixQuality.NONE),  # two dimensions only
        (0, 14, 10, "quality", FixQuality.NONE),  # precise point positioning
        (0, 14, 5, "quality", FixQuality.FLOAT),
        (3, 15, 1, "valid", False),
        (3, 16, 3, "fixed", False),
        (2, 15, 1, "east", None),
    ],
)
def test_blocks_with_an_error_are_not_believed(
    golden: Callable[[str], Any], index: int, place: int, byte: int, field: str, expected: object
) -> None:
    names = ("PVTGeodetic", "PVTGeodetic no fix", "PosCovGeodetic", "AttEuler", "AttEuler no attitude")
    file = golden("gnss_binary.json")["sbf"][index]
    assert file["name"] == names[index]
    block = bytearray.fromhex(file["hex"])
    block[place] = byte
    block[2:4] = crc_ccitt(block[4:]).to_bytes(2, "little")
    assert found(decoded(bytes(block)), None, field) == expected


def test_leap_seconds_are_a_setting(golden: Callable[[str], Any]) -> None:
    (found_frame,) = Framer().push(bytes.fromhex(golden("gnss_binary.json")["ubx"][0]["hex"]), 0.0)
    message = Decoder(leap_seconds=19).decode(found_frame)
    assert message is not None
    assert message.utc == pytest.approx(36929.2)


@pytest.mark.parametrize(("state", "suspected"), [(0, False), (1, False), (2, True), (3, True)])
def test_a_u_blox_receiver_tells_whether_signals_are_false(state: int, suspected: bool) -> None:
    message = decoded(frame(0x01, 0x03, struct.pack("<IBBBBII", 0, 3, 1, 0, state << 3, 0, 0)))
    assert message.contents == (Spoofing(suspected=suspected),)


@pytest.mark.parametrize(("flags", "suspected"), [(0, False), (1, True), (2, True), (4, False)])
def test_a_septentrio_receiver_tells_whether_signals_are_false(flags: int, suspected: bool) -> None:
    band = struct.pack("<IHBx", 1_575_420_000, 0, 8)
    body = struct.pack("<HHIHBBB3x", 4092, 28, 1000, 2300, 1, 8, flags) + band
    message = decoded(b"$@" + struct.pack("<H", crc_ccitt(body)) + body)
    assert message.contents == (Spoofing(suspected=suspected),)
