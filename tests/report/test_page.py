import dataclasses
import json
import re
from html.parser import HTMLParser

import numpy as np
import pytest

from drawbar.messages import SupervisorState
from drawbar.recording.drive_events import Became
from drawbar.recording.log import Outcome
from drawbar.report import decimation
from drawbar.report.metrics import compute_metrics
from drawbar.report.page import render_page
from drawbar.report.path_errors import estimated_path_errors, true_path_errors
from drawbar.report.tables import key_figures

SECTIONS = [
    *("map", "errors", "heading", "speed", "hitch", "tractor-steering", "trailer-steering"),
    *("ancillary", "margin", "factors", "angles", "solve-times"),
]


class Elements(HTMLParser):
    """Every element of a page, and the text of its scripts and styles."""

    def __init__(self, page):
        super().__init__()
        self.elements, self.texts, self.visible = [], [], []
        self.feed(page)
        self.close()

    def handle_starttag(self, tag, attrs):
        self.elements.append((tag, dict(attrs)))

    def handle_data(self, data):
        if self.lasttag in ("script", "style"):
            self.texts.append(data)
        else:
            self.visible.append(data)


def render(log, events=()):
    errors = true_path_errors(log)
    metrics = compute_metrics(log, errors if log.has_truth else estimated_path_errors(log))
    return render_page(log, metrics, errors, events)


def data_of(page):
    return json.loads(re.search(r'<script type="application/json" id="page">(.*?)</script>', page).group(1))


@pytest.fixture(scope="module")
def page(run):
    return render(run)


def test_every_section_has_its_place_and_its_figure(page):
    places = {attributes.get("id") for _, attributes in Elements(page).elements}
    data = data_of(page)
    assert list(data["figures"]) == SECTIONS
    assert set(SECTIONS) <= places
    assert all(figure["data"] for figure in data["figures"].values())


def test_nothing_is_loaded_from_anywhere(page):
    parsed = Elements(page)
    loading = {"src", "href", "action", "data", "poster", "srcset", "background"}
    assert not [(tag, names) for tag, names in parsed.elements if loading & names.keys()]
    assert not {"link", "iframe", "img", "base", "object"} & {tag for tag, _ in parsed.elements}
    own = [text for text in parsed.texts if "plotly.js v" not in text[:200]]
    assert len(own) == len(parsed.texts) - 1  # plotly.js itself is on the page
    assert not re.search(r"url\(|@import|fetch\(|XMLHttpRequest|import\(|https?://", "".join(own))


def test_every_axis_of_a_quantity_names_its_unit(page):
    for name, figure in data_of(page)["figures"].items():
        for axis in ("xaxis", "yaxis"):
            title = figure["layout"][axis]["title"]["text"]
            assert re.search(r", (m|cm|m/s|°.*|µs|%)$", title) or (name, title) == ("factors", "Factor")


def test_what_the_estimator_does_not_have_is_not_shown(page):
    names = [trace["name"] for trace in data_of(page)["figures"]["factors"]["data"]]
    assert "μ" in names
    assert "η" not in names  # no bounds: not a parameter of this run's model
    assert "Speed factor μ" in page
    assert "η" not in page.partition("<script>")[0]


def test_a_figure_without_curves_has_no_section(make_run):
    log = make_run(steps=5)
    factors = {"longitudinal_slip": (0.25, 1.0)}
    page = render(dataclasses.replace(log, header=dataclasses.replace(log.header, estimate_bounds=factors)))
    assert list(data_of(page)["figures"]) == [name for name in SECTIONS if name != "angles"]
    assert "Steering offset and side-slip" not in page


@pytest.mark.parametrize("sign", [1, -1])
def test_a_reversed_actuator_is_reported(make_run, sign):
    log = make_run(steps=5)
    vehicle = log.header.vehicle.model_copy(update={"joint_sign": sign})
    page = render(dataclasses.replace(log, header=dataclasses.replace(log.header, vehicle=vehicle)))
    assert ("The actuator is reversed (joint_sign = -1)" in page) == (sign == -1)


def test_missing_fixes_are_gaps(page):
    fixes = next(t for t in data_of(page)["figures"]["map"]["data"] if t.get("name", "").startswith("GPS"))
    assert fixes["x"][305] is None
    assert fixes["x"][299] is not None


def test_a_crashed_run_says_so_and_markup_in_its_reason_is_text(make_run):
    reason = "SolverError: </script><b>x</b> & more"
    page = render(make_run(steps=50, outcome=Outcome(finished=False, reason=reason)))
    assert f"Stopped before the end: {reason}" in "".join(Elements(page).visible)
    assert "<b>x</b>" not in page


def test_a_closing_tag_in_the_data_cannot_end_the_script(make_run):
    log = make_run(steps=5)
    path = dataclasses.replace(log.header.path, label_names=("straight", "</script>", *log.header.path.label_names[2:]))
    header = dataclasses.replace(log.header, path=path)
    page = render(dataclasses.replace(log, header=header))
    shapes = data_of(page)["figures"]["errors"]["layout"]["shapes"]
    assert shapes[0]["legendgroup"] == "</script>"


