"""Frames of AgIsoStack++ 509a920c, tapped from its virtual bus, and a NAME that can-j1939 2.0.12 makes too."""

import math
from dataclasses import replace

import pytest

from drawbar.protocols.isobus.address import AddressClaim
from drawbar.protocols.isobus.guidance_messages import (
    MACHINE_INFO,
    SYSTEM_COMMAND,
    ExitReason,
    Intention,
    LimitStatus,
    MachineInfo,
    SystemCommand,
    decode_command,
    decode_machine_info,
    encodable,
    encode_command,
    encode_machine_info,
)
from drawbar.protocols.isobus.identifier import GLOBAL, NULL, Message, decode, encode
from drawbar.protocols.isobus.name import Name
from drawbar.protocols.isobus.tractor_messages import (
    GROUND_SPEED,
    SELECTED_SPEED,
    SELECTED_SPEED_COMMAND,
    WHEEL_SPEED,
    SelectedSpeed,
    SpeedSource,
    WheelOrGroundSpeed,
    WheelStates,
    decode_selected_speed,
    decode_speed,
    decode_speed_command,
    encode_selected_speed,
    encode_speed,
    encode_speed_command,
)
from drawbar.transports.base import CanFrame

NAME = Name(identity=12345, manufacturer=1407, function=29, device_class=1)
COMMANDS = {
    "0CADFF80 B27DFDFFFFFFFFFF": (+12.5, Intention.INTENDED),
    "0CADFF80 807DFCFFFFFFFFFF": (0.0, Intention.NOT_INTENDED),
    "0CADFF1C 807DFDFFFFFFFFFF": (0.0, Intention.INTENDED),
    "0CADFF1C A87DFDFFFFFFFFFF": (+10.0, Intention.INTENDED),
    "0CADFF1C 587DFDFFFFFFFFFF": (-10.0, Intention.INTENDED),
    "0CADFF1C FFFAFDFFFFFFFFFF": (+8031.75, Intention.INTENDED),
    "0CADFF1C 0000FDFFFFFFFFFF": (-8032.0, Intention.INTENDED),
}
"""curvature in 1/km, right positive"""
READY = MachineInfo(
    curvature=12.5e-3,
    locked_out=False,
    ready=True,
    in_position=True,
    reset_required=False,
    limit=LimitStatus.NOT_LIMITED,
    exit_reason=ExitReason.NONE,
    engage_switch=True,
)
LIMITED = replace(READY, limit=LimitStatus.LIMITED_HIGH, exit_reason=ExitReason.COMMAND_TIMEOUT)
INFOS = {"0CACFF80 4E7D140040FFFFFF": READY, "0CACFF80 4E7D144045FFFFFF": LIMITED}
SELECTED = SelectedSpeed(speed=1.49, distance=123.1, source=SpeedSource.NAVIGATION, exit_reason=0, limit=0)


def frame(text: str) -> CanFrame:
    identifier, data = text.split()
    return CanFrame(int(identifier, 16), bytes.fromhex(data))


def message(text: str) -> Message:
    decoded = decode(frame(text))
    assert decoded is not None
    assert encode(decoded) == frame(text)
    return decoded


def test_name_has_the_bits_of_two_independent_stacks() -> None:
    assert NAME.value == 0xA0021D00AFE03039
    assert NAME.data == bytes.fromhex("3930E0AF001D02A0")


def test_request_and_claim_are_the_golden_frames() -> None:
    claim = AddressClaim(NAME, 0x1C)
    assert claim.send(0.0) == [frame("18EAFFFE 00EE00")]
    assert claim.send(0.5) == [frame("18EEFF1C 3930E0AF001D02A0")]


def test_weaker_name_is_answered_and_stronger_name_makes_it_move() -> None:
    claim = AddressClaim(NAME, 0x1C)
    for time in (0.0, 0.5, 1.0):
        claim.send(time)
    claim.receive_message(1.1, message("18EEFF1C 9F86E1AF001D02A0"))
    assert claim.send(1.1) == [frame("18EEFF1C 3930E0AF001D02A0")]
    assert claim.held
    claim.receive_message(1.2, message("18EEFF1C 0100E0AF001D02A0"))
    assert not claim.held
    assert claim.send(1.2) == [frame("18EEFF80 3930E0AF001D02A0")]


