"""Look inside: any signal of the newest control steps, by its words, drawn as it comes."""

import json

import pytest

pytest.importorskip("nicegui", reason="the extra `console` is not installed")
pytest.importorskip("shapefile", reason="the extra `console` is not installed")

from console_stage import staged

from drawbar.console import live_plot
from drawbar.console.language.catalogue import TEXTS
from drawbar.console.language.signal_words import QUANTITIES, SECTIONS, signal_words
from drawbar.console.signal_history import PRESETS, Column, ShownStep, all_names, columns, row
from drawbar.driving.messaging.datagrams import EstimateDeviations, PackedStep, pack
from drawbar.step.layout import packed


def test_every_signal_of_a_step_has_a_name_and_a_value(run_log):
    log, _ = run_log
    steps = [ShownStep(record, None) for record in log.records[:50]]
    names = all_names(steps)
    assert len(names) == len(set(names)) > 100
    for preset in PRESETS.values():
        assert set(preset) <= set(names)
    assert set(PRESETS) <= set(TEXTS)
    wanted = columns(steps, names)
    assert wanted == [Column(name) for name in names]
    rows = [row(step, wanted) for step in steps]
    assert [each[0] for each in rows] == pytest.approx([record.measurement.time for record, *_ in steps])

    def drawn(name):
        return [each[1 + names.index(name)] for each in rows]

    errors = [record.reference.trailer.lateral_error for record, *_ in steps]
    assert drawn("reference.trailer.lateral_error") == pytest.approx(errors, abs=1e-5)
    curvature = [record.reference.tractor.closest[3] for record, *_ in steps]
    assert drawn("reference.tractor.closest.3") == pytest.approx(curvature, abs=1e-5)
    assert set(drawn("controller.lateral_deviation")) == {None}
    assert row(steps[0], [Column("no.such")])[1] is None
    assert all_names([]) == columns([], []) == []


def test_every_signal_has_words_of_its_own_in_both_languages(run_log):
    log, _ = run_log
    names = all_names([ShownStep(log.records[0], None)])
    for language in (0, 1):
        called = {name: signal_words(name, language) for name in names}
        assert [name for name, words in called.items() if words == name] == []
        assert len(set(called.values())) == len(names)
    told = "\n".join(signal_words(name, 0) for name in names)
    assert [words for words, *_ in [*QUANTITIES.values(), *SECTIONS.values()] if words not in told] == []
    assert signal_words("measurement.tractor_x", 0) == "East · tractor · measured (m)"
    assert signal_words("measurement.tractor_x", 1) == "Osten · Traktor · gemessen (m)"
    assert signal_words("of.tomorrow", 0) == "of.tomorrow"


class Plot:
    """What a browser would keep and draw."""

    def __init__(self, one, monkeypatch):
        self.pictures, self.lines, self.rows = 0, [], []
        self._one = one
        monkeypatch.setattr(live_plot.ui, "run_javascript", self._run)

    def _run(self, code):
        picture = json.loads(code.partition(", ")[2].removesuffix(")"))
        self.pictures += 1
        if "lines" in picture:
            self.lines, self.rows = picture["lines"], []
        self.new, self.age = len(picture["rows"]), picture["age"]
        self.rows += picture["rows"]
        self._one.page._plot._flow.drawn()

    def values(self, name):
        return [
            each[1 + index] for index, line in enumerate(self.lines) if line["name"] == name for each in self.rows[-1:]
        ]


def test_chosen_signals_are_drawn_as_steps_come_and_not_while_paused(run_log, monkeypatch):
    records = run_log[0].records

    @staged
    async def look(stage, browser):
        one = await browser().open("/inside")
        plot = Plot(one, monkeypatch)

        def step(record):
            stage.run(0.2)
            stage.receive_controller(lateral_deviation=0.02)
            stage.link.receive(pack(PackedStep(time=1, data=packed(record))))
            one.refresh()

        one.refresh()
        assert "has reported nothing" in one.text()
        assert plot.pictures == 0
        for record in records[:10]:
            step(record)
        assert plot.pictures == 10
        assert [line["name"] for line in plot.lines] == [signal_words(name, 0) for name in PRESETS["plot_errors"]]
        assert len(plot.rows) == 10
        assert "No control step" not in one.text()
        stage.run(0.1)
        one.refresh()
        assert (plot.pictures, plot.new) == (11, 0), "it slides between two steps, which are 200 ms apart"
        assert plot.age == pytest.approx(0.1)
        one.page._preset.set_value("plot_certainty")
        assert plot.values("Uncertainty across the line (m)") == [0.02]
        assert len(plot.rows) == 10, "other signals are drawn from the beginning"
        assert (
            one.page._names.options["measurement.tractor_x"] == "East · tractor · measured (m)\nmeasurement.tractor_x"
        )
        one.page._names.set_value(["measurement.tractor_x"])
        assert plot.values("East · tractor · measured (m)") == [pytest.approx(records[9].measurement.tractor_x, 1e-5)]
        stage.link.receive(pack(EstimateDeviations({"tractor_slip": 0.25})))
        one.page._preset.set_value("plot_slips")
        step(records[10])
        value = records[10].estimate.tractor_slip
        name = signal_words("estimate.tractor_slip", 0)
        assert plot.values(name) == pytest.approx([value, value - 0.25, value + 0.25], abs=1e-5)
        assert [line["lineStyle"]["width"] for line in plot.lines].count(1) == 2
        before = plot.pictures
        one.press("Pause")
        step(records[11])
        assert plot.pictures == before
        one.press("Go on")
        step(records[12])
        assert len(plot.rows) == 13
        assert plot.new == 2
        assert plot.values(name)[1:] == [None, None]  # each step has its own deviations

    look()


@staged
async def test_a_browser_that_does_not_draw_is_not_sent_more(stage, browser):
    one = await browser().open("/inside")
    plot = one.page._plot
    for _ in range(2):
        assert plot.may_draw
        with one.user.client:
            plot.draw([], 0.0)
    assert not plot.may_draw
    plot._flow.drawn()
    assert plot.may_draw
