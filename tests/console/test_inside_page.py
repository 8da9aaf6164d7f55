"""Look inside: any signal of the newest control steps, drawn as it comes."""

import json

import msgspec
import pytest

pytest.importorskip("nicegui", reason="the extra `console` is not installed")
pytest.importorskip("shapefile", reason="the extra `console` is not installed")

from console_stage import staged

from drawbar.console.catalogue import TEXTS
from drawbar.console.signal_history import PRESETS, ShownStep, all_names, series
from drawbar.driving.letters import Step, Sureness, pack
from drawbar.recording.log import encode_special


def test_every_signal_of_a_step_has_a_name_and_a_series(run_log):
    log, _ = run_log
    steps = [ShownStep(record, None) for record in log.records[:50]]
    names = all_names(steps)
    assert len(names) == len(set(names)) > 100
    for preset in PRESETS.values():
        assert set(preset) <= set(names)
    assert set(PRESETS) <= set(TEXTS)
    for name in names:
        points = series(steps, name)
        assert len(points) == 50
        assert points[-1][0] == 0.0
        assert points[0][0] == pytest.approx(-49 * 0.2)
    errors = [value for _, value in series(steps, "reference.trailer.lateral_error")]
    assert errors == pytest.approx([record.reference.trailer.lateral_error for record, *_ in steps], abs=1e-5)
    curvature = [value for _, value in series(steps, "reference.tractor.closest.3")]
    assert curvature == pytest.approx([record.reference.tractor.closest[3] for record, *_ in steps], abs=1e-5)
    assert {value for _, value in series(steps, "controller.lateral_deviation")} == {None}
    assert {value for _, value in series(steps, "no.such")} == {None}
    assert series([], "step") == all_names([]) == []


def drawn(one):
    """Return what the page would send to the browser's chart from now on."""
    sent = []

    def call(name, options, *rest):
        sent.append(json.loads(options.partition("series: ")[2].removesuffix("}")))

    one.page._chart.run_chart_method = call
    return sent


@staged
async def test_chosen_signals_are_drawn_as_steps_come_and_not_while_paused(stage, browser):
    from drawbar.config import load_configuration
    from drawbar.simulation import simulate

    records = simulate(load_configuration("articulated", ["path.radii=[4.0]", "path.straight_length=1.0"]), 1).records
    encoder = msgspec.json.Encoder(enc_hook=encode_special)
    one = await browser().open("/inside")
    sent = drawn(one)

    def step(record):
        stage.run(0.2)
        stage.hear_controller(lateral_deviation=0.02)
        stage.link.hear(pack(Step(time=1, data=encoder.encode(record))))
        one.refresh()

    assert "No control step" in one.text()
    for record in records[:10]:
        step(record)
    assert len(sent) == 10
    assert [line["name"] for line in sent[-1]] == list(PRESETS["plot_errors"])
    assert len(sent[-1][0]["data"]) == 10
    assert "No control step" not in one.text()
    one.page._preset.set_value("plot_certainty")
    assert sent[-1][0]["data"][-1] == [0.0, 0.02]
    assert "measurement.tractor_x" in one.page._names.options
    one.page._names.set_value(["measurement.tractor_x"])
    assert sent[-1][0]["data"][-1][1] == pytest.approx(records[9].measurement.tractor_x, rel=1e-5)
    stage.link.hear(pack(Sureness({"tractor_slip": 0.25})))
    one.page._preset.set_value("plot_slips")
    step(records[10])
    value = records[10].estimate.tractor_slip
    of_slip = [line["data"][-1][1] for line in sent[-1] if line["name"] == "estimate.tractor_slip"]
    assert of_slip == pytest.approx([value, value - 0.25, value + 0.25], abs=1e-5)
    assert [line["lineStyle"]["width"] for line in sent[-1]].count(1) == 2
    before = len(sent)
    one.press("Pause")
    step(records[11])
    assert len(sent) == before
    one.press("Go on")
    step(records[12])
    assert len(sent[-1][0]["data"]) == 13
    assert sent[-1][2]["data"][-1][1] is None  # each step has its own deviations
