"""Assembly: when epochs end, what becomes of those that repeat, go back, or come late, and when each was measured."""

import datetime
import math
import random
import struct
from collections.abc import Callable
from dataclasses import replace
from itertools import pairwise

import pytest
from epoch_bursts import run
from receiver_frames import nmea, sbf, ubx

from drawbar.machine.stand_in.receiver import Report
from drawbar.protocols.gnss.checksums import crc_ccitt
from drawbar.protocols.gnss.epoch import Epoch
from drawbar.protocols.gnss.settings import EpochSettings
from drawbar.protocols.gnss.stream import EpochStream
from drawbar.signals import FixQuality

Maker = Callable[..., Report]


def test_silence_ends_an_epoch(report: Maker) -> None:
    stream = EpochStream(EpochSettings())
    assert stream.push(nmea.gga(report()), 10.0) == []
    assert stream.push(nmea.vtg(report()), 10.004) == []
    assert stream.due == pytest.approx(10.024)
    assert stream.poll(10.0239) == []
    (epoch,) = stream.poll(10.0241)
    assert (epoch.received, epoch.speed) == (10.0, pytest.approx(1.0, abs=1e-4))
    assert stream.poll(20.0) == []


def test_who_reads_late_does_not_take_the_time_between_two_looks_for_a_silence(report: Maker) -> None:
    stream = EpochStream(EpochSettings())
    gga, vtg, gst = nmea.sentences(report())
    assert stream.push(gga + vtg[:9], 10.0) == []
    assert stream.push(vtg[9:] + gst, 10.06) == []
    (epoch,) = stream.poll(10.09)
    assert (epoch.speed, epoch.sigma_east) == pytest.approx((1.0, 0.015), abs=1e-4)


def test_another_time_ends_an_epoch_at_once(report: Maker) -> None:
    stream = EpochStream(EpochSettings())
    assert stream.push(nmea.gga(report(0.0)) + nmea.vtg(report(0.0)), 10.0) == []
    (epoch,) = stream.push(nmea.gga(report(0.1)), 10.01)
    assert epoch.utc == pytest.approx(43200.0)


def test_an_epoch_ends_with_the_last_kind_of_message_that_usually_comes(report: Maker) -> None:
    stream = EpochStream(EpochSettings())
    for step in range(3):
        run(stream, [(10.0 + 0.1 * step, nmea.sentences(report(0.1 * step)))])
    gga, vtg, gst = nmea.sentences(report(0.3))
    assert stream.push(gga + vtg, 10.3) == []
    (epoch,) = stream.push(gst, 10.301)
    assert (epoch.utc, epoch.speed, epoch.sigma_east) == pytest.approx((43200.3, 1.0, 0.015), abs=1e-4)


def test_a_message_that_came_too_late_is_counted_and_waited_for(report: Maker) -> None:
    stream = EpochStream(EpochSettings())
    run(stream, [(10.0 + 0.1 * step, [nmea.gga(report(0.1 * step))]) for step in range(3)])
    speeds = []
    for step in range(3, 9):  # the speed is switched on
        begin = 10.0 + 0.1 * step
        speeds += [epoch.speed for epoch in run(stream, [(begin, [nmea.gga(report(0.1 * step)), nmea.vtg(report())])])]
    assert [math.isnan(speed) for speed in speeds] == 2 * [True] + 4 * [False]
    assert stream.dropped == {"message without its epoch": 2}


