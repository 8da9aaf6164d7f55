"""The NTRIP client: one session after another, with pauses that no caster bans, and what is known of the stream."""

import math
import ssl
from collections import Counter
from random import Random

from drawbar.errors import ConfigurationError
from drawbar.machine.hardware.corrections.credentials import Login
from drawbar.machine.hardware.corrections.pauses import Pauses
from drawbar.machine.hardware.corrections.session import Session
from drawbar.machine.hardware.corrections.settings import CorrectionsSettings
from drawbar.machine.hardware.corrections.status import CorrectionsState, CorrectionsStatus
from drawbar.protocols.ntrip import upload_of
from drawbar.protocols.rtcm import RtcmStatus

LASTED = 60.0
"""a stream that flowed for so long was a good one: the next pause is the shortest again, s"""


class CorrectionsClient:
    """A client that `advance` drives, every 20 ms or when `fileno` can be read. All times are monotonic, s."""

    def __init__(self, settings: CorrectionsSettings, login: Login, chance: Random | None = None) -> None:
        """Prepare; raises ConfigurationError where `settings.certificate` is no file of certificates."""
        self._settings, self._login = settings, login
        self._tls = _context(settings.certificate) if settings.tls else None
        self._pauses = Pauses(chance or Random())
        self._session: Session | None = None
        self._next = -math.inf
        """when the next attempt begins"""
        self._failure = ""
        """of the last session; empty again when corrections flow"""
        self._worked = False
        """corrections have come from this mount point: a refusal is the caster's trouble, and no mistake of ours"""
        self._position = b""
        self._attempts = self._received = self._uploads = 0
        self._rtcm = RtcmStatus()
        self._dropped: Counter[str] = Counter()

    def fileno(self) -> int:
        """Return the descriptor to wait on, -1 while there is none."""
        return self._session.fileno() if self._session else -1

    def position(self, sentence: bytes) -> bool:
        """Take the receiver's latest GGA sentence for the caster, and return whether it is one with a fix.

        While there is no fix the last one with a fix continues to be sent: a network needs to know where we are.
        """
        upload = upload_of(sentence)
        self._position = upload or self._position
        return bool(upload)

    def advance(self, now: float) -> bytes:
        """Do what can be done now, and return the corrections that came, unchanged, from an intact frame's start on."""
        if self._session is None:
            if now < self._next:
                return b""
            self._attempts += 1
            self._session = Session(self._settings, self._login, self._tls, self._rtcm, self._dropped, now)
        session = self._session
        stream = session.advance(now, self._position)
        if session.failure:
            self._pause(now, session)
        elif session.state is CorrectionsState.FLOWING:
            self._failure, self._worked = "", True
        return stream

    def status(self, now: float) -> CorrectionsStatus:
        """Return what is known now."""
        session = self._session
        pause = max(0.0, self._next - now) if session is None and self._attempts else 0.0
        return CorrectionsStatus(
            state=session.state if session else CorrectionsState.WAITING,
            failure=self._failure,
            next_attempt=pause,
            attempts=self._attempts,
            received=self._received + (session.received if session else 0),
            uploads=self._uploads + (session.uploads if session else 0),
            types=dict(self._rtcm.types),
            observation_age=self._rtcm.observation_age(now),
            station=self._rtcm.station,
            dropped=dict(self._dropped),
        )

    def close(self) -> None:
        """Close the connection."""
        if self._session:
            self._session.close()
            self._received += self._session.received
            self._uploads += self._session.uploads
            self._session = None

    def _pause(self, now: float, session: Session) -> None:
        if now - session.began_to_flow >= LASTED:
            self._pauses.settled()
        self._failure = session.failure
        self._next = now + self._pauses.after_failure(session.refused and not self._worked)
        self.close()


def _context(certificate: str) -> ssl.SSLContext:
    try:
        return ssl.create_default_context(cafile=certificate or None)
    except (OSError, ssl.SSLError) as error:
        reason = "holds no certificate" if isinstance(error, ssl.SSLError) else error.strerror
        raise ConfigurationError(
            f"devices.corrections.certificate: {certificate} {reason}; give a PEM file, or leave it out"
        ) from None
