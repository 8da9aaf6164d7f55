"""Claiming, defending, leaving and losing an address; two devices at once, both outcomes."""

from collections.abc import Callable

import pytest

from drawbar.errors import ConfigurationError
from drawbar.protocols.isobus.address import CLAIM, REQUEST, AddressClaim, ClaimState
from drawbar.protocols.isobus.identifier import GLOBAL, NULL, Message, decode
from drawbar.protocols.isobus.name import Name
from drawbar.transports.base import CanFrame

ASKED = bytes.fromhex("00EE00")


def name(identity: int, *, movable: bool = True) -> Name:
    return Name(identity=identity, manufacturer=1407, function=29, device_class=1, self_configurable=movable)


def claimed(identity: int = 100, *, movable: bool = True, address: int = 0x90) -> AddressClaim:
    claim = AddressClaim(name(identity, movable=movable), address)
    for tick in range(100):
        claim.send(tick * 0.01)
    assert claim.held
    return claim


def claim_of(other: Name, address: int) -> Message:
    return Message(pgn=CLAIM, source=address, data=other.data)


def play(
    claims: list[AddressClaim], until: float, starts: tuple[float, ...] = (0.0, 0.0)
) -> list[tuple[float, CanFrame]]:
    """Let devices share a bus; return what was on it."""
    bus = []
    for tick in range(round(until / 0.01)):
        time = tick * 0.01
        for claim, start in zip(claims, starts, strict=True):
            for frame in claim.send(time) if time >= start else []:
                bus.append((time, frame))
                message = decode(frame)
                assert message is not None
                for other in claims:
                    if other is not claim:
                        other.receive_message(time, message)
    return bus


def test_address_is_held_only_after_listening_and_waiting() -> None:
    claim = AddressClaim(name(1), 0x90)
    sent = {}
    for tick in range(1000):
        for frame in claim.send(tick * 0.001):
            sent[frame.identifier] = tick * 0.001
        if claim.held:
            break
    assert list(sent) == [0x18EAFFFE, 0x18EEFF90]
    assert 0.250 <= sent[0x18EEFF90] <= 0.250 + 0.153 + 0.001
    assert tick * 0.001 - sent[0x18EEFF90] >= 0.250


@pytest.mark.parametrize("starts", [(0.0, 0.0), (0.0, 1.5), (1.5, 0.0), (0.0, 0.6)])
def test_of_two_that_want_one_address_the_smaller_name_keeps_it(starts: tuple[float, ...]) -> None:
    strong, weak = AddressClaim(name(1), 0x90), AddressClaim(name(2), 0x90)
    play([strong, weak], 4.0, starts)
    assert (strong.address, strong.state) == (0x90, ClaimState.CLAIMED)
    assert (weak.address, weak.state) == (0x80, ClaimState.CLAIMED)


@pytest.mark.parametrize("starts", [(0.0, 0.0), (0.0, 1.5), (1.5, 0.0)])
def test_loser_that_may_not_move_says_so_and_is_silent(starts: tuple[float, ...]) -> None:
    strong, weak = (AddressClaim(name(identity, movable=False), 0x90) for identity in (1, 2))
    bus = play([strong, weak], 4.0, starts)
    assert strong.held
    assert (weak.address, weak.state) == (NULL, ClaimState.CANNOT_CLAIM)
    farewell = CanFrame(0x18EEFFFE, weak.name.data)
    times = [time for time, frame in bus if frame == farewell]
    assert len(times) == 1
    assert not any(frame.data == weak.name.data for time, frame in bus if time > times[0])


def test_loser_moves_past_addresses_in_use() -> None:
    claim = claimed()
    claim.receive_message(1.0, claim_of(name(5), 128))
    claim.receive_message(1.0, Message(pgn=0xFE48, source=129, data=bytes(8)))
    claim.receive_message(1.0, claim_of(name(1), 0x90))
    assert claim.address == 130
    assert not claim.held
    claim.send(1.0)
    claim.send(1.2)
    assert not claim.held
    claim.send(1.26)
    assert claim.held


def test_nothing_is_claimed_where_all_addresses_are_taken() -> None:
    claim = claimed()
    for address in range(128, 248):
        claim.receive_message(1.0, Message(pgn=0xFE48, source=address, data=bytes(8)))
    claim.receive_message(1.0, claim_of(name(1), 0x90))
    assert claim.state is ClaimState.CANNOT_CLAIM


@pytest.mark.parametrize("destination", [GLOBAL, 0x90])
def test_request_is_answered_within_a_quarter_of_a_second(destination: int) -> None:
    claim = claimed()
    claim.receive_message(2.0, Message(pgn=REQUEST, source=0x20, destination=destination, data=ASKED))
    assert claim.send(2.0) == [CanFrame(0x18EEFF90, claim.name.data)]
    assert claim.send(2.1) == []


def test_request_to_another_is_left_to_it() -> None:
    claim = claimed()
    claim.receive_message(2.0, Message(pgn=REQUEST, source=0x20, destination=0x91, data=ASKED))
    assert claim.send(2.3) == []


def test_request_is_answered_without_an_address_too() -> None:
    claim = claimed(movable=False)
    claim.receive_message(2.0, claim_of(name(1, movable=False), 0x90))
    claim.send(2.3)
    claim.receive_message(3.0, Message(pgn=REQUEST, source=0x20, data=ASKED))
    assert claim.send(3.16) == [CanFrame(0x18EEFFFE, claim.name.data)]


@pytest.mark.parametrize("claims_too", [False, True])
def test_another_that_uses_our_address_is_seen_and_told_to_go(claims_too: bool) -> None:
    claim = claimed()
    other = claim_of(claim.name, 0x90) if claims_too else Message(pgn=0xFE48, source=0x90, data=bytes(8))
    assert claim.unique(2.0)
    for tick in range(10):
        claim.receive_message(2.0 + 0.1 * tick, other)
        sent = claim.send(2.0 + 0.1 * tick)
        # Two of one NAME that answered one another would do so for ever.
        assert bool(sent) == (tick == 0 and not claims_too)
    assert claim.duplicates == 10
    assert claim.held
    assert not claim.unique(6.0)
    assert claim.unique(8.0)


def test_a_flood_of_claims_is_answered_once_each_tick() -> None:
    claim = claimed()
    for identity in range(1000, 3000):
        claim.receive_message(2.0, claim_of(name(identity), 0x90))
    assert len(claim.send(2.0)) == 1


def test_delays_differ_between_names_and_repeat_for_one() -> None:
    def claim_time(identity: int) -> int:
        claim = AddressClaim(name(identity), 0x90)
        return next(tick for tick in range(1000) if any(f.identifier == 0x18EEFF90 for f in claim.send(tick * 1e-3)))

    assert claim_time(1) == claim_time(1)
    assert len({claim_time(identity) for identity in range(10)}) > 5


@pytest.mark.parametrize(
    ("make", "text"),
    [
        (lambda: AddressClaim(name(1), 254), "preferred address 254"),
        (lambda: name(1 << 21), "identity is 2097152"),
        (lambda: Name(identity=-1, manufacturer=0, function=0), "identity is -1"),
    ],
)
def test_what_does_not_fit_is_refused(make: Callable[[], object], text: str) -> None:
    with pytest.raises(ConfigurationError, match=text):
        make()
