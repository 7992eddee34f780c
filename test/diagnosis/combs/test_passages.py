# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Tests of ball impacts in groups, one group each turn of the cage."""

from bearing_twin.bearing import fault_orders, find_bearing
from bearing_twin.diagnosis.combs.passages import ball_passages
import numpy as np
import pytest


@pytest.mark.parametrize('turns', np.arange(28.5, 31.0, 0.25))
def test_a_short_window_shows_the_groups_at_any_length(turns):
    """The cage's order may lie anywhere between two bins of a window of 30 turns."""
    bearing = find_bearing('6205')
    orders = fault_orders(bearing)
    assert np.median([_significance(bearing, orders, turns, seed) for seed in range(9)]) > 7.0


def _significance(bearing, orders, turns, seed):
    """Return the significance of strikes in half of each cage turn, their phase at random."""
    rng = np.random.default_rng(seed)
    turn = np.linspace(0.0, turns, 2000, endpoint=False)
    cage, spin = (0.98 * order * turn for order in (orders.ftf, orders.impacts('ball')))
    cage = cage + rng.uniform()
    passage = np.floor(cage).astype(int)
    strikes = (spin + rng.uniform(size=passage[-1] + 1)[passage]) % 1.0 < 0.15
    struck = 1.0 + 1.2 * (strikes & (cage % 1.0 < 0.5))
    noise = rng.exponential(size=(len(turn), 13)).astype(np.float32)
    return ball_passages(noise * struck[:, np.newaxis].astype(np.float32), turns, bearing)


@pytest.mark.parametrize('samples', range(16, 50))
def test_envelopes_that_are_sampled_slowly_have_groups_or_no_significance(samples):
    """The fourth harmonic of the ball is at order 18.9, and its group 0.4 orders wide."""
    bearing = find_bearing('6205')
    rng = np.random.default_rng(0)
    noise = rng.exponential(size=(60 * samples, 5)).astype(np.float32)
    found = ball_passages(noise, 60.0, bearing)
    assert (found == 0.0) == (samples < 39)
    assert found < 5.0
