"""The corrections as a whole: login, client and the outlets of one section of the configuration."""

import time

from drawbar.errors import DrawbarError
from drawbar.machine.hardware.corrections.client import CorrectionsClient
from drawbar.machine.hardware.corrections.credentials import read_login
from drawbar.machine.hardware.corrections.forwarding import PacedOutlet, StreamOutlet
from drawbar.machine.hardware.corrections.settings import CorrectionsSettings
from drawbar.machine.hardware.corrections.status import CorrectionsStatus
from drawbar.transports.clock import Clock
from drawbar.transports.open import open_transport

Outlet = StreamOutlet | PacedOutlet


class Corrections:
    """A client and where its bytes go. Call `advance` every 20 ms; times are monotonic, s."""

    def __init__(self, client: CorrectionsClient, outlets: tuple[Outlet, ...] = ()) -> None:
        self.client, self.outlets = client, outlets

    def position(self, sentence: bytes) -> bool:
        """Take the receiver's latest GGA sentence, and return whether it is one with a fix."""
        return self.client.position(sentence)

    def advance(self, now: float) -> bytes:
        """Receive, forward to the outlets, and return what came for receivers that the caller writes to itself."""
        data = self.client.advance(now)
        for outlet in self.outlets:
            outlet.advance(now, data)
        return data

    def status(self, now: float) -> CorrectionsStatus:
        """Return what is known now."""
        return self.client.status(now)

    def close(self) -> None:
        """Give all sockets and lines back."""
        self.client.close()
        for outlet in self.outlets:
            outlet.transport.close()


def open_corrections(settings: CorrectionsSettings, clock: Clock = time.monotonic) -> Corrections:
    """Make the corrections of a section of the configuration; they connect with the first `advance`.

    Raises:
        ConfigurationError: credentials or the certificate are not where they should be, or others may read them.
        HardwareError: a UDP port is taken.
    """
    client = CorrectionsClient(settings, read_login(settings.credentials))
    return Corrections(client, _outlets(settings.forward, clock))


def _outlets(forward: tuple[str, ...], clock: Clock) -> tuple[Outlet, ...]:
    outlets: list[Outlet] = []
    try:
        for text in forward:
            transport = open_transport(text, clock)
            outlets.append(PacedOutlet(transport) if text.startswith("udp:") else StreamOutlet(transport))
    except DrawbarError:
        for outlet in outlets:
            outlet.transport.close()
        raise
    return tuple(outlets)
