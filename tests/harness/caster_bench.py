"""A client of a caster on a clock that only the test moves."""

from collections.abc import Callable
from random import Random

from waiting import FakeClock, until

from drawbar.machine.hardware.corrections.client import CorrectionsClient
from drawbar.machine.hardware.corrections.credentials import Login
from drawbar.machine.hardware.corrections.settings import CorrectionsSettings
from drawbar.machine.hardware.corrections.status import CorrectionsState, CorrectionsStatus
from drawbar.protocols.ntrip import gga_sentence
from drawbar.protocols.rtcm import RtcmFramer

LOGIN = "farmer:s3cret"
GGA = gga_sentence(
    time_of_day=43200.0,
    latitude=0.888,
    longitude=0.082,
    quality=4,
    satellites=20,
    dilution=0.7,
    height=50.0,
    separation=45.0,
)
FAST = 0.005
"""between the epochs of casters here, s"""


class Bench:
    """A client with a clock that only the test moves, and all bytes that came out of it."""

    def __init__(self, port: int, *, login: str = LOGIN, **settings: object) -> None:
        given = {"host": "127.0.0.1", "port": port, "mount": "MP1"} | settings
        self.clock = FakeClock()
        self.client = CorrectionsClient(CorrectionsSettings.model_validate(given), Login(login), Random(0))
        self.stream = bytearray()

    def advance(self) -> None:
        self.stream += self.client.advance(self.clock.now)

    def until(self, seen: Callable[[], object]) -> None:
        def look() -> object:
            self.advance()
            return seen()

        until(look)

    def until_state(self, state: CorrectionsState) -> None:
        self.until(lambda: self.status.state is state)

    @property
    def status(self) -> CorrectionsStatus:
        return self.client.status(self.clock.now)

    @property
    def frames(self) -> list[bytes]:
        return RtcmFramer().feed(bytes(self.stream))
