"""Address claim: how a device gets its address on the bus, defends it and leaves it (ISO 11783-5, J1939-81)."""

import math
from enum import Enum
from random import Random

from drawbar.errors import ConfigurationError
from drawbar.protocols.isobus.identifier import GLOBAL, NULL, Message, encode
from drawbar.protocols.isobus.name import Name
from drawbar.transports.base import CanFrame

CLAIM = 0xEE00
REQUEST = 0xEA00
_CLAIM_BYTES = CLAIM.to_bytes(3, "little")
_SELF_CONFIGURABLE = range(128, 248)
"""addresses that a self-configurable device may move to"""
_LAST_ADDRESS = 253
_WAIT = 0.250
"""from a claim until the address may be used, s"""
_SPREAD = 0.153
"""longest of the random delays that keep devices switched on together apart, s"""
_DUPLICATE_HOLD = 5.0
"""for how long an address is not used to steer after another has used it too, s"""
_DUPLICATE_ANSWER = 1.0
"""a duplicate is answered by a claim no more often than this, s"""


class ClaimState(Enum):
    """How far the claim has come; each with its text for the operator."""

    SILENT = "has not begun"
    LISTENING = "listens for the addresses in use"
    CLAIMING = "has claimed an address and waits for objections"
    CLAIMED = "has its address"
    CANNOT_CLAIM = "cannot have an address: its own is taken by a stronger NAME, and no other is allowed or free"


class AddressClaim:
    """The claim of one device: `receive_message` takes what comes, `send` returns what goes; times are monotonic, s.

    Raises:
        ConfigurationError: the preferred address is none

    """

    def __init__(self, name: Name, preferred: int, seed: int | None = None) -> None:
        if not (0 <= preferred <= _LAST_ADDRESS):
            raise ConfigurationError(
                f"preferred address {preferred}: allowed are 0 to {_LAST_ADDRESS}, 128 to 247 best"
            )
        self.name = name
        self.state = ClaimState.SILENT
        self.address = NULL
        """the address claimed or held, `NULL` while there is none"""
        self.losses = 0
        """how often a claimed address was lost"""
        self.duplicates = 0
        """frames of others that bore our address"""
        self._preferred = preferred
        self._random = Random(name.value if seed is None else seed)
        self._owners: dict[int, int | None] = {}
        """NAME behind each address received, None where only its frames are known; never more than 254"""
        self._until = -math.inf
        self._claim_at = math.inf
        """when a claim or "cannot claim" is to go; inf: none is"""
        self._duplicate_time = -math.inf
        self._duplicate_answer = -math.inf

    @property
    def held(self) -> bool:
        """Whether the address is ours to talk from."""
        return self.state is ClaimState.CLAIMED

    def unique(self, time: float) -> bool:
        """Return whether no other device has recently sent from our address."""
        return not (time - self._duplicate_time <= _DUPLICATE_HOLD)

    def receive_message(self, time: float, message: Message) -> None:
        """Take in one message of another device."""
        if message.pgn == CLAIM and len(message.data) == 8:
            self._receive_claim(time, message.source, int.from_bytes(message.data, "little"))
            return
        if message.source <= _LAST_ADDRESS:
            self._owners.setdefault(message.source, None)
            if message.source == self.address:
                self._receive_duplicate(time)
        if message.pgn == REQUEST and message.data[:3] == _CLAIM_BYTES:
            self._receive_request(time, message.destination)

    def send(self, time: float) -> list[CanFrame]:
        """Return the frames that are due: request, claim, or "cannot claim"."""
        if self.state is ClaimState.SILENT:
            self.state = ClaimState.LISTENING
            self._until = time + _WAIT + self._random.random() * _SPREAD
            return [encode(Message(pgn=REQUEST, source=NULL, destination=GLOBAL, data=_CLAIM_BYTES))]
        if self.state is ClaimState.LISTENING and time >= self._until:
            self._take(time, self._preferred if self._free(self._preferred) else self._other())
        elif self.state is ClaimState.CLAIMING and time >= self._until:
            self.state = ClaimState.CLAIMED
        if time < self._claim_at:
            return []
        self._claim_at = math.inf
        return [encode(Message(pgn=CLAIM, source=self.address, destination=GLOBAL, data=self.name.data))]

    def _receive_claim(self, time: float, address: int, name: int) -> None:
        self._owners = {at: owner for at, owner in self._owners.items() if owner != name}
        if address <= _LAST_ADDRESS:
            self._owners[address] = name
        if self.address == NULL or address != self.address:
            return
        if name == self.name.value:
            # Two devices of one NAME cannot be distinguished: an answer would be answered for ever.
            self.duplicates += 1
            self._duplicate_time = time
        elif name > self.name.value:
            self._claim_at = time
        else:
            self.losses += 1
            self._take(time, self._other())

    def _receive_duplicate(self, time: float) -> None:
        self.duplicates += 1
        self._duplicate_time = time
        if time - self._duplicate_answer >= _DUPLICATE_ANSWER:
            self._duplicate_answer = self._claim_at = time

    def _receive_request(self, time: float, destination: int) -> None:
        if destination not in (GLOBAL, self.address):
            return
        if self.state in (ClaimState.CLAIMING, ClaimState.CLAIMED):
            self._claim_at = time
        elif self.state is ClaimState.CANNOT_CLAIM and self._claim_at == math.inf:
            self._claim_at = time + self._random.random() * _SPREAD

    def _take(self, time: float, address: int) -> None:
        self.address = address
        if address == NULL:
            self.state = ClaimState.CANNOT_CLAIM
            self._claim_at = time + self._random.random() * _SPREAD
        else:
            self.state = ClaimState.CLAIMING
            self._claim_at, self._until = time, time + _WAIT

    def _free(self, address: int) -> bool:
        """Return whether we may claim it: nobody is there, or one whose NAME is weaker."""
        if address not in self._owners:
            return True
        owner = self._owners[address]
        return owner is not None and owner > self.name.value

    def _other(self) -> int:
        """Return the first address to move to, `NULL` where there is none; those in use are left alone."""
        if not self.name.self_configurable:
            return NULL
        return next((address for address in _SELF_CONFIGURABLE if address not in self._owners), NULL)