def test_the_age_of_corrections_counts_where_its_message_comes_once_a_second_after_the_epoch(report: Maker) -> None:
    """KSXT has no such age; a receiver may send it at 5 Hz, and GGA behind it at 1 Hz, which nothing waits for."""
    stream, ages = EpochStream(EpochSettings()), []
    for step in range(26):
        sent = report(0.2 * step, correction_age=1.0)
        frames = [nmea.ksxt(sent), *([nmea.gga(sent)] if step % 5 == 0 else [])]
        ages += [epoch.correction_age for epoch in run(stream, [(10.0 + 0.2 * step, frames)])]
    assert len(ages) == 26
    assert ages[16:21] == pytest.approx([1.2, 1.4, 1.6, 1.8, 2.0])
    for minute in range(1, 63):  # without GGA it grows old, and is not known after an hour
        ages += [
            epoch.correction_age for epoch in run(stream, [(10.0 + 60.0 * minute, [nmea.ksxt(report(60.0 * minute))])])
        ]
    assert ages[25 + 30] == pytest.approx(1796.0, abs=0.3)
    assert math.isnan(ages[-1])


@pytest.mark.parametrize(("gap", "dropped"), [(0.03, 1), (0.055, 1), (0.075, 8)])
def test_a_speed_that_comes_a_while_after_its_position_is_waited_for(report: Maker, gap: float, dropped: int) -> None:
    """Some receivers compute it later; what comes too late for a step is not waited for."""
    stream, speeds = EpochStream(EpochSettings()), []
    for step in range(8):
        begin = 10.0 + 0.2 * step
        ended = stream.push(nmea.gga(report(0.2 * step)), begin)
        for time in (0.02, 0.06):
            if time < gap:
                ended += stream.poll(begin + time + 0.001)
        ended += stream.push(nmea.vtg(report()), begin + gap)
        ended += stream.poll(begin + 0.15)
        speeds += [epoch.speed for epoch in ended]
    assert [math.isnan(speed) for speed in speeds] == dropped * [True] + (8 - dropped) * [False]
    assert stream.dropped == {"message without its epoch": dropped}


def test_a_message_that_came_late_once_is_not_waited_for_for_ever(report: Maker) -> None:
    """It comes in every second epoch: the others end by the silence."""
    stream, waits = EpochStream(EpochSettings()), []
    for step in range(40):
        begin = 10.0 + 0.2 * step
        stream.push(nmea.gga(report(0.2 * step)), begin)
        if step % 2:
            waits.append(stream.due - begin)
            stream.poll(stream.due)
        else:
            late = 0.03 if step == 20 else 0.001
            stream.poll(begin + late)
            stream.push(nmea.vtg(report()), begin + late)
            stream.poll(begin + 0.1)
    assert waits == pytest.approx(10 * [0.02] + 5 * [0.06] + 5 * [0.02])


def test_a_message_that_no_longer_comes_is_not_waited_for_for_ever(report: Maker) -> None:
    stream = EpochStream(EpochSettings())
    run(stream, [(10.0 + 0.1 * step, nmea.sentences(report(0.1 * step))) for step in range(10)])
    ended = [len(stream.push(nmea.gga(report(1.0 + 0.1 * step)), 11.0 + 0.1 * step)) for step in range(10)]
    assert ended[0] == 0
    assert ended[-1] == 1


def test_a_speed_before_its_position_belongs_to_it(report: Maker) -> None:
    bursts = [(10.0 + step, [nmea.vtg(report(speed=1.0 + step)), nmea.gga(report(step))]) for step in range(5)]
    speeds = [epoch.speed for epoch in run(EpochStream(EpochSettings()), bursts)]
    assert speeds == pytest.approx([1.0, 2.0, 3.0, 4.0, 5.0], abs=1e-3)


def test_an_epoch_without_time_is_none(report: Maker) -> None:
    stream = EpochStream(EpochSettings())
    assert run(stream, [(10.0, [nmea.sentence("GNGGA,,,,,,0,,,,,,,,"), nmea.vtg(report())])]) == []
    assert stream.dropped == {"epoch without time": 1}


def test_attitude_alone_is_an_epoch(report: Maker) -> None:
    (epoch,) = run(EpochStream(EpochSettings()), [(10.0, [ubx.relposned(report(yaw=1.0))])])
    assert epoch.yaw == pytest.approx(1.0, abs=1e-6)
    assert (epoch.quality, epoch.has_fix) == (FixQuality.UNKNOWN, False)


