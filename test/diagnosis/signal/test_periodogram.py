# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Power of the lines of squared envelopes, against a Hann window over time."""

from bearing_twin.diagnosis.signal.periodogram import OverlappingParts, power_of_lines
import numpy as np
import pytest


@pytest.mark.parametrize(
    ('points', 'bands', 'parts', 'lap'),
    [
        (1280, 20, 1, 0),
        (1225, 3, 1, 0),
        (1250, 20, 1, 0),
        (2 * 1009, 5, 1, 0),
        # Parts of a whole whose transform begins with passes of 16 and of 20, and with neither.
        (1280, 20, 8, 64),
        (1280, 20, 2, 32),
        (1280, 20, 5, 16),
        (1440, 20, 3, 16),
        (1280, 20, 8, 12),
        (1280, 20, 8, 160),
        # Passes of 16 would leave a prime length, 313.
        (10_016, 20, 8, 64),
    ],
)
def test_power_of_lines_is_that_under_a_hann_window(rng, points, bands, parts, lap):
    hop = points // parts
    cut = rng.exponential(size=(parts, hop + lap, bands)).astype(np.float32)
    x = cut[:, lap:].reshape(points, bands).astype(float)
    for number in range(1, parts):
        x[number * hop - lap : number * hop] += cut[number, :lap]
    before, power = cut.copy(), np.empty((points // 2 - 1, bands), np.float32)
    for first in range(0, bands, 16):
        power_of_lines(OverlappingParts(list(cut[:, :, first : first + 16]), lap), power, first)
    assert (cut == before).all()
    relative = x / x.mean(axis=0, dtype=float) - 1.0
    window = 1.0 - np.cos(2.0 * np.pi * np.arange(points) / points)
    exact = np.abs(np.fft.rfft(window[:, None] * relative, axis=0) / points) ** 2
    assert power == pytest.approx(exact[1 : points // 2], rel=1e-3, abs=1e-6 * exact.max())
