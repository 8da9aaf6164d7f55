"""Assembly: messages of one receiver into its epochs.

An epoch ends when a message of another time comes, after 20 ms without a byte, or as soon as all kinds of messages are
there that its predecessors had: 20 ms would be the whole time that a step may take. Where a kind is missing that has
lately come after such a silence, it ends after 60 ms.
"""

import math
from collections import Counter, deque

from drawbar.protocols.gnss.epoch import Epoch
from drawbar.protocols.gnss.messages import Content, Message, Position, Spoofing
from drawbar.protocols.gnss.quality import QualityHold
from drawbar.protocols.gnss.settings import EpochSettings
from drawbar.protocols.gnss.solution import Solution, sigma, solve
from drawbar.protocols.gnss.timing import SAME_EPOCH, ReceiverClock, difference
from drawbar.protocols.gnss.turning import LARGEST_YAW_RATE, Turning
from drawbar.protocols.gnss.values import OLDEST_CORRECTION
from drawbar.signals import FixQuality

SILENCE, LONG_SILENCE = 0.02, 0.06
"""an epoch is over after so long without a byte, s; the longer where a kind is missing that has lately come later"""
_REMEMBERED = 10
"""epochs whose kinds of messages are remembered"""
_AWAITED = 0.3
"""a kind that came in this share of them is waited for, the only position in any case"""
_MOST = 100
"""contents of an epoch; of more, one epoch would be all that comes without a pause and without a new time"""
_FIRST = 3
"""epochs that are ended by time or silence alone, before it is known what to wait for"""
_LATENCY, _LINE_LATENCY = 0.04, 0.01
"""of receiver and line where neither is known: most have 0.01 to 0.08; and of the line alone, s"""
SPOOFED = "epoch of a receiver that reports spoofing"
"""how epochs are counted whose contents are rejected"""
_LEAD = 0.05
"""by which the first epochs may be later than the least delay shows afterwards, s; more is another time of the
receiver's"""


class _Draft:
    """The messages of an epoch that is not closed yet."""

    def __init__(self, received: float) -> None:
        self.received = self.last = received  # of its first and its last message
        self.utc: float | None = None
        self.kinds: set[str] = set()
        self.contents: list[Content] = []

    def takes(self, message: Message) -> bool:
        """Whether a message belongs here; one without a time always does."""
        if message.utc is None or self.utc is None:
            return True
        return abs(difference(message.utc, self.utc)) < SAME_EPOCH

    def add(self, message: Message, time: float) -> None:
        self.last = time
        self.utc = message.utc if self.utc is None else self.utc
        self.kinds.add(message.kind)
        self.contents += message.contents