def test_a_position_that_begins_to_come_behind_the_attitude_is_waited_for(report: Maker) -> None:
    stream = EpochStream(EpochSettings())
    epochs = run(stream, [(10.0 + 0.1 * step, [nmea.hrp(report(0.1 * step, yaw=1.0))]) for step in range(20)])
    for step in range(20, 30):
        frames = [nmea.hrp(report(0.1 * step, yaw=1.0)), nmea.gga(report(0.1 * step))]
        epochs += run(stream, [(10.0 + 0.1 * step, frames)])
    assert [epoch.has_fix for epoch in epochs] == [False] * 21 + [True] * 9
    assert stream.dropped == {"message without its epoch": 1}


def test_a_second_rarer_position_is_not_waited_for_and_repeats_nothing(report: Maker) -> None:
    stream = EpochStream(EpochSettings())
    waits = []
    for step in range(40):
        frames = [nmea.gga(report(0.1 * step)), *([nmea.rmc(report(0.1 * step))] if step % 10 == 0 else [])]
        waits.append(not stream.push(frames[0], 10.0 + 0.1 * step))
        for frame in frames[1:]:
            stream.push(frame, 10.001 + 0.1 * step)
        stream.poll(10.08 + 0.1 * step)
    assert waits == [True] * 4 + [False] * 36  # until its share is known to be small
    assert stream.dropped == {"message without its epoch": 3}
    assert stream.frozen == 0


def test_attitude_between_positions_does_not_disturb_them(report: Maker) -> None:
    place = {"yaw": 1.0, "quality": FixQuality.FIXED}
    bursts = [
        (10.0 + 0.1 * step, [nmea.hrp(report(0.1 * step, **place)), *([nmea.gga(report(0.1 * step))] * (step % 2))])
        for step in range(10)
    ]
    epochs = run(EpochStream(EpochSettings()), bursts)
    assert [epoch.quality for epoch in epochs] == [FixQuality.UNKNOWN, FixQuality.FIXED] * 5
    assert [epoch.has_fix for epoch in epochs] == [False, True] * 5
    assert all(math.isfinite(epoch.yaw) for epoch in epochs)


def leap_second(seconds: float) -> str:
    """Return a time of day from 23:59:59 on, with a leap second."""
    if seconds < 1.0:
        return f"2359{59.0 + seconds:05.2f}"
    return f"2359{59.0 + seconds:05.2f}" if seconds < 2.0 else f"0000{seconds - 2.0:05.2f}"


def gga_at(clock: str) -> bytes:
    return nmea.sentence(f"GNGGA,{clock},5052.6123456,N,00442.1234567,E,4,17,0.7,42.3,M,45.7,M,1.2,0")


def check_even(epochs: list[Epoch], count: int, interval: float) -> None:
    assert len(epochs) == count
    assert [later.time - earlier.time for earlier, later in pairwise(epochs)] == pytest.approx(
        [interval] * (count - 1), abs=1e-6
    )


def test_epochs_go_on_through_a_leap_second_and_midnight() -> None:
    stream = EpochStream(EpochSettings())
    epochs = run(stream, [(10.0 + 0.2 * step, [gga_at(leap_second(0.2 * step))]) for step in range(20)])
    check_even(epochs, 20, 0.2)
    assert epochs[5].utc == pytest.approx(86400.0)
    assert epochs[10].utc == pytest.approx(0.0)
    assert stream.dropped == {}


@pytest.mark.parametrize("encode", [nmea.sentences, ubx.frames, sbf.blocks])
@pytest.mark.parametrize("begin", ["2026-11-21T23:59:59+00:00", "2026-11-21T23:59:41+00:00"])
def test_epochs_go_on_through_the_ends_of_day_and_week(
    report: Maker, encode: Callable[[Report], list[bytes]], begin: str
) -> None:
    start = datetime.datetime.fromisoformat(begin)  # a Saturday; the GPS week ends 18 s before the day
    stream = EpochStream(EpochSettings())
    bursts = [(10.0 + 0.2 * step, encode(report(0.2 * step, begin=start, yaw=1.0))) for step in range(10)]
    check_even(run(stream, bursts), 10, 0.2)
    assert stream.dropped == {}


