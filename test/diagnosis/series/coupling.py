# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Snapshots of a coupling that no single one tells from the outer race of a 6203."""

import numpy as np

RATE = 25600.0
GIVEN_HZ = 24.75
"""Given speed, 1 % below the true 25 Hz."""


def coupling_snapshot(rng):
    """Return 2 s of noise with three impacts a turn; the outer race has 3.05."""
    t = np.arange(round(2.0 * RATE)) / RATE
    ring = np.exp(-2500.0 * t) * np.sin(2.0 * np.pi * 4000.0 * t)
    train = np.zeros(len(t))
    train[((np.arange(0.0, 149.0) + rng.random()) / 75.0 * RATE).astype(int)] = 5.0
    return rng.standard_normal(len(t)) + np.convolve(train, ring[:2000])[: len(t)]
