# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Blocks as tests of real nodes hear them: when they end, and whether all have come."""

from __future__ import annotations

from itertools import pairwise

KEPT = 1000
DEEP = {f'qos_overrides./{topic}.publisher.depth': KEPT for topic in ('vibration', 'twin_state')}
"""Parameters of a twin whose queues keep what a test that is held up takes late."""


def check_complete(states, blocks, every=1):
    """
    Check that each block published has come, and that the twin counts those it gave up.

    Of each ``every`` blocks at least one has its state.
    """
    for state in states:
        count = state.blocks_published + state.blocks_dropped
        assert state.first_sample == (count - 1) * state.sample_count
    assert all(1 <= b.blocks_published - a.blocks_published <= every for a, b in pairwise(states))
    begin = max(states[0].first_sample, blocks[0].first_sample)
    end = min(states[-1].first_sample, blocks[-1].first_sample)
    of_states, of_blocks = (
        [m.first_sample for m in messages if begin <= m.first_sample <= end]
        for messages in (states, blocks)
    )
    assert of_states == of_blocks if every == 1 else set(of_states) < set(of_blocks)
    counted = {s.first_sample: s.blocks_published for s in states}
    numbers = [(k, counted[first]) for k, first in enumerate(of_blocks) if first in counted]
    assert all(number - k == numbers[0][1] for k, number in numbers)


def block_end(block):
    """Return the time after the last sample of a block, s."""
    stamp = block.header.stamp
    return stamp.sec + stamp.nanosec * 1e-9 + len(block.y) / block.sample_rate