def test_a_repeated_epoch_changes_nothing(report: Maker) -> None:
    stream, plain = EpochStream(EpochSettings()), EpochStream(EpochSettings())
    times = [10.0 + 0.1 * step for step in range(8)]
    once = run(plain, [(time, nmea.sentences(report(0.1 * step))) for step, time in enumerate(times)])
    twice = [
        (time + late, nmea.sentences(report(0.1 * step))) for step, time in enumerate(times) for late in (0.0, 0.03)
    ]
    assert run(stream, twice) == once
    assert stream.dropped == {"epoch repeated": 8}


def test_a_frozen_receiver_is_seen(report: Maker) -> None:
    stream = EpochStream(EpochSettings())
    epochs = run(stream, [(10.0 + 0.1 * step, nmea.sentences(report(0.0))) for step in range(5)])
    assert (len(epochs), stream.frozen) == (1, 4)
    run(stream, [(11.0, nmea.sentences(report(1.0)))])
    assert stream.frozen == 0


def test_an_epoch_out_of_order_is_dropped(report: Maker) -> None:
    stream = EpochStream(EpochSettings())
    arrivals = [(10, 0), (11, 1), (13, 3), (13, 2), (14, 4), (15, 5)]
    epochs = run(stream, [(float(time), nmea.sentences(report(seconds))) for time, seconds in arrivals])
    assert [epoch.utc - 43200.0 for epoch in epochs] == pytest.approx([0, 1, 3, 4, 5])
    assert stream.dropped == {"epoch out of order": 1}


def test_one_time_from_the_future_is_dropped_and_changes_no_other_epoch(report: Maker) -> None:
    stream = EpochStream(EpochSettings(latency=0.0))
    seconds = [0.0, 0.2, 0.4, 0.9, 0.8, 7000.0, 1.2, 1.4]
    epochs = run(stream, [(10.0 + 0.2 * step, [nmea.gga(report(each))]) for step, each in enumerate(seconds)])
    assert [epoch.time for epoch in epochs] == pytest.approx([10.0, 10.2, 10.4, 10.8, 11.2, 11.4])
    assert stream.dropped == {"epoch ahead of its time": 2}


def test_an_epoch_is_never_measured_before_the_last_one_whatever_latency_is_reported(report: Maker) -> None:
    stream = EpochStream(EpochSettings())
    told = bytearray(sbf.pvt_geodetic(report(0.02)))
    told[88:90] = (1).to_bytes(2, "little")  # 0.1 ms: a receiver that reports its latency
    told[2:4] = crc_ccitt(told[4:]).to_bytes(2, "little")
    bursts = [(10.0, [sbf.pvt_geodetic(report())]), (10.03, [bytes(told)]), (10.055, [sbf.pvt_geodetic(report(0.04))])]
    epochs = run(stream, [*bursts, (10.2, [sbf.pvt_geodetic(report(0.2))])])
    assert [epoch.utc - 43200.0 for epoch in epochs] == pytest.approx([0.0, 0.02, 0.2])
    assert stream.dropped == {"epoch measured before the last one": 1}


@pytest.mark.parametrize("hop", [0.3, 1.0, 7000.0])
def test_a_receiver_that_sets_its_clock_forward_is_followed_from_the_second_epoch(report: Maker, hop: float) -> None:
    stream = EpochStream(EpochSettings(latency=0.0))
    seconds = [0.2 * step + (hop if step >= 4 else 0.0) for step in range(8)]
    epochs = run(stream, [(10.0 + 0.2 * step, [nmea.gga(report(each))]) for step, each in enumerate(seconds)])
    assert [epoch.time for epoch in epochs] == pytest.approx([10.0, 10.2, 10.4, 10.6, 11.0, 11.2, 11.4])
    assert stream.dropped == {"epoch ahead of its time": 1}


