"""A disk that becomes full while drawbar steers: steering continues, and the pages say in plain words what is lost."""

import sys

import pytest
from patience import PATIENT

pytest.importorskip("nicegui", reason="the extra `console` is not installed")
pytest.importorskip("shapefile", reason="the extra `console` is not installed")
if sys.platform != "linux":
    pytest.skip("real machines are driven by Linux only", allow_module_level=True)

import resource

from console_hand import Hand
from console_stage import staged

from drawbar.config import load_configuration
from drawbar.configurations import CONFIGURATION_NAME
from drawbar.console.language.words import Words
from drawbar.console.run_events import run_events
from drawbar.console.view import dashboard, picture
from drawbar.driving.processes.drive_processes import DriveProcesses
from drawbar.driving.stand_in.demonstration import with_stand_ins
from drawbar.messages import SupervisorState
from drawbar.recording.log import read_log
from drawbar.safety.causes import Cause

WORDS = {language: Words(language) for language in ("en", "de")}


def announces(gate):
    return Cause.NOT_RECORDING.value in gate.refusals


def test_steering_goes_on_while_the_disk_is_full_and_what_was_written_is_kept(tmp_path):
    configuration = with_stand_ins(load_configuration("articulated", ["path.radii=[8.0]", *PATIENT]))
    (tmp_path / CONFIGURATION_NAME).write_text(configuration.to_toml(), "utf-8")
    with DriveProcesses(configuration, tmp_path, stand_ins=True) as processes:
        hand = Hand(processes, configuration)
        hand.tries_emergency()
        hand.engages()
        hand.drive_on(1.0)
        gate = hand.link.gate
        assert not announces(gate)
        assert not picture(gate, None, None, WORDS["en"], stale=False)["unrecorded"]
        recorder = processes.by_name["recorder"].pid
        hard = resource.prlimit(recorder, resource.RLIMIT_FSIZE)[1]
        resource.prlimit(recorder, resource.RLIMIT_FSIZE, (0, hard))  # neither its log nor its messages grow any more
        hand.until(announces)
        hand.drive_on(2.0)
        gate = hand.link.gate
        assert gate.state is SupervisorState.ACTIVE
        assert announces(gate)
        assert processes.ended() == []
        for words in WORDS.values():
            shown = dashboard(gate, words, stale=False, mine=True, holder="1", drives=True)
            assert words("warnings") in shown.heading
            assert words.cause(Cause.NOT_RECORDING) in shown.reasons
            assert picture(gate, None, None, words, stale=False)["unrecorded"]
        hand.close()
    assert processes.by_name["recorder"].returncode == 0
    assert len(read_log(tmp_path / "log.mcap").records) > 5
    told = [event.text for event in run_events(tmp_path / "log.mcap", WORDS["en"])]
    assert "Steering" in told
    assert told[-1] == WORDS["en"]("record_ends")
    assert run_events(tmp_path / "log.mcap", WORDS["en"], is_on=True)[-1].text != told[-1]


@staged
async def test_the_drive_page_says_what_is_lost_and_what_to_do(stage, browser):
    one = await browser().open()
    stage.run(4.0, one)
    one.press("1 Prepare")
    stage.run(0.2, one)
    one.press("2 Engage")
    stage.run(2.0, one)
    stage.causes = {Cause.NOT_RECORDING}
    stage.run(0.2, one)
    assert "Steering" in one.text()
    for text in WORDS["en"].cause(Cause.NOT_RECORDING):
        assert text in one.text()
        assert text in one.notifications()
    before = one.notifications()
    stage.run(1.0, one)
    assert one.notifications() == before  # once
