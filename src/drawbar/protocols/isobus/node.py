"""Node: one device on the bus: its address, and the components that listen and talk under it."""

from abc import ABC, abstractmethod
from collections import Counter

from drawbar.protocols.isobus.address import AddressClaim
from drawbar.protocols.isobus.identifier import GLOBAL, Message, decode, encode
from drawbar.transports.base import CanFrame


class Component(ABC):
    """What listens to the messages of a bus, and may answer them."""

    @abstractmethod
    def receive_message(self, time: float, message: Message) -> None:
        """Take in one message of any sender and any content; never raises."""

    def frames(self, time: float) -> list[CanFrame]:
        """Return the frames that are due without anybody's asking."""
        return []


class IsobusNode:
    """One address and the components that share it: valves, speeds, heartbeat.

    Whoever owns the bus calls `receive` for each frame and `send` at each tick. Several steering actuators on one bus
    share one node: each is handed every frame, and the first of them passes it on.
    """

    def __init__(self, claim: AddressClaim) -> None:
        self.claim = claim
        self.dropped: Counter[str] = Counter()
        """frames that were no messages of ISO 11783, by kind"""
        self._components: list[Component] = []
        self._carrier: object = None

    def attach(self, component: Component) -> None:
        """Let a component receive what comes."""
        self._components.append(component)

    def receive(self, time: float, frame: CanFrame, carrier: object = None) -> None:
        """Take in one frame; of several `carrier`s that each hand over every frame only the first is listened to."""
        self._carrier = self._carrier or carrier
        if carrier is not self._carrier:
            return
        message = decode(frame)
        if message is None:
            self.dropped["not ISO 11783"] += 1
            return
        self.claim.receive_message(time, message)
        for component in self._components:
            component.receive_message(time, message)

    def send(self, time: float) -> list[CanFrame]:
        """Return the node's own frames that are due: claims, answers, heartbeats."""
        own = self.claim.send(time)
        return own + [frame for component in self._components for frame in component.frames(time)]

    def usable(self, time: float) -> bool:
        """Return whether a machine may be moved from this address: it is ours, and only ours."""
        return self.claim.held and self.claim.unique(time)

    def frame(self, pgn: int, data: bytes, destination: int = GLOBAL, priority: int = 3) -> CanFrame:
        """Return a frame from this node's address, which must be held."""
        return encode(
            Message(pgn=pgn, source=self.claim.address, destination=destination, priority=priority, data=data)
        )