def test_two_wrong_times_in_turn_with_right_ones_do_not_confirm_each_other(report: Maker) -> None:
    stream = EpochStream(EpochSettings(latency=0.0))
    seconds = [0.2 * step + (0.5 if step in (4, 6) else 0.0) for step in range(9)]
    epochs = run(stream, [(10.0 + 0.2 * step, [nmea.gga(report(each))]) for step, each in enumerate(seconds)])
    assert [epoch.time for epoch in epochs] == pytest.approx([10.0, 10.2, 10.4, 10.6, 11.0, 11.4, 11.6])


@pytest.mark.parametrize("hop", [-0.5, -1.0, -18.0, -7000.0])
def test_a_receiver_that_sets_its_clock_back_is_followed_from_the_second_epoch(report: Maker, hop: float) -> None:
    stream = EpochStream(EpochSettings(latency=0.0))
    seconds = [0.2 * step + (hop if step >= 4 else 0.0) for step in range(400)]
    epochs = run(stream, [(10.0 + 0.2 * step, [nmea.gga(report(each))]) for step, each in enumerate(seconds)])
    assert [epoch.time for epoch in epochs] == pytest.approx([10.0 + 0.2 * step for step in range(400) if step != 4])
    assert stream.dropped == {"epoch out of order": 1, "receiver's clock set back": 1}


def test_epochs_that_come_again_all_at_once_are_no_clock_that_was_set_back(report: Maker) -> None:
    stream = EpochStream(EpochSettings(latency=0.0))
    steps = [0, 1, 2, 3, 4, 5, 6, 7, 8, 3, 4, 5, 6, 9, 10, 11]
    times = [10.0 + 0.2 * step for step in (0, 1, 2, 3, 4, 5, 6, 7, 8, 8.1, 8.2, 8.3, 8.4, 9, 10, 11)]
    epochs = run(stream, [(time, [nmea.gga(report(0.2 * step))]) for time, step in zip(times, steps, strict=True)])
    assert [epoch.time for epoch in epochs] == pytest.approx([10.0 + 0.2 * step for step in range(12)])
    assert stream.dropped == {"epoch out of order": 4}


def test_the_time_of_measurement_does_not_jitter_with_its_arrival(report: Maker) -> None:
    chance = random.Random(0)
    stream = EpochStream(EpochSettings(latency=0.05))
    delays = [0.0, *(chance.expovariate(50.0) for _ in range(199))]
    bursts = [(10.0 + 0.2 * step + delay, [nmea.gga(report(0.2 * step))]) for step, delay in enumerate(delays)]
    epochs = run(stream, bursts)
    assert [epoch.time for epoch in epochs] == pytest.approx([9.95 + 0.2 * step for step in range(200)])
    assert [epoch.received - epoch.time for epoch in epochs] == pytest.approx([0.05 + delay for delay in delays])


def test_data_held_up_is_old(report: Maker) -> None:
    stream = EpochStream(EpochSettings(latency=0.0))
    times = [10.0 + 0.1 * step + (0.7 if step >= 20 else 0.0) for step in range(30)]
    epochs = run(stream, [(time, [nmea.gga(report(0.1 * step))]) for step, time in enumerate(times)])
    assert [epoch.received - epoch.time for epoch in epochs[20:]] == pytest.approx([0.7] * 10)


def test_the_least_delay_is_forgotten_after_a_minute(report: Maker) -> None:
    stream = EpochStream(EpochSettings(latency=0.0))
    drift = 1e-4  # the receiver's second against the monotonic one: far more than any clock's
    epochs = run(stream, [(10.0 + (1.0 + drift) * step, [nmea.gga(report(step))]) for step in range(300)])
    assert max(epoch.received - epoch.time for epoch in epochs) == pytest.approx(60 * drift, rel=0.05)