@pytest.mark.parametrize(("text", "meaning"), COMMANDS.items())
def test_system_command_is_the_same_in_both_directions(text: str, meaning: tuple[float, Intention]) -> None:
    decoded = message(text)
    assert (decoded.pgn, decoded.priority, decoded.destination) == (SYSTEM_COMMAND, 3, GLOBAL)
    command = decode_command(decoded.data)
    assert command is not None
    assert (-1e3 * command.curvature, command.intention) == (pytest.approx(meaning[0]), meaning[1])
    sent = SystemCommand(curvature=-1e-3 * meaning[0], intention=meaning[1])
    assert encode_command(sent) == decoded.data


@pytest.mark.parametrize(("text", "meaning"), INFOS.items())
def test_machine_info_is_the_same_in_both_directions(text: str, meaning: MachineInfo) -> None:
    decoded = message(text)
    assert (decoded.pgn, decoded.priority) == (MACHINE_INFO, 3)
    assert decode_machine_info(decoded.data) == meaning
    assert encode_machine_info(meaning) == decoded.data


def test_machine_info_of_which_nothing_is_available() -> None:
    decoded = message("0CACFF1C 807DFFE0FFFFFFFF")
    assert decode_machine_info(decoded.data) == MachineInfo(curvature=0.0)
    assert encode_machine_info(MachineInfo(curvature=0.0)) == decoded.data


def test_wheel_speed_is_the_same_in_both_directions() -> None:
    decoded = message("0CFE4880 DC0540E201000315")
    speed = WheelOrGroundSpeed(speed=1.5, distance=pytest.approx(123.456))
    states = WheelStates(key_on=True, operations=True, reversed_by_operator=False, power_time=180.0)
    assert (decoded.pgn, decoded.source) == (WHEEL_SPEED, 0x80)
    assert decode_speed(decoded.data) == speed
    assert encode_speed(WheelOrGroundSpeed(speed=1.5, distance=123.456), states) == decoded.data


def test_ground_speed_in_reverse_is_negative() -> None:
    decoded = message("0CFE4980 C80578E00100FFFC")
    assert decoded.pgn == GROUND_SPEED
    assert decode_speed(decoded.data) == WheelOrGroundSpeed(speed=-1.48, distance=123.0)
    assert encode_speed(WheelOrGroundSpeed(speed=-1.48, distance=123.0)) == decoded.data


def test_selected_speed_is_the_same_in_both_directions() -> None:
    decoded = message("0CF02280 D205DCE00100C009")
    assert decoded.pgn == SELECTED_SPEED
    read = decode_selected_speed(decoded.data)
    assert read is not None
    assert (read.speed, read.source, read.exit_reason, read.limit) == (1.49, SpeedSource.NAVIGATION, 0, 0)
    assert read.distance == pytest.approx(123.1)
    assert encode_selected_speed(SELECTED) == decoded.data


def test_selected_speed_command_is_the_same_in_both_directions() -> None:
    decoded = message("0CFD4380 DC05B80BFFFFFFFD")
    assert decoded.pgn == SELECTED_SPEED_COMMAND
    assert encode_speed_command(1.5, 3.0) == decoded.data
    assert decode_speed_command(decoded.data) == (1.5, 3.0)


def test_errors_and_what_is_not_available_become_nan() -> None:
    for raw in ("FFFB", "00FE", "FFFF"):
        info = decode_machine_info(bytes.fromhex(raw + "140040FFFFFF"))
        speed = decode_speed(bytes.fromhex(raw + "FFFFFFFFFF15"))
        assert info is not None
        assert speed is not None
        assert math.isnan(info.curvature)
        assert math.isnan(speed.speed)
        assert math.isnan(speed.distance)


def test_speed_without_a_direction_is_known_only_at_rest() -> None:
    for tail in ("02", "03"):
        moving, resting = (decode_speed(bytes.fromhex(raw + "00000000FF" + tail)) for raw in ("E803", "0000"))
        assert moving is not None
        assert resting is not None
        assert math.isnan(moving.speed)
        assert resting.speed == 0.0


def test_a_curvature_that_does_not_fit_is_refused() -> None:
    assert encodable(8.032)
    assert not any(map(encodable, (8.033, -8.0323, math.nan, math.inf)))
    with pytest.raises(ValueError, match="does not fit"):
        encode_command(SystemCommand(curvature=9.0, intention=Intention.INTENDED))


def test_null_address_asks_and_peer_groups_carry_their_destination() -> None:
    assert message("18EAFFFE 00EE00").source == NULL
    assert message("0CAD2680 B27DFDFFFFFFFFFF").destination == 0x26
    assert message("09F8011C D431531E207ACD02").pgn == 129025
