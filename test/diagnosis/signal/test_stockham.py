# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Transforms of columns side by side, against those of numpy in double precision."""

from bearing_twin.diagnosis.signal.stockham import real_columns, transform_rows
import numpy as np
import pytest


@pytest.mark.parametrize(
    'count', [1, 2, 8, 243, 11 * 13, 640, 1225, 1250, 1254, 1620, 2 * 1009, 5120, 6400]
)
def test_columns_transformed_side_by_side_are_those_of_the_library(rng, count):
    rows = rng.standard_normal((count, 32)).astype(np.float32)
    exact = np.fft.fft(rows[:, :16].astype(float) + 1j * rows[:, 16:], axis=0)
    found = transform_rows(rows)
    assert np.abs(found[:, :16] + 1j * found[:, 16:] - exact).max() < 3e-7 * np.abs(exact).max()


@pytest.mark.parametrize('count', [1, 2, 3, 16, 45, 2 * 101, 1344, 3125])
@pytest.mark.parametrize('column', [0, 5])
def test_real_columns_are_those_of_their_lines(rng, count, column):
    exact = rng.standard_normal((count, 16))
    lines = np.fft.rfft(exact, axis=0).conj()
    beside = np.full((len(lines), 2, column + 16), np.nan, np.float32)
    beside[:, 0, column:], beside[:, 1, column:] = lines.real, lines.imag
    found = real_columns(beside, column, count) / count
    assert np.abs(found - exact).max() < 6e-7 * np.abs(exact).max()