def test_a_real_machine_shows_what_was_believed(make_run):
    page = render(make_run(truth=False, steps=50))
    assert "a drive does not know the true ones" in page
    assert "Estimated error, cm" in page
    assert "mean estimated error, tractor" in page
    assert "seed 0" not in page
    assert "drawbar drive" in page
    simulated = render(make_run(steps=50))
    assert "stimated error" not in simulated, "a simulation knows the truth"
    assert "seed 0" in simulated
    assert "drawbar run" in simulated
    shown = {t["name"]: t.get("visible", True) for t in data_of(page)["figures"]["errors"]["data"]}
    assert shown == {"Tractor, estimated": True, "Trailer, estimated": True}


def test_a_run_that_died_before_its_first_step_still_renders(make_run):
    page = render(make_run(steps=0))
    assert "Estimated positions: a drive" not in page
    assert list(data_of(page)["figures"]) == [name for name in SECTIONS if name != "margin"]  # no step tells of a tube
    assert "nan" not in "".join(Elements(page).visible).lower()


def test_the_shades_cover_the_curves(run, page):
    path = run.header.path.path()
    shades = data_of(page)["figures"]["errors"]["layout"]["shapes"]
    middles = np.array([0.5 * (shade["x0"] + shade["x1"]) for shade in shades])
    assert path.labels(middles) == ["0.1", "0.1", "0.125", "0.125", "0.15", "0.15"]
    assert path.labels(np.array([shade["x1"] + 0.1 for shade in shades])) == ["straight"] * 6


def test_a_long_run_is_drawn_with_few_points_and_their_times(make_run, monkeypatch):
    monkeypatch.setattr(decimation, "POINTS", 90)
    data = data_of(render(make_run(steps=900)))
    for trace in data["figures"]["speed"]["data"]:
        assert len(trace["x"]) == len(trace["y"]) == len(trace["customdata"]) <= 92
    assert len(data["time"]) == len(data["progress"]) == len(data["tracks"]["tractor"])


def test_what_did_not_happen_is_said_in_words(make_run):
    page = render(make_run(steps=30))
    assert "0 / 0" not in page
    assert "<b>none</b><span>commands changed by the gate</span>" in page


def test_a_drive_that_was_never_steered_shows_no_tables_of_dashes(never_steered):
    text = "".join(Elements(render(never_steered)).visible)
    assert "Solver, µs" in text
    assert "yaw error" not in text


def test_a_run_without_a_step_is_headed_as_a_run_and_a_drive_as_a_drive(make_run):
    nothing = make_run(steps=0)
    blind = dataclasses.replace(
        run := make_run(steps=3), records=tuple(dataclasses.replace(each, truth=None) for each in run.records)
    )
    began = Became(time=0.0, state=SupervisorState.STANDBY, cause=None)
    for log, events, kind in ((nothing, [], "run"), (nothing, [began], "drive"), (blind, [], "drive")):
        assert f"drawbar {kind}" in "".join(Elements(render(log, events)).visible)


def test_of_a_drive_nothing_is_named_that_only_a_simulation_knows(make_run):
    simulated = render(make_run(steps=30))
    driven = render(make_run(truth=False, steps=30))
    for words in ("real-time factor", ", true"):
        assert words in simulated
        assert words not in driven


def with_progress(log, progress):
    def moved(record, place):
        tractor = dataclasses.replace(record.reference.tractor, progress=place)
        return dataclasses.replace(record, reference=dataclasses.replace(record.reference, tractor=tractor))

    records = tuple(moved(record, place) for record, place in zip(log.records, progress, strict=True))
    return dataclasses.replace(log, records=records)


@pytest.mark.parametrize(
    ("places", "over"),
    [
        (np.linspace(0.0, 80.0, 50), "distance"),
        (np.linspace(0.01, -0.02, 50), "time"),  # it stood
        (np.r_[np.nan, np.linspace(40.0, 5.0, 24), np.linspace(5.0, 60.0, 25)], "time"),  # driven back by hand first
        (np.full(50, np.nan), "distance"),
    ],
)
def test_over_the_path_is_drawn_from_least_to_most_and_over_time_where_it_did_not_lead_on(make_run, places, over):
    data = data_of(render(with_progress(make_run(steps=50), places.tolist())))
    assert data["over"] == over
    known = places[np.isfinite(places)]
    span = [known.min(), known.max()] if known.size else [0.0, 1.0]
    assert data["span"] == pytest.approx(span)
    for name in data["along"]:
        assert data["figures"][name]["layout"]["xaxis"]["range"] == data["span"]


def test_large_figures_stand_in_one_line(make_run):
    log = make_run(steps=50)
    metrics = compute_metrics(log, true_path_errors(log))
    shown = dict(key_figures(dataclasses.replace(metrics, length_m=20045.4, duration_s=999.9)))
    assert (shown["distance driven"], shown["duration"]) == ("20045 m", "999.9 s")
