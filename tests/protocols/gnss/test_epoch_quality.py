"""What an epoch says of its quality: deviations, resolution, and from which speed on its course counts."""

import math
from collections.abc import Callable

import pytest
from epoch_bursts import run
from receiver_frames import nmea, ubx

from drawbar.machine.stand_in.receiver import Report
from drawbar.protocols.gnss.settings import EpochSettings
from drawbar.protocols.gnss.stream import EpochStream
from drawbar.signals import FixQuality

Maker = Callable[..., Report]


@pytest.mark.parametrize(
    ("gst", "expected"),
    [
        ("1.0,,,,0.100,0.200,0.3", (0.3, 0.15)),
        ("1.0,,,,0.001,0.002,0.3", (0.01, 0.01)),
        ("1.0,,,,,,", (0.02, 0.02)),
        ("1.0,0.2,0.1,90.0,,,", (0.3, 0.15)),
        ("1.0,,,,0.100,0.0,0.3", None),
        ("1.0,,,,-0.100,0.2,0.3", None),
        ("1.0,,,,nan,0.2,0.3", None),
        ("1.0,,,,inf,0.2,0.3", None),
    ],
)
def test_deviation_of_each_axis(report: Maker, gst: str, expected: tuple[float, float] | None) -> None:
    stream = EpochStream(EpochSettings())
    epochs = run(stream, [(10.0, [nmea.gga(report()), nmea.sentence(f"GNGST,120000.000,{gst}")])])
    assert len(epochs) == (expected is not None)
    if expected is None:
        assert stream.dropped == {"epoch with an impossible deviation": 1}
    else:
        assert (epochs[0].sigma_east, epochs[0].sigma_north) == pytest.approx(expected)


@pytest.mark.parametrize(
    ("quality", "sigma"),
    [
        (FixQuality.FIXED, 0.02),
        (FixQuality.FLOAT, 0.4),
        (FixQuality.DIFFERENTIAL, 0.8),
        (FixQuality.SINGLE, 2.5),
    ],
)
def test_deviation_by_quality_where_none_is_reported(report: Maker, quality: FixQuality, sigma: float) -> None:
    (epoch,) = run(EpochStream(EpochSettings()), [(10.0, [nmea.gga(report(quality=quality))])])
    assert (epoch.quality, epoch.sigma_east, epoch.sigma_north) == (quality, sigma, sigma)


def test_the_finer_of_two_positions_is_taken_with_the_quality_of_the_other(report: Maker) -> None:
    for frames in ([ubx.pvt, ubx.hpposllh], [ubx.hpposllh, ubx.pvt]):
        (epoch,) = run(EpochStream(EpochSettings()), [(10.0, [encode(report()) for encode in frames])])
        assert epoch.latitude == pytest.approx(50.8768724267, abs=1e-9)
        assert (epoch.quality, epoch.resolution, epoch.satellites) == (FixQuality.FIXED, 1e-9, 20)
    (alone,) = run(EpochStream(EpochSettings()), [(10.0, [ubx.pvt(report())])])
    assert alone.resolution == 1e-7
    (unknown,) = run(EpochStream(EpochSettings()), [(10.0, [ubx.hpposllh(report())])])
    assert (unknown.quality, unknown.has_fix) == (FixQuality.UNKNOWN, True)


@pytest.mark.parametrize(("decimals", "quality"), [(5, FixQuality.FIXED), (4, FixQuality.FLOAT), (2, FixQuality.FLOAT)])
def test_a_fixed_position_in_coarse_steps_counts_as_float(report: Maker, decimals: int, quality: FixQuality) -> None:
    fields = nmea.gga(report()).decode()[1:].split("*")[0].split(",")
    for place in (2, 4):
        fields[place] = fields[place][: fields[place].index(".") + 1 + decimals]
    (epoch,) = run(EpochStream(EpochSettings()), [(10.0, [nmea.sentence(",".join(fields))])])
    assert epoch.quality is quality


def test_no_direction_below_walking_pace(report: Maker) -> None:
    for speed, is_known in ((0.29, False), (0.31, True)):
        (epoch,) = run(EpochStream(EpochSettings()), [(10.0, nmea.sentences(report(speed=speed)))])
        assert math.isfinite(epoch.course) is is_known


def test_quality_falls_at_once_and_rises_after_it_has_held(report: Maker) -> None:
    fixed, floating = FixQuality.FIXED, FixQuality.FLOAT
    reported = [fixed] * 3 + [floating, fixed] * 5 + [fixed] * 12
    bursts = [(10.0 + 0.1 * step, [nmea.gga(report(0.1 * step, quality=each))]) for step, each in enumerate(reported)]
    epochs = run(EpochStream(EpochSettings(quality_hold=1.0)), bursts)
    assert [epoch.reported for epoch in epochs] == reported
    assert [epoch.quality for epoch in epochs] == [fixed] * 3 + [floating] * 19 + [fixed] * 3
    assert {epoch.sigma_east for epoch in epochs[3:22]} == {0.4}
