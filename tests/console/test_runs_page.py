"""The runs page, by simulated users: events in plain words, comparison, export, deleting."""

import asyncio
import json
import os
import shutil
from dataclasses import asdict
from pathlib import Path

import msgspec
import numpy as np
import pytest

pytest.importorskip("nicegui", reason="the extra `console` is not installed")
pytest.importorskip("shapefile", reason="the extra `console` is not installed")

from console_stage import Stage, console, until

from drawbar.console.language.words import Words
from drawbar.console.run_comparison import FIGURES, value_of
from drawbar.console.run_events import run_events
from drawbar.console.runs_page import list_runs
from drawbar.console.visitors import Rank
from drawbar.errors import DrawbarError
from drawbar.messages import Action, OperatorMessage, SupervisorState
from drawbar.recording.chunked_writer import ChunkedWriter
from drawbar.recording.recorder import Recorder
from drawbar.report.folder import write_report
from drawbar.safety.causes import Cause

SECOND = 10**9


@pytest.fixture
def runs(tmp_path, run_log):
    """Return a folder of two runs with reports and one without."""
    log, configuration = run_log
    for name in ("first", "second", "broken"):
        folder = tmp_path / "runs" / name
        folder.mkdir(parents=True)
        (folder / "config.toml").write_text(configuration.to_toml(), "utf-8")
    for name in ("first", "second"):
        folder = tmp_path / "runs" / name
        with Recorder(folder / "log.mcap", log.header) as recorder:
            for record in log.records[: 200 if name == "first" else 100]:
                recorder.write(record)
        write_report(folder)
    return tmp_path / "runs"


def on_page(runs, test, current="elsewhere", rank=Rank.MAINTAINER):
    """Run an asynchronous test in front of the page."""

    async def whole():
        stage = Stage(runs.parent / "audit")
        options = {"runs": str(runs), "configuration": str(runs / current / "config.toml")}
        async with console(stage, **options) as browser:
            one = browser()
            visitors = one.pages._visitors
            admit = visitors.admit
            visitors.admit = lambda name, _, time: admit(name, rank, time)
            return await test(await one.open("/runs"))

    return asyncio.run(whole())


def test_two_runs_are_compared_by_their_figures(runs):
    async def test(one):
        one.press("Compare")
        return one.text()

    shown = on_page(runs, test)
    first, second = (json.loads((runs / name / "metrics.json").read_text()) for name in ("first", "second"))
    assert "Largest error, Trailer (cm)" in shown
    for metrics in (first, second):
        assert f"{100.0 * metrics['error_m']['trailer']['all']['max']:.1f}" in shown
    a, b = (value_of(next(each for each in FIGURES if each.text == "error_max"), each) for each in (first, second))
    assert {f"{b - a:+.1f}".replace("-", "−"), f"{a - b:+.1f}".replace("-", "−")} & set(shown.split()), (
        "a signed difference"
    )
    by_path = {figure.path: value_of(figure, first) for figure in FIGURES}
    assert by_path["length_m"] == first["length_m"]
    assert not any(np.isnan(value) for value in by_path.values())
    assert all(np.isnan(value_of(figure, {})) for figure in FIGURES)


def test_a_run_is_exported_as_a_table_and_what_cannot_be_is_said(runs):
    async def test(one):
        assert "Export CSV" in [getattr(each, "text", "") for each in one.user.client.elements.values()]
        (run,) = (each for each in _listed(runs) if each.name == "second")
        for kind in ("CSV", "GeoJSON"):
            with one.user.client:
                await one.page._export(run, kind)
        await until(lambda: one.user.download.http_responses)
        return [answer.content for answer in one.user.download.http_responses], one.notifications()

    (table,), told = on_page(runs, test)
    assert table.count(b"\n") == 101
    assert "not known where on Earth" in told


def test_the_map_of_a_run_is_shown_and_served_by_its_name(runs):
    (runs / "first").rename(runs / "first #1? 50%")

    async def test(one):
        names = [run.name for run in _listed(runs) if run.has_report]
        for run in _listed(runs):
            if run.name == "first #1? 50%":
                with one.user.client:
                    one.page._show_map(run)
        (picture,) = (each for each in one.user.client.elements.values() if each.tag == "img")
        answers = [await one.user.http_client.get(address) for address in (picture.props["src"], "/map/none")]
        report = next(
            each.props["href"] for each in one.user.client.elements.values() if "first" in str(each.props.get("href"))
        )
        assert (await one.user.http_client.get(report)).status_code == 200
        return names, answers

    names, (found, missing) = on_page(runs, test)
    assert sorted(names) == ["first #1? 50%", "second"]
    assert found.content == (runs / names[names.index("first #1? 50%")] / "map.svg").read_bytes()
    assert (missing.status_code, missing.headers["location"]) == (303, "/runs")