class Assembler:
    """Collects messages into epochs; `dropped` counts by kind what became of none."""

    dropped: Counter[str]
    frozen: int
    """epochs in a row that came with the time of the one before"""

    def __init__(self, settings: EpochSettings) -> None:
        self.dropped = Counter()
        self.frozen = 0
        self._settings = settings
        self._draft: _Draft | None = None
        self._spoofed = False  # as the receiver has reported last
        self._kinds: deque[set[str]] = deque(maxlen=_REMEMBERED)
        self._positional: set[str] = set()  # kinds that hold a position
        self._late: dict[str, int] = {}
        """kinds that came after a silence, and for how many epochs each is still waited for so long"""
        self._closed = -math.inf  # when the last message of the epoch before came
        self._delivered = -math.inf  # time of the last epoch
        self._start_over()

    def _start_over(self) -> None:
        """Forget the epochs so far, but not what the receiver sends."""
        self._clock, self._located = ReceiverClock(), False
        self._hold = QualityHold(self._settings.quality_hold)
        self._elsewhere: tuple[float, float] | None = None
        """UTC and offset of the epoch before, if that had another time"""
        self._turning = Turning()
        self._last_kinds: set[str] = set()  # of the epoch before
        self._corrected: float | None = None
        """UTC of the corrections, by a message that came after its epoch was closed"""

    @property
    def is_open(self) -> bool:
        """Whether an epoch has begun that is not closed."""
        return self._draft is not None

    @property
    def silence(self) -> float:
        """How long a silence ends the open epoch, s."""
        is_complete = self._draft is None or self._late.keys() <= self._draft.kinds
        return SILENCE if is_complete else LONG_SILENCE

    def add(self, message: Message, time: float) -> list[Epoch]:
        """Take a message whose first byte came at a monotonic time (s); return the epochs that it ends.

        A receiver's report of spoofing holds until its next one: it does not send one in each epoch.
        """
        if told := [content.suspected for content in message.contents if isinstance(content, Spoofing)]:
            self._spoofed = any(told)
            return []
        ended: list[Epoch] = []
        if self._draft is not None and not self._draft.takes(message):
            ended += self.close()
        if self._draft is None:
            self._draft = _Draft(time)
        if time - self._draft.last > SILENCE:
            self._late[message.kind] = _REMEMBERED
        self._draft.add(message, time)
        if any(isinstance(content, Position) for content in message.contents):
            self._positional.add(message.kind)
        complete = len(self._kinds) >= _FIRST and self._draft.utc is not None and self._is_complete(self._draft)
        if complete or len(self._draft.contents) >= _MOST:
            ended += self.close()
        return ended

    def _is_complete(self, draft: _Draft) -> bool:
        counts = Counter(kind for kinds in self._kinds for kind in kinds)
        least = _AWAITED * len(self._kinds)
        awaited = {kind for kind, count in counts.items() if count >= least}
        if not draft.kinds & self._positional:
            awaited |= counts.keys() & self._positional
        return awaited <= draft.kinds

    def close(self) -> list[Epoch]:
        """End the open epoch, after a silence; return it, or nothing where it is none."""
        draft, self._draft = self._draft, None
        if draft is None:
            return []
        if self._is_straggler(draft):
            self.dropped["message without its epoch"] += 1
            self._keep_correction_age(draft)
            if self._kinds:
                self._kinds[-1] |= draft.kinds  # to be waited for
            if draft.received - self._closed <= LONG_SILENCE:
                self._late |= dict.fromkeys(draft.kinds, _REMEMBERED)
            return []
        self._closed = draft.last
        self._late = {kind: left - 1 for kind, left in self._late.items() if left > 1}
        self._kinds.append(draft.kinds)
        if draft.utc is None:
            self.dropped["epoch without time"] += 1
            return []
        epoch = self._checked(draft, draft.utc)
        return [] if epoch is None else [epoch]

    def _keep_correction_age(self, draft: _Draft) -> None:
        """Keep for later epochs how old the corrections were: the message that tells it may come once a second only."""
        ages = [each.correction_age for each in draft.contents if isinstance(each, Position)]
        if draft.utc is not None and ages and math.isfinite(ages[0]):
            self._corrected = draft.utc - ages[0]

    def _correction_age(self, position: Position, utc: float) -> float:
        """Return the age of the corrections in an epoch, s; NaN where it is not known."""
        if math.isfinite(position.correction_age) or self._corrected is None:
            return position.correction_age
        age = difference(utc, self._corrected)
        return age if 0.0 <= age <= OLDEST_CORRECTION else math.nan

    def _is_straggler(self, draft: _Draft) -> bool:
        """Whether messages belong to the epoch that was closed last, and are not that epoch once more."""
        positions = draft.kinds & self._positional
        if draft.utc is None:
            return not positions
        return abs(self._clock.step(draft.utc)) < SAME_EPOCH and not positions & self._last_kinds

    def _checked(self, draft: _Draft, utc: float) -> Epoch | None:
        """Return the epoch, if it follows those before and its deviation is one."""
        step = self._clock.step(utc)
        if abs(step) < SAME_EPOCH:
            self.dropped["epoch repeated"] += 1
            self.frozen += 1
            return None
        if self._spoofed:
            self.dropped[SPOOFED] += 1
            draft.contents = [Position(quality=FixQuality.NONE)]
        solution = solve(draft.contents, self._settings)
        received = draft.received - solution.latency
        if step < 0.0 or self._clock.lead(utc, received) > _LEAD:
            if not draft.kinds & self._positional or not self._goes_on(utc, received):
                self.dropped["epoch out of order" if step < 0.0 else "epoch ahead of its time"] += 1
                return None
            if step < 0.0:
                self.dropped["receiver's clock set back"] += 1
                self._start_over()
        self.frozen, self._elsewhere = 0, None
        self._last_kinds = draft.kinds
        if solution.refused:
            self.dropped[solution.refused] += 1
        if solution.impossible:
            self.dropped["epoch with an impossible deviation"] += 1
            return None
        epoch = self._epoch(draft, utc, solution)
        if epoch.time <= self._delivered:  # one of both has reported another latency
            self.dropped["epoch measured before the last one"] += 1
            return None
        self._delivered = epoch.time
        return epoch

    def _goes_on(self, utc: float, received: float) -> bool:
        """Whether a time in the past, or in the future by those before it, is one that the epoch before this one began.

        Both then came as fast as their times go on: the receiver has set its clock. One wrong time, accepted, would
        make all epochs of the next 60 s seem old, and so would an epoch that comes again, or late.
        """
        before, offset = self._elsewhere, self._clock.offset(utc, received)
        self._elsewhere = (utc, offset)
        return before is not None and difference(utc, before[0]) > SAME_EPOCH and abs(offset - before[1]) <= _LEAD

    def _epoch(self, draft: _Draft, utc: float, solution: Solution) -> Epoch:
        position = solution.position
        if math.isfinite(position.latitude + position.longitude) and not self._located:
            self._clock.forget()  # its offset is learned anew with the first position
            self._located = True
        time = self._measured(utc, draft.received, solution.latency)
        quality = solution.quality
        if quality is not FixQuality.UNKNOWN:  # an attitude alone has no quality of the fix
            quality = self._hold.update(draft.received, quality)
        by_quality = solution.quality if quality is FixQuality.NONE else quality
        east, north = sigma(solution.sigma, by_quality, self._settings.sigma_inflation)
        yaw_rate, age = self._turn(solution, utc)
        return Epoch(
            time=time,
            received=draft.received,
            utc=utc,
            day=solution.day,
            latitude=position.latitude,
            longitude=position.longitude,
            height=position.height,
            quality=quality,
            reported=solution.quality,
            sigma_east=east,
            sigma_north=north,
            resolution=position.resolution,
            speed=solution.velocity.speed,
            course=solution.velocity.course,
            correction_age=self._correction_age(position, utc),
            station=position.station,
            satellites=position.satellites,
            hdop=position.hdop,
            yaw_rate=yaw_rate,
            attitude_age=age,
            **solution.attitude,
        )

    def _measured(self, utc: float, received: float, reported_latency: float) -> float:
        """Return when an epoch was measured, s."""
        usual = _LINE_LATENCY if reported_latency > 0.0 else _LATENCY
        latency = self._settings.latency if self._settings.latency is not None else usual
        return self._clock.measured(utc, received - reported_latency) - latency

    def _turn(self, solution: Solution, utc: float) -> tuple[float, float]:
        """Return the yaw rate of an epoch, rad/s, and its age, s."""
        rate, age = self._turning.rate(solution.yaw_rate, solution.attitude.get("inertial_yaw", math.nan), utc)
        if abs(rate) > LARGEST_YAW_RATE:
            self.dropped["impossible yaw rate"] += 1
            return math.nan, 0.0
        return rate, age
