"""Texts in both languages, and what colours are good for."""

import re
import string
from pathlib import Path

import pytest

import drawbar
from drawbar.console.language.catalogue import TEXTS
from drawbar.console.language.causes_de import CAUSES_DE
from drawbar.console.language.words import Words, language_of
from drawbar.messages import SupervisorState
from drawbar.safety.causes import Cause
from drawbar.signals import FixQuality

CONSOLE = Path(drawbar.__file__).parent / "console"


def fields(text):
    return {name for _, name, _, _ in string.Formatter().parse(text) if name}


def test_every_cause_has_both_languages():
    assert set(CAUSES_DE) == set(Cause)
    for cause, (sentence, advice) in CAUSES_DE.items():
        assert sentence.strip()
        assert advice.strip()
        assert sentence != cause.sentence
        assert Words("de").cause(cause)[0][0].isupper()
        assert Words("en").cause(cause)[0][1:] == cause.sentence[1:]


@pytest.mark.parametrize("key", TEXTS)
def test_both_languages_name_the_same_values(key):
    english, german = TEXTS[key]
    assert fields(english) == fields(german)
    assert english.strip()
    assert german.strip()


def test_every_state_and_quality_has_a_text():
    assert {state.name for state in SupervisorState} <= set(TEXTS)
    assert {f"fix_{quality.name}" for quality in FixQuality} <= set(TEXTS)


def test_every_text_is_used_and_every_used_one_is_there():
    source = "".join(path.read_text("utf-8") for path in CONSOLE.rglob("*.py") if "catalogue" not in path.name)
    states = {state.name for state in SupervisorState} | {f"fix_{quality.name}" for quality in FixQuality}
    assert {key for key in TEXTS if f'"{key}"' not in source} - states == set()
    assert set(re.findall(r'words\("(\w+)"', source)) <= set(TEXTS)


@pytest.mark.parametrize(
    ("accepted", "language"),
    [
        ("de-DE,de;q=0.9,en;q=0.8", "de"),
        ("en-GB,de", "en"),
        ("fr,de;q=0.5", "de"),
        ("fr", "en"),
        ("", "en"),
        ("de", "de"),
    ],
)
def test_the_browsers_first_known_language_is_taken(accepted, language):
    assert language_of(accepted, "en") == language


def test_numbers_are_written_as_in_the_language():
    assert (Words("en").number(1.25, 1), Words("de").number(12.3, 1)) == ("1.2", "12,3")
    assert Words("en").number(-0.01, 1) == "0.0"


def luminance(colour):
    parts = [int(colour[i : i + 2], 16) / 255.0 for i in (1, 3, 5)]
    linear = [part / 12.92 if part <= 0.04045 else ((part + 0.055) / 1.055) ** 2.4 for part in parts]
    return 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]


def contrast(one, other):
    """Return the contrast ratio of WCAG 2.1, 1.4.3."""
    low, high = sorted((luminance(one), luminance(other)))
    return (high + 0.05) / (low + 0.05)


@pytest.mark.parametrize("look", ["light", "dark"])
def test_contrast_is_enough_for_texts_and_more_for_figures(look):
    css = (CONSOLE / "static" / "console.css").read_text("utf-8")
    block = re.search(rf"body\.body--{look} \{{(.*?)\}}", css, re.DOTALL).group(1)
    colours = dict(re.findall(r"--(\w+): (#\w{6})", block))
    fills = dict(re.findall(r"--(\w+)-fill: (#\w{6})", block))
    for ground in ("ground", "panel"):
        assert contrast(colours["ink"], colours[ground]) >= 7.0  # figures
        assert contrast(colours["soft"], colours[ground]) >= 4.5
        assert contrast(colours["edge"], colours[ground]) >= 3.0  # borders of controls
    for tone in ("good", "warn", "bad", "idle"):
        fill = fills.get(tone, colours[tone])
        assert contrast(colours["on"], fill) >= 4.5
        assert contrast(colours[tone], colours["ground"]) >= 3.0
        assert look == "light" or luminance(fill) < 0.08, "large fields do not dazzle in a dark cab"
    assert contrast("#ffffff", "#b00020") >= 4.5  # stop
    for kind, tone in (("positive", "good"), ("warning", "warn")):  # messages; Quasar's own have too little
        assert f".q-notification.bg-{kind} {{ background: var(--{tone}-fill) !important; color: var(--on)" in css
    assert contrast("#ffd800", "#1c1c1c") >= 7.0  # emergency
    curves = re.search(rf"  {look}: \[(.*?)\]", (CONSOLE / "static" / "plots.js").read_text("utf-8")).group(1)
    for curve in re.findall(r"#\w{6}", curves):
        assert contrast(curve, colours["panel"]) >= 4.0
