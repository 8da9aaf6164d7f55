"""Errors and refusals in both languages: every one that an operator may meet has a German text, and none is idle."""

import ast
import errno
import math
import os
import re
from pathlib import Path

import pytest

import drawbar
from drawbar import errors
from drawbar.config import load_configuration, recorded_configuration
from drawbar.console.language.errors_de import ERRORS_DE
from drawbar.console.language.translation import Translation
from drawbar.console.language.words import Words
from drawbar.console.set_up_values import GROUPS
from drawbar.console.set_up_words import flaws
from drawbar.errors import DrawbarError
from drawbar.fields.exchange import take_in
from drawbar.geometry import LocalFrame
from drawbar.protocols.ntrip import Answer
from drawbar.transports.connection import Phase

SOURCE = Path(drawbar.__file__).parent
MET = (
    "fields",
    "guidance/importers",
    "guidance/smoothing.py",
    "guidance/demands.py",
    "console",
    "control/plausibility.py",
    "settings.py",
    "vehicle/parameters.py",
    "recording/log.py",
    "recording/tracks.py",
    "recording/columns.py",
    "recording/drive_events.py",
    "recording/frames.py",
    "recording/stream.py",
    "step/layout.py",
    "transports/file.py",
    "transports/udp.py",
)
"""where what is raised may reach an operator"""
CALIBRATION = (
    "driving/preparation/hand_calibration.py",
    "driving/preparation/dead_bands.py",
    "driving/preparation/push_calibration.py",
    "driving/preparation/steering_memory.py",
    "machine/calibration/pushing.py",
    "machine/calibration/plans.py",
    "machine/calibration/valve.py",
    "machine/calibration/loop.py",
    "machine/calibration/zero.py",
    "machine/calibration/scale.py",
    "machine/calibration/mounting.py",
)
"""whose texts are refusals and names"""
NOT_MET = {
    "console/passwords.py",  # of the command line
    "console/language/errors_de.py",
    "console/language/refusals_de.py",
    "console/language/catalogue.py",
    "console/language/catalogue_set_up.py",
    "console/language/causes_de.py",
    "console/language/statuses_de.py",
}
ELSEWHERE = {
    "config.py",  # files and --set of the command line; the numbers that pages change are tried below
    "control/tube/tube.py",  # of the tubes that the step of this very drive has
    "driving/messaging/console_options.py",  # the same
    "driving/processes/drive_processes.py",
    "driving/stand_in/demonstration.py",
    "driving/messaging/process_options.py",
    "guidance/path.py",  # of paths that no file makes
    "machine/hardware/devices.py",  # the drive has them
    "recording/drive_records.py",  # its events are read by drive_events.py
    "simulation.py",  # of runs
}
"""modules that the console imports, and whose errors end the command before it opens, or cannot come from its pages"""
RAISED = {"ValueError", "DamagedLogError"} | {
    name for name, each in vars(errors).items() if isinstance(each, type) and issubclass(each, DrawbarError)
}
"""all of drawbar's errors, and those whose words it takes over"""
GERMAN = Translation(ERRORS_DE)


def skeleton(node):
    """Return a text as it stands in the code, with {} for its values; None: it is none."""
    if isinstance(node, ast.Constant):
        return node.value if isinstance(node.value, str) else None
    if isinstance(node, ast.JoinedStr):
        return "".join(part.value if isinstance(part, ast.Constant) else "{}" for part in node.values)
    return None


def texts(node):
    """Yield the texts of a piece of code, not those within texts, and no docstrings."""
    found = skeleton(node)
    if found is not None:
        yield found
        inner = [part for part in ast.walk(node) if isinstance(part, ast.FormattedValue)]
        for part in inner:
            yield from texts(part.value)
        return
    for child in ast.iter_child_nodes(node):
        if not (isinstance(child, ast.Expr) and isinstance(child.value, ast.Constant)):
            yield from texts(child)


def raised(tree):
    for node in ast.walk(tree):
        if isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id in RAISED and node.args:
            found = skeleton(node.args[0])
            if found is not None:
                yield found


def files(*places):
    for place in places:
        for path in sorted((SOURCE / place).rglob("*.py")) if (SOURCE / place).is_dir() else [SOURCE / place]:
            if str(path.relative_to(SOURCE)) not in NOT_MET:
                yield path


def imported():
    """Yield the modules of drawbar that the console itself imports, as paths of files."""
    for path in (SOURCE / "console").rglob("*.py"):
        for node in ast.walk(ast.parse(path.read_text("utf-8"))):
            if isinstance(node, ast.ImportFrom) and node.module and node.module.startswith("drawbar."):
                file = SOURCE / f"{node.module.removeprefix('drawbar.').replace('.', '/')}.py"
                yield from [str(file.relative_to(SOURCE))] if file.is_file() else []


def test_what_the_console_imports_is_in_german_too_or_never_met_there():
    met = {str(path.relative_to(SOURCE)) for path in files(*MET, *CALIBRATION)}
    others = sorted(set(imported()) - met - NOT_MET)
    assert {each for each in others if list(raised(ast.parse((SOURCE / each).read_text("utf-8"))))} == ELSEWHERE


@pytest.mark.parametrize("path", list(files(*MET)), ids=lambda path: str(path.relative_to(SOURCE)))
def test_every_error_that_an_operator_may_meet_is_in_german_too(path):
    assert [text for text in raised(ast.parse(path.read_text("utf-8"))) if text not in ERRORS_DE] == []