def test_three_hundred_runs_are_listed_a_few_at_a_time(runs):
    for number in range(300):
        folder = runs / f"earlier-{number:03d}"
        folder.mkdir()
        (folder / "config.toml").touch()
        os.utime(folder, (number, number))

    async def test(one):
        before = one.text()
        one.press("Earlier: 288")
        return before, one.text()

    before, after = on_page(runs, test)
    assert (before.count("earlier-"), after.count("earlier-")) == (12, 27)
    assert "earlier-299" in before


def test_a_run_that_somebody_else_deletes_is_reported_and_goes_from_the_list(runs):
    async def test(one):
        (run,) = (each for each in _listed(runs) if each.name == "second")
        with one.user.client:
            one.page._show_map(run)
        shutil.rmtree(runs / "second")
        asked = [one.page._show_events(run), one.page._export(run, "CSV")]
        with one.user.client:
            for each in asked:
                await each
            one.page._show_map(run)
        assert one.notifications().count("This run has been deleted meanwhile") == 3
        return one.text()

    assert "second" not in on_page(runs, test)


def test_a_run_that_is_deleted_while_runs_are_listed_is_left_out(tmp_path, monkeypatch):
    is_file = Path.is_file

    def deleted_then(path):
        found = is_file(path)
        if path.parent.name == "gone":
            shutil.rmtree(path.parent, ignore_errors=True)
        return found

    for name in ("gone", "stays"):
        (tmp_path / name).mkdir()
        (tmp_path / name / "config.toml").touch()
    monkeypatch.setattr(Path, "is_file", deleted_then)
    assert [run.name for run in list_runs(tmp_path)] == ["stays"]


def test_a_run_is_deleted_after_asking_and_the_one_that_is_on_never(runs):
    async def test(one):
        names = [each.text for each in one.user.client.elements.values() if getattr(each, "text", "") == "Delete"]
        one.page._ask_deletion(next(run for run in _listed(runs) if run.name == "broken"))
        assert "Delete broken with all its files?" in one.text()
        one.press("Delete now")
        assert "was written to a moment ago" in one.notifications()
        assert (runs / "broken").exists()
        for each in runs.rglob("*"):
            os.utime(each, (0.0, 0.0))
        one.page._ask_deletion(next(run for run in _listed(runs) if run.name == "broken"))
        one.press("Delete now")
        one.page._delete(next(run for run in _listed(runs) if run.name == "first"))  # forged
        return len(names)

    assert on_page(runs, test, current="first") == 2
    assert sorted(each.name for each in runs.iterdir()) == ["first", "second"]
    assert json.loads((runs.parent / "audit").read_text())["run"] == "broken"


def test_an_operator_deletes_nothing(runs):
    async def test(one):
        assert "Delete" not in [getattr(each, "text", "") for each in one.user.client.elements.values()]
        one.page._delete(_listed(runs)[0])

    on_page(runs, test, rank=Rank.OPERATOR)
    assert len(list(runs.iterdir())) == 3


def _listed(runs):
    from drawbar.console.runs_page import list_runs

    return list_runs(runs)


@pytest.fixture
def drive_log(tmp_path):
    """Return the log of a drive by the gate's real engagement: refused to engage, stopped, acknowledged."""
    stage, file = Stage(), tmp_path / "log.mcap"
    states, asked = [], []
    receive = stage.link.receive
    stage.link.receive = lambda data: (receive(data), states.append(stage.link.gate))
    stage.run(4.0)
    for action in (Action.ENGAGE, Action.EMERGENCY, Action.ACKNOWLEDGE):
        stage.standing = True
        message = OperatorMessage(
            time=stage.now,
            valid_until=stage.now + SECOND,
            action=action,
            lease=5,
            nonce=stage.now,
            seen_sequence=stage.link.gate.sequence,
            seen_time=stage.link.gate.time,
        )
        stage.requests.receive(stage.time, message)
        asked += [message, message]  # the recorder may hear a message twice
        stage.run(3.0)
    with file.open("wb") as stream:
        writer = ChunkedWriter(stream)
        channels = {name: writer.add_channel(f"/{name}", "json", 0) for name in ("gate", "operator")}
        named = [("gate", each) for each in states] + [("operator", each) for each in asked]
        for name, each in sorted(named, key=lambda pair: pair[1].time):
            data = msgspec.json.encode(asdict(each))
            writer.add_message(channels[name], data, log_time=each.time, publish_time=each.time, sequence=0)
        writer.finish()
    return file


