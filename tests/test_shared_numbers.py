"""Numbers that stand in Python and in C: both must be the same."""

import re
from importlib import import_module

import pytest

from drawbar.codegen.cache import runtime_sources
from drawbar.driving.fault_detection import stuck_hitch_sensor

DETECTION = "drawbar.driving.fault_detection"
SHARED = [
    ("drawbar.geometry", "GRAVITY", "geometry.h", "GRAVITY"),
    ("drawbar.step.reasons", "_SIDE_SLIP", "hitch_watch.h", "HITCH_SIDE_SLIP"),
    ("drawbar.guidance.path", "LEAST_STRETCH", "line_offset.h", "OFFSET_LEAST_STRETCH"),
    ("drawbar.guidance.smoothing", "_DETAIL", "line_path.h", "LINE_DETAIL"),
    ("drawbar.guidance.smoothing", "_LONGEST_PIECE", "path.h", "PATH_LONGEST"),
    ("drawbar.guidance.smoothing", "_MARGIN", "line_path.h", "LINE_MARGIN"),
    ("drawbar.guidance.smoothing", "_RATE_MARGIN", "line_path.h", "LINE_RATE_MARGIN"),
    ("drawbar.estimation.alignment", "_PLACES", "ground_record.h", "PLACES"),
    ("drawbar.estimation.actuation", "_DEAD_TIMES", "lag_bank.h", "DEAD_TIMES"),
    ("drawbar.estimation.actuation", "_LAGS", "lag_bank.h", "LAGS"),
    ("drawbar.estimation.actuation", "_RATES", "lag_bank.h", "RATES"),
    ("drawbar.estimation.actuation", "_PAST", "lag_bank.h", "PAST"),
    *(
        (f"{DETECTION}.{module}", name, header, macro)
        for module, name, header, macro in (
            ("fault_exclusion", "_FACTOR", "hitch_watch.h", "HITCH_FACTOR"),
            ("fault_exclusion", "_CLIP", "hitch_watch.h", "HITCH_CLIP"),
            ("fault_exclusion", "_PRIOR", "hitch_watch.h", "HITCH_PRIOR"),
            ("fault_exclusion", "_PRIOR_TIME", "hitch_watch.h", "HITCH_PRIOR_TIME"),
            ("stuck_hitch_sensor", "_TURNED", "hitch_watch.h", "HITCH_TURNED"),
            ("stuck_hitch_sensor", "_FINE", "frozen_signal.h", "FROZEN_FINE"),
            ("stuck_hitch_sensor", "_SAMPLES", "frozen_signal.h", "FROZEN_SAMPLES"),
            ("running_rms", "TIME_CONSTANT", "hitch_watch.h", "HITCH_BASELINE"),
            ("running_rms", "MOVES", "hitch_watch.h", "HITCH_SPEED"),
            ("running_rms", "MOVES", "frozen_signal.h", "FROZEN_SPEED"),
        )
    ),
]
"""module and name in Python, header and macro in C"""


def macro_value(header: str, macro: str) -> float:
    defined = re.search(rf"^#define {macro} \(?([-+.\deE]+)", runtime_sources()[header], re.MULTILINE)
    assert defined is not None
    return float(defined[1])


@pytest.mark.parametrize(("module", "name", "header", "macro"), SHARED, ids=[f"{each[1]}-{each[3]}" for each in SHARED])
def test_a_number_of_both_languages_is_the_same_in_both(module, name, header, macro):
    assert macro_value(header, macro) == getattr(import_module(module), name)


def test_a_stuck_hitch_sensor_is_excluded_a_sample_before_the_control_step_ends_its_run():
    assert macro_value("frozen_signal.h", "FROZEN_MARGIN") == stuck_hitch_sensor._MARGIN + 1
