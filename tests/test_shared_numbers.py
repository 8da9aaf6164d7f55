"""Numbers that stand in Python and in C: both must be the same."""

import re
from importlib import import_module

import pytest

from drawbar.codegen.cache import runtime_sources

SHARED = [
    ("drawbar.geometry", "GRAVITY", "geometry.h", "GRAVITY"),
    ("drawbar.guidance.path", "LEAST_STRETCH", "line_offset.h", "OFFSET_LEAST_STRETCH"),
    ("drawbar.guidance.smoothing", "_DETAIL", "line_path.h", "LINE_DETAIL"),
    ("drawbar.guidance.smoothing", "_MARGIN", "line_path.h", "LINE_MARGIN"),
    ("drawbar.guidance.smoothing", "_RATE_MARGIN", "line_path.h", "LINE_RATE_MARGIN"),
    ("drawbar.estimation.alignment", "_PLACES", "ground_record.h", "PLACES"),
    ("drawbar.estimation.actuation", "_DEAD_TIMES", "lag_bank.h", "DEAD_TIMES"),
    ("drawbar.estimation.actuation", "_LAGS", "lag_bank.h", "LAGS"),
    ("drawbar.estimation.actuation", "_RATES", "lag_bank.h", "RATES"),
    ("drawbar.estimation.actuation", "_PAST", "lag_bank.h", "PAST"),
]
"""module and name in Python, header and macro in C"""


@pytest.mark.parametrize(("module", "name", "header", "macro"), SHARED, ids=[each[3] for each in SHARED])
def test_a_number_of_both_languages_is_the_same_in_both(module, name, header, macro):
    defined = re.search(rf"^#define {macro} ([-+.\deE]+)", runtime_sources()[header], re.MULTILINE)
    assert defined is not None
    assert float(defined[1]) == getattr(import_module(module), name)