def test_a_line_that_has_become_slower_is_known_for_long(report: Maker) -> None:
    stream = EpochStream(EpochSettings(latency=0.0))
    bursts = [(10.0 + step + 0.4 * (step >= 20), [nmea.gga(report(step))]) for step in range(200)]
    ages = [epoch.received - epoch.time for epoch in run(stream, bursts)]
    assert ages[20] == pytest.approx(0.4)
    assert ages[-1] == pytest.approx(0.4 - 5e-4 * 120.0, abs=1e-3)  # for a minute nothing is forgotten


def test_a_receiver_that_gets_its_time_with_its_first_fix_is_believed_from_then(report: Maker) -> None:
    stream = EpochStream(EpochSettings(latency=0.0))
    nowhere = [nmea.gga(replace(report(0.2 * step), quality=FixQuality.NONE)) for step in range(10)]
    bursts = [(10.0 + 0.2 * step, [data]) for step, data in enumerate(nowhere)]
    bursts += [(12.1 + 0.2 * step, [nmea.gga(report(2.0 + 0.2 * step))]) for step in range(10)]
    fixed = [epoch for epoch in run(stream, bursts) if epoch.has_fix]
    assert len(fixed) == 10
    assert [epoch.received - epoch.time for epoch in fixed] == pytest.approx([0.0] * 10, abs=1e-9)


def test_the_least_delay_is_forgotten_over_a_pause(report: Maker) -> None:
    times = [0.0, 1.0, 2.0, 100.0, 101.0]
    bursts = [(10.0 + time + (0.3 if time >= 100.0 else 0.0), [nmea.gga(report(time))]) for time in times]
    epochs = run(EpochStream(EpochSettings(latency=0.0)), bursts)
    assert [epoch.received - epoch.time for epoch in epochs] == pytest.approx([0.0] * 5, abs=1e-9)


def test_a_latency_that_the_receiver_reports_is_taken_off(
    golden: Callable[[str], dict[str, list[dict[str, str]]]],
) -> None:
    data = bytes.fromhex(golden("gnss_binary.json")["sbf"][0]["hex"])
    (epoch,) = run(EpochStream(EpochSettings(latency=0.02)), [(10.0, [data])])
    assert epoch.time == pytest.approx(10.0 - 0.02 - 0.0085)
    (epoch,) = run(EpochStream(EpochSettings()), [(10.0, [data])])
    assert epoch.time == pytest.approx(10.0 - 0.01 - 0.0085), "the line's alone, as the receiver tells its own"


def test_an_unreported_latency_is_what_most_receivers_have(report: Maker) -> None:
    (epoch,) = run(EpochStream(EpochSettings()), [(10.0, [nmea.gga(report())])])
    assert epoch.time == pytest.approx(10.0 - 0.04)


def test_nothing_of_a_receiver_is_believed_while_it_reports_spoofing(report: Maker) -> None:
    stream = EpochStream(EpochSettings())
    false, right = (ubx.frame(0x01, 0x03, struct.pack("<IBBBBII", 0, 3, 1, 0, state << 3, 0, 0)) for state in (2, 1))
    epochs = [
        run(stream, [(10.0 + 0.2 * step, [*told, *nmea.sentences(report(0.2 * step))])])[0]
        for step, told in enumerate(([], [false], [], [right], [], [], [], [], []))
    ]
    assert [each.has_fix for each in epochs] == [True, False, False, *[True] * 6]
    assert all(math.isnan(each.speed) and each.quality is FixQuality.NONE for each in epochs[1:3])
    assert epochs[3].quality is FixQuality.NONE
    assert epochs[-1].quality is FixQuality.FIXED
    assert stream.dropped["epoch of a receiver that reports spoofing"] == 2
