"""Largest sizes and sums, four numbers at a time, are those of numpy, whatever registers leave over."""

import ctypes

import numpy as np
import pytest

from drawbar.codegen import build
from drawbar.codegen.library import load

MOST_KINDS = 13
SOURCE = f"""
#define NX {MOST_KINDS}
#define NU 0
#include "quads.h"
void largest_sizes(const double *values, int stages, int kinds, double *most)
{{
    largest_of_kinds(values, stages, kinds, most);
}}
void products(const double *a, const double *b, int count, double *sums)
{{
    add_products(a, b, count, sums, sums + 1);
}}
"""
SEED = 7


def pointer(array):
    return array.ctypes.data_as(ctypes.POINTER(ctypes.c_double))


@pytest.fixture(scope="module")
def library():
    return load(build("quads", SOURCE))


@pytest.mark.parametrize("kinds", range(1, MOST_KINDS + 1))
def test_the_largest_sizes_of_all_stages_and_of_what_was_there(library, kinds):
    random = np.random.default_rng([SEED, kinds])
    for stages in range(22):
        for place in np.ndindex(stages, kinds):
            values, before = random.uniform(-1.0, 1.0, (stages, kinds)), random.uniform(0.0, 0.5, kinds)
            values[place] = -9.0  # the largest may be anywhere
            most = before.copy()
            library.largest_sizes(pointer(values), stages, kinds, pointer(most))
            np.testing.assert_array_equal(most, np.maximum(before, np.abs(values).max(axis=0)))


@pytest.mark.parametrize("count", range(12))
def test_products_are_added_with_their_signs_and_as_sizes(library, count):
    a, b = np.random.default_rng([SEED, count]).normal(size=(2, count))
    sums = np.array([1.0, 2.0])
    library.products(pointer(a), pointer(b), count, pointer(sums))
    np.testing.assert_allclose(sums, [1.0 + a @ b, 2.0 + np.abs(a * b).sum()], rtol=1e-13)
