"""Lines of receivers on which anything happens: what comes out is sane, counted, in order, and right again afterwards.

A short run from fixed seeds; DRAWBAR_FUZZ_LINES=1000 makes it so many lines of each dialect, each run twice.
"""

import math
import os
import random
from itertools import pairwise

import pytest
from hostile_frames import altered, corpus
from receiver_frames import nmea
from receiver_lines import (
    BEGINS,
    DELAY,
    DIALECTS,
    INTERVAL,
    LONGITUDE,
    MISHAPS,
    STEP,
    TURN,
    Burst,
    delay,
    index_of,
    line,
)

from drawbar.protocols.gnss.decoding import Decoder
from drawbar.protocols.gnss.epoch import Epoch
from drawbar.protocols.gnss.framing import Framer, Protocol
from drawbar.protocols.gnss.settings import EpochSettings
from drawbar.protocols.gnss.stream import EpochStream
from drawbar.protocols.gnss.turning import LARGEST_YAW_RATE
from drawbar.signals import FixQuality

LINES = int(os.environ.get("DRAWBAR_FUZZ_LINES", "4"))
LATENCY = 0.04
"""that is taken where it is not set, s"""


def run(bursts: list[Burst], cuts: random.Random | None = None) -> tuple[list[Epoch], EpochStream]:
    """Return the epochs of a line whose bursts come whole, or cut anywhere."""
    stream, epochs = EpochStream(EpochSettings()), list[Epoch]()
    for burst in bursts:
        while stream.due <= burst.time:
            epochs += stream.poll(stream.due)
        data = b"".join(burst.frames)
        places = sorted(cuts.randrange(len(data) + 1) for _ in range(cuts.randrange(9))) if cuts else []
        for begin, end in pairwise([0, *places, len(data)]):
            epochs += stream.push(data[begin:end], burst.time)
    while stream.due < math.inf:
        epochs += stream.poll(stream.due)
    return epochs, stream


def within(value: float, low: float, high: float) -> bool:
    """Whether a value is missing or in a range."""
    return math.isnan(value) or low <= value <= high


def assert_sane(epoch: Epoch) -> None:
    """Assert that nothing in an epoch is what no receiver can have measured."""
    if epoch.has_fix:
        assert abs(epoch.latitude) <= 90.0
        assert abs(epoch.longitude) <= 180.0
        assert epoch.reported is not FixQuality.NONE
        assert all(0.01 <= sigma < 2e6 for sigma in (epoch.sigma_east, epoch.sigma_north))
    assert math.copysign(1.0, epoch.speed) > 0.0 or math.isnan(epoch.speed)
    assert within(epoch.speed, 0.0, 50.0)
    assert within(epoch.correction_age, 0.0, 3600.0)
    assert all(within(angle, -math.pi, math.pi) for angle in (epoch.course, epoch.yaw, epoch.inertial_yaw))
    assert all(within(angle, -math.pi / 2.0, math.pi / 2.0) for angle in (epoch.roll, epoch.pitch))
    assert within(epoch.yaw_rate, -LARGEST_YAW_RATE, LARGEST_YAW_RATE)
    assert 0.0 <= epoch.received - epoch.time < 10.0
    assert 0.0 <= epoch.utc < 86_401.0


def assert_right(epoch: Epoch) -> None:
    """Assert that an epoch with a fix is what was true."""
    index = index_of(epoch.longitude)
    assert epoch.longitude == pytest.approx(LONGITUDE + STEP * index, abs=1e-7)
    assert -0.055 < epoch.time - (100.0 + INTERVAL * index + DELAY - LATENCY) < 0.01
    assert within(epoch.yaw - TURN * (index - 60), -1e-3, 1e-3)


@pytest.mark.parametrize("dialect", DIALECTS)
@pytest.mark.parametrize("seed", range(LINES))
def test_whatever_happens_on_a_line_its_epochs_are_sane_and_right_again_afterwards(dialect: str, seed: int) -> None:
    chance = random.Random(f"{dialect} {seed}")
    bursts = line(DIALECTS[dialect], chance, begin=chance.choice(BEGINS), mishaps=MISHAPS)
    epochs, stream = run(bursts)
    again, other = run(bursts, chance)
    assert repr(again) == repr(epochs), "it matters how the bytes are cut"
    assert (other.dropped, other.kinds) == (stream.dropped, stream.kinds)
    for epoch in epochs:
        assert_sane(epoch)
    for before, after in pairwise(epochs):
        assert after.time > before.time
    whole = [burst for burst in bursts if not burst.mishap]
    assert stream.kinds.total() >= sum(len(burst.frames) for burst in whole)
    assert len(epochs) + stream.dropped.total() >= sum(bool(burst.frames) for burst in bursts)
    for epoch in epochs[-15:]:
        assert epoch.has_fix
        assert epoch.quality is FixQuality.FIXED
        assert_right(epoch)
    assert [index_of(epoch.longitude) for epoch in epochs[-15:]] == list(range(45, 60))


@pytest.mark.parametrize("dialect", DIALECTS)
def test_no_epoch_of_a_line_that_is_only_late_is_lost_or_wrong(dialect: str) -> None:
    chance = random.Random(dialect)
    epochs, stream = run(line(DIALECTS[dialect], chance, begin=BEGINS[1], mishaps=(delay,), share=0.8))
    assert [index_of(epoch.longitude) for epoch in epochs] == list(range(60))
    for epoch in epochs:
        assert_right(epoch)
    assert not +stream.dropped


@pytest.mark.parametrize("seed", range(LINES))
def test_a_frame_that_tells_nothing_is_counted(seed: int) -> None:
    chance = random.Random(seed)
    frames = corpus(chance)
    for _ in range(400):
        framer, decoder = Framer(), Decoder()
        for frame in framer.push(altered(chance.choice(frames), chance), 0.0):
            message = decoder.decode(frame)
            assert message is not None or decoder.dropped.total() or frame.protocol is Protocol.RTCM


@pytest.mark.parametrize("frame", [nmea.sentence("GNHDT,12.5,T"), nmea.sentence("GNGST,120000.00,1,1,1,0,1,1,1")])
def test_messages_without_a_pause_and_a_new_time_are_not_kept_for_ever(frame: bytes) -> None:
    stream = EpochStream(EpochSettings())
    for step in range(1000):
        stream.push(frame, 10.0 + 0.01 * step)
    assert stream.dropped.total() >= 9
