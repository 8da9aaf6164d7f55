"""A drive in which a sensor turned out to be wrong, and the last seconds were computed again, replays bit for bit."""

import pytest
from recorded_rehearsal import recorded_rehearsal
from typer.testing import CliRunner

from drawbar.cli.main import app
from drawbar.config import load_configuration
from drawbar.driving.evaluation.replay import replay_drive
from drawbar.driving.stand_in.demonstration import with_stand_ins
from drawbar.machine.stand_in.breaking import moved, report_otherwise
from drawbar.messages import CommandMessage, SupervisorState
from drawbar.protocols.sensor_board import sentence

CHANGES = ("path.radii=[8.0]", "path.straight_length=15.0", "speed=2.0", "safety.engage.fixed=1.0")


def drift(rehearsal):
    """Let both antennas drift to the left."""
    machine = rehearsal.machine
    report_otherwise(machine, lambda report, since: moved(report, machine, 0.3 * since))


def break_hitch_sensor(rehearsal):
    """Let the hitch sensor say that it is at its end."""

    def broken(now, data):
        milliseconds, _, pulses = data[1:].partition(b"*")[0].split(b",")[1:]
        return [(0.0, sentence(int(milliseconds), 0, int(pulses)))]

    rehearsal.links.faults["sensors"] = broken


def drive(file, *faults):
    """Drive a curve, in which faults begin a second after each other; return how far answers were corrected, rad."""
    configuration, corrected = with_stand_ins(load_configuration("articulated", CHANGES)), []
    with recorded_rehearsal(configuration, file, seed=3) as (rehearsal, sent):
        while rehearsal.gate_state is None or rehearsal.gate_state.state is not SupervisorState.ACTIVE:
            rehearsal.advance()
            assert rehearsal.time < 60.0, rehearsal.gate_state
        for begin, duration in ((None, 10.0), *((each, 1.0) for each in faults), (None, 3.0)):
            if begin is not None:
                begin(rehearsal)
            for _ in rehearsal.run(duration):
                if rehearsal.loop._controller.has_corrected:
                    bent, anew = [each for each in sent if isinstance(each, CommandMessage)][-2:]
                    assert bent.time == anew.time
                    corrected.append(abs(anew.tractor_angle - bent.tractor_angle))
    return corrected


@pytest.mark.parametrize(
    "faults",
    [(drift,), (break_hitch_sensor,), (break_hitch_sensor, drift)],
    ids=["drift", "hitch", "hitch, then drift"],
)
def test_a_drive_whose_last_seconds_were_computed_again_replays_bit_for_bit(tmp_path, faults):
    corrected = drive(tmp_path / "log.mcap", *faults)
    assert len(corrected) == len(faults)
    assert max(corrected) > 1e-3
    again = replay_drive(tmp_path / "log.mcap")
    assert len(again.records) > 80
    assert again.differences == ()


def test_the_command_tells_of_a_drive_how_many_steps_it_recomputed(tmp_path):
    drive(tmp_path / "log.mcap")
    told = CliRunner().invoke(app, ["replay", str(tmp_path)])
    assert told.exit_code == 0, told.exception
    assert "steps recomputed\nevery number is the recorded one, bit for bit" in told.stdout
    other = CliRunner().invoke(app, ["replay", str(tmp_path), "--set", "devices.tractor_receiver.latency=0.05"])
    assert other.exit_code == 0, other.exception
    assert "first difference: step " in other.stdout


def test_a_log_that_is_cut_off_replays_up_to_there(tmp_path):
    drive(tmp_path / "log.mcap")
    whole, cut = (tmp_path / "log.mcap").read_bytes(), tmp_path / "cut.mcap"
    steps = []
    for share in (0.4, 0.45, 0.5, 0.6, 0.8, 0.9):
        cut.write_bytes(whole[: round(share * len(whole))])
        again = replay_drive(cut)
        assert again.differences == ()
        assert again.cut.startswith("the log just stops")
        steps.append(len(again.records))
    assert steps == sorted(steps)
    to_the_end = replay_drive(tmp_path / "log.mcap")
    assert steps[0] < steps[-1] <= len(to_the_end.records)
    assert to_the_end.cut == ""