@pytest.mark.parametrize("language", ["en", "de"])
def test_events_are_reported_in_plain_words(drive_log, language):
    words = Words(language)
    told = [event.text for event in run_events(drive_log, words)]
    assert words("ESTOP") + ". " + words("because", cause=words.cause(Cause.EMERGENCY)[0]) in told
    sentence, advice = words.cause(Cause.NOT_ARMED)
    refused = told.index(words("refused", cause=sentence, advice=advice))
    assert told[refused - 1] == words("operator_pressed", what=words("engage"))
    assert told.count(words("operator_pressed", what=words("emergency"))) == 1
    assert told.index(words("operator_pressed", what=words("emergency"))) < len(told) - 2
    assert told[-1].startswith(words("STANDBY"))


def test_a_recorder_that_falls_silent_while_steering_is_an_event_once(tmp_path):
    words, lost = Words("en"), Cause.NOT_RECORDING.value
    silent = [(0, lost), (1, 0), (1, lost), (1, lost), (1, 0), (0, 0)]  # before it steers it is none
    states = [
        {"state": SupervisorState.ACTIVE, "cause": 0, "steers": steers, "refusals": [code]} for steers, code in silent
    ]
    with (tmp_path / "log.mcap").open("wb") as stream:
        writer = ChunkedWriter(stream)
        channel = writer.add_channel("/gate", "json", 0)
        for time, state in enumerate(states):
            data = msgspec.json.encode(state)
            writer.add_message(channel, data, log_time=time * SECOND, publish_time=time * SECOND, sequence=0)
        writer.finish()
    told = [(event.time, event.text) for event in run_events(tmp_path / "log.mcap", words)]
    assert told == [(0.0, words("ACTIVE")), (2.0, words.cause(Cause.NOT_RECORDING)[0])]


def test_the_end_of_a_drive_is_no_fault(tmp_path):
    words = Words("de")
    ended = {"state": SupervisorState.FAULT, "cause": Cause.ENDED.value, "steers": 0, "refusals": []}
    with (tmp_path / "log.mcap").open("wb") as stream:
        writer = ChunkedWriter(stream)
        channel = writer.add_channel("/gate", "json", 0)
        writer.add_message(channel, msgspec.json.encode(ended), log_time=SECOND, publish_time=SECOND, sequence=0)
        writer.finish()
    assert [each.text for each in run_events(tmp_path / "log.mcap", words)] == ["Die Fahrt wurde beendet"]


def test_a_chosen_pass_is_an_event(tmp_path):
    words = Words("en")
    with (tmp_path / "log.mcap").open("wb") as stream:
        writer = ChunkedWriter(stream)
        channel = writer.add_channel("/operator", "json", 0)
        data = msgspec.json.encode({"action": Action.LINE, "nonce": 1, "value": -2.0})
        writer.add_message(channel, data, log_time=SECOND, publish_time=SECOND, sequence=0)
        writer.finish()
    told = [event.text for event in run_events(tmp_path / "log.mcap", words)]
    assert told == [words("operator_pressed", what=words("pass_number")) + " -2"]


@pytest.mark.parametrize("language", ["en", "de"])
def test_a_notice_of_a_sensor_while_steering_is_an_event_with_advice(tmp_path, language):
    words, silent = Words(language), Cause.RECEIVER_SILENT
    gate = {"state": SupervisorState.ACTIVE, "cause": 0, "steers": 1, "refusals": []}
    told = {"status": 0, "notices": [silent.value, 0]}
    with (tmp_path / "log.mcap").open("wb") as stream:
        writer = ChunkedWriter(stream)
        for time, (name, message) in enumerate([("gate", gate), ("controller", told)]):
            channel = writer.add_channel(f"/{name}", "json", 0)
            data = msgspec.json.encode(message)
            writer.add_message(channel, data, log_time=time * SECOND, publish_time=time * SECOND, sequence=0)
        writer.finish()
    sentence, advice = words.cause(silent)
    assert [each.text for each in run_events(tmp_path / "log.mcap", words, is_on=True)] == [
        words("ACTIVE"),
        f"{sentence}. {advice}",
    ]


def test_a_simulated_run_has_no_events_and_a_broken_log_is_refused(runs):
    assert run_events(runs / "first" / "log.mcap", Words("en")) == []
    with pytest.raises(DrawbarError, match="cannot be read"):
        run_events(runs / "broken" / "log.mcap", Words("en"))
    (runs / "broken" / "log.mcap").write_bytes(b"nonsense")
    with pytest.raises(DrawbarError, match="cannot be read"):
        run_events(runs / "broken" / "log.mcap", Words("en"))

    async def test(one):
        (run,) = (each for each in _listed(runs) if each.name == "first")
        with one.user.client:
            await one.page._show_events(run)
        return one.text()

    assert "it was simulated" in on_page(runs, test)