@pytest.mark.parametrize("place", CALIBRATION)
def test_every_refusal_of_a_calibration_is_in_german_too(place):
    found = [text for text in texts(ast.parse((SOURCE / place).read_text("utf-8"))) if " " in text.strip()]
    assert found
    assert [text for text in found if text not in ERRORS_DE] == []


def test_every_reason_for_missing_corrections_is_in_german_too():
    session = SOURCE / "machine/hardware/corrections/session.py"
    told = {text for text in texts(ast.parse(session.read_text("utf-8"))) if re.match("the caster |no |check ", text)}
    told |= {each.value for each in Answer if each is not Answer.STREAM}
    told |= {each.value for each in (Phase.RESOLVING, Phase.CONNECTING, Phase.SECURING)}
    assert len(told) > 15
    assert told - set(ERRORS_DE) == set()
    english = (
        "the caster refuses the user name or the password (401); check what devices.corrections.credentials leads to"
    )
    assert GERMAN(english).startswith("der Caster lehnt Benutzernamen oder Passwort ab (401); prüfen, wohin")
    assert (
        GERMAN("the caster rtk.example.org:2101: no byte for 10 s")
        == "der Caster rtk.example.org:2101: 10 s lang kein Byte"
    )


def test_no_german_text_is_of_an_error_that_is_not_there():
    system = {os.strerror(number) for number in errno.errorcode}
    written = {text for path in files(".") for text in texts(ast.parse(path.read_text("utf-8")))}
    assert set(ERRORS_DE) - written - system == set()


@pytest.mark.parametrize("key", ERRORS_DE)
def test_every_text_takes_its_values_over(key):
    values = [f"value{index}" for index in range(key.count("{}"))]
    english = key.format(*values)
    german = GERMAN(english)
    assert german.count("value") > 0 or not values
    assert german != english or key in ("{} with --set {}", "  {}{}: {}.")


def test_values_are_translated_and_numbers_get_commas():
    text = "a.kml: the boundary has fewer than 3 different points; draw it again"
    assert Words("de").message(text) == "a.kml: die Grenze hat weniger als 3 verschiedene Punkte; neu zeichnen"
    assert Words("en").message(text) == text
    assert "(39,6; -0,8) m" in Words("de").message(
        "line 'a' cannot be made drivable: near (39.6, -0.8) m its curvature stays at 2.5 1/m; at most 0.3 1/m is "
        "allowed: redraw the line without this turn"
    )
    assert "0,42 m" in Words("de").message("A and B are 0.42 m apart; 1 m are needed: drive on, then set B")
    assert Words("de").message("something else: 1.5") == "something else: 1.5"


@pytest.mark.parametrize(
    ("name", "data", "told"),
    [
        ("foto.jpg", b"\xff\xd8\xff", "foto.jpg: hat keinen der Typen"),
        ("foto.kml", b"\xff\xd8\xff", "foto.kml: Byte 0 ist kein Text"),
        ("foto.zip", b"\xff\xd8\xff", "foto.zip: lässt sich nicht entpacken"),
        ("leer.kml", b"<kml><Document/></kml>", "leer.kml: enthält weder eine Linie noch eine Grenze"),
        ("Höfe.json", b"{", "Höfe.json: ist kein gültiges JSON"),
        ("kurz.csv", "line,latitude,longitude\nSüd,50.87,4.7\n".encode(), "kurz.csv: enthält weder eine Linie noch"),
    ],
)
def test_a_wrong_file_is_refused_in_german_by_its_own_name(name, data, told):
    with pytest.raises(DrawbarError) as caught:
        take_in(name, data, LocalFrame(latitude=50.87, longitude=4.7))
    assert Words("de").message(caught.value).startswith(told)


VALUES = [value for _, values in GROUPS for value in values]


@pytest.mark.parametrize("value", VALUES, ids=lambda value: value.key)
def test_a_number_of_the_set_up_that_is_refused_is_so_in_the_units_of_the_page(value):
    configuration, met = load_configuration("articulated").to_toml(), set()
    for number in (-1e9, -10.0, 0.0, 0.001, 10.0, 95.0, 200.0, 4000.0, 1e9, math.nan):
        try:
            recorded_configuration(configuration, [value.change(number)], "articulated")
        except DrawbarError as error:
            shown = {language: flaws(str(error), Words(language)) for language in ("en", "de")}
            assert shown["en"] != shown["de"]
            for text in shown.values():
                assert not text.startswith(value.key)
                assert "--set" not in text
                assert "inf" not in text
            met.add(shown["en"])
    assert met


def test_bounds_are_in_the_units_of_the_page():
    configuration = load_configuration("articulated").to_toml()

    def said(change, language="en"):
        with pytest.raises(DrawbarError) as caught:
            recorded_configuration(configuration, [change], "articulated")
        return flaws(str(caught.value), Words(language))

    assert said("vehicle.wheelbase=40.0") == "A  Wheelbase: must be at most 3000 cm"
    assert said("vehicle.tractor_steering_limit=1.5") == "Front wheels, at most: must be less than 80 °"
    assert said("speed=0.01", "de") == "Fahrtempo: muss mindestens 0,2 km/h sein"
    assert said("vehicle.curvature_limit=-0.1") == "Smallest radius of lines: must be more than 0 m"
    assert said("vehicle.dead_time=nan", "de") == "Totzeit: muss eine Zahl sein"
    two = said("vehicle.trailer_antenna=2.0")
    assert two == "vehicle: trailer_antenna = 2.0 m is ahead of the actuated joint; it must be at most " + (
        "trailer_length = 1.3 m."
    )
