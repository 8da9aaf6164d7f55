"""Session, one connection to a caster: request, answer, position upload and stream, until it fails. No call waits."""

import math
import ssl
from collections import Counter

from drawbar import __version__
from drawbar.machine.hardware.corrections.credentials import Login
from drawbar.machine.hardware.corrections.settings import CorrectionsSettings
from drawbar.machine.hardware.corrections.status import CorrectionsState
from drawbar.protocols.ntrip import Answer, ReplyReader, ntrip_request
from drawbar.protocols.rtcm import RtcmFramer, RtcmStatus
from drawbar.transports.connection import Connection, Phase

ATTEMPT = 10.0
"""from looking up the name to the caster's answer, s"""
PATIENCE = 60.0
"""a stream may be silent for so long while the caster may be waiting for a position that the receiver lacks, s"""
AT_ONCE = 4096
"""bytes taken at a time, 50 times a second: a hundred times what corrections are, and soon read whatever they are"""
_REFUSALS = (0, *range(400, 500))
"""codes of a request that a caster refuses; with 5xx it is in trouble itself; 0: it reports none"""
_PAGES = (Answer.REDIRECT, Answer.NONSENSE)
"""of a modem or a network, in a caster's place"""
_ADVICE = {
    Answer.SOURCE_TABLE: "check devices.corrections.mount",
    Answer.NO_MOUNT: "check devices.corrections.mount",
    Answer.NO_LOGIN: "check what devices.corrections.credentials leads to",
    Answer.REFUSED: "check corrections.version, and ask the caster's operator",
    Answer.REDIRECT: "see whether the modem or its network asks for a login, else check devices.corrections.host",
    Answer.NONSENSE: "check devices.corrections.host, port and tls",
}


class Session:
    """One attempt and what came of it. Monotonic times, s."""

    def __init__(
        self,
        settings: CorrectionsSettings,
        login: Login,
        tls: ssl.SSLContext | None,
        status: RtcmStatus,
        dropped: Counter[str],
        now: float,
    ) -> None:
        self.state = CorrectionsState.CONNECTING
        self.failure = ""
        """why it is over, in words"""
        self.refused = False
        """only the operator can mend it: the caster has understood the request, and does not grant it"""
        self.received = 0
        self.uploads = 0
        self.began_to_flow = math.inf
        """when the first intact frame came"""
        self._settings, self._login, self._status = settings, login, status
        self._connection = Connection(settings.host, settings.port, tls, most=AT_ONCE)
        self._reader = ReplyReader()
        self._framer = RtcmFramer(dropped)
        self._deadline = now + ATTEMPT
        """of the answer, then of the next byte"""
        self._frame_deadline = math.inf
        """of the next intact frame"""
        self._uploaded = -math.inf

    def fileno(self) -> int:
        """Return the descriptor to wait on, -1 while there is none."""
        return self._connection.fileno()

    def close(self) -> None:
        """Give the socket back."""
        self._connection.close()

    def advance(self, now: float, position: bytes) -> bytes:
        """Do what can be done now, and return the corrections that came; `failure` is set when it is over."""
        phase = self._connection.advance()
        if phase is Phase.OPEN and self.state is CorrectionsState.CONNECTING:
            self._ask(position)
        data = self._connection.read() if self.state is not CorrectionsState.CONNECTING else b""
        stream = self._take(now, self._reader.feed(data)) if data else b""
        if self._flows or self.state is CorrectionsState.LISTENING:
            self._upload(now, position)
        self._end(now)
        return stream

    @property
    def _flows(self) -> bool:
        return self.state is CorrectionsState.FLOWING

    def _ask(self, position: bytes) -> None:
        request = ntrip_request(
            mount=self._settings.mount,
            host=self._settings.host,
            port=self._settings.port,
            agent=f"drawbar/{__version__}",
            version=self._settings.version,
            login=self._login.text,
            position=position,
        )
        self.state = CorrectionsState.ASKING
        self._send(request)
        if self._settings.version == 1 and position:
            self._send(position)  # some casters of version 1 answer only then; after the answer it is sent again

    def _take(self, now: float, stream: bytes) -> bytes:
        """Go on after bytes came, of which `stream` are the stream's."""
        answer = self._reader.answer
        if answer is None:
            return b""
        if answer is not Answer.STREAM:
            self.refused = self._reader.code in _REFUSALS if answer is Answer.REFUSED else answer not in _PAGES
            if self._reader.code:
                self.failure = f"the caster {answer.value} ({self._reader.code}); {_ADVICE[answer]}"
            else:
                self.failure = f"the caster {answer.value}; {_ADVICE[answer]}"
            return b""
        if self.state is CorrectionsState.ASKING:
            self.state = CorrectionsState.LISTENING
            self._deadline = now + PATIENCE
            self._frame_deadline = now + PATIENCE
        if stream:
            self._deadline = now + self._settings.silence
            self._frame_deadline = min(self._frame_deadline, self._deadline)
        self.received += len(stream)
        return self._corrections(now, stream)

    def _corrections(self, now: float, stream: bytes) -> bytes:
        """Return the intact frames that these bytes complete; anything else could be a command for a receiver."""
        frames = self._framer.feed(stream)
        for frame in frames:
            self._status.take(now, frame)
        if frames:
            self._frame_deadline = now + self._settings.silence
            if not self._flows:
                self.state, self.began_to_flow = CorrectionsState.FLOWING, now
        return b"".join(frames)

    def _upload(self, now: float, position: bytes) -> None:
        """Send the position at once and then every so often; from the first one on the stream must not be silent."""
        if not position or now - self._uploaded < self._settings.upload:
            return
        if self._uploaded == -math.inf:
            self._deadline = min(self._deadline, now + self._settings.silence)
            self._frame_deadline = min(self._frame_deadline, now + self._settings.silence)
        self._uploaded = now
        self.uploads += 1
        self._send(position)

    def _send(self, data: bytes) -> None:
        if self._connection.write(data) < len(data) and not self.failure:
            self.failure = self._connection.trouble or "the caster takes no bytes"

    def _end(self, now: float) -> None:
        """Find out whether it is over, unless that is known."""
        if self.failure:
            return
        name = f"{self._settings.host}:{self._settings.port}"
        if self._connection.phase is Phase.CLOSED:
            self.failure = f"the caster {name}: {self._connection.trouble}"
        elif self._reader.ended:
            self.failure = f"the caster {name} has ended the stream"
        elif now >= self._deadline:
            self.failure = f"the caster {name}: {self._silence()}"
        elif now >= self._frame_deadline:
            self.failure = (
                f"the caster {name} sends bytes, but no intact frame of RTCM 3; check devices.corrections.mount"
            )

    def _silence(self) -> str:
        """Return what the silence means, in the words of the state it befell."""
        if self.state is CorrectionsState.CONNECTING:
            return f"no connection within {ATTEMPT:g} s while {self._connection.phase.value}"
        if self.state is CorrectionsState.ASKING:
            return f"no answer within {ATTEMPT:g} s"
        if not self.received and self._uploaded == -math.inf:
            return f"no byte for {PATIENCE:g} s; it may be waiting for a position, and the receiver has no fix"
        return f"no byte for {self._settings.silence:g} s"
