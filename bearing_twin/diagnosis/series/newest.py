# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""
Level that the newest snapshots of a machine reach, although some may be disturbed.

Shocks of a neighbour, spikes or cavitation can be in any snapshot of a sound machine, and may be
higher than those of a fault. So their height tells nothing; how many snapshots have them does. As
many of the newest snapshots are judged as the earlier ones of the same machine require. A machine
without disturbances has its alarm after four snapshots, for its end may not last longer. In more
than half of the snapshots it is no disturbance, but a fault that comes and goes.
"""

from __future__ import annotations

from collections.abc import Sequence
import math

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view
from numpy.typing import NDArray

FEWEST, MOST = 5, 13
"""Least and largest number of newest snapshots that are judged."""
EARLIER = 60
"""Number of snapshots before the newest ``FEWEST`` that tell how often a limit is reached."""
_REACHED = 3
"""Number of these that reach it for each further snapshot that is judged. With 3, up to 3 of 100
sound machines are alarmed within 1000 snapshots if 1 to 35 % of these are disturbed; with 4, up to
11 (``python -m bearing_twin.studies.disturbed_series``)."""

OFTEN = 36
"""Number of the newest ``EARLIER`` snapshots that a level which comes and goes reaches. With 36, 3
of 100 series of 1000 snapshots are alarmed if 35 % are disturbed, and 99 if half are (the same
study)."""
LATELY = 2
"""Number of the newest ``FEWEST`` snapshots that it still reaches: it ends with a repair."""


def judged(reached: int) -> int:
    """
    Return by how many of the newest snapshots a level is judged.

    ``reached`` of the ``EARLIER`` snapshots before reach its limit.

    >>> [judged(reached) for reached in (0, 1, 15, 60)]
    [5, 6, 10, 13]

    """
    return min(FEWEST + math.ceil(reached / _REACHED), MOST)


def judged_counts(
    levels: Sequence[NDArray[np.float64]], limits: Sequence[float], sound: int
) -> list[int]:
    """
    Return by how many of the newest snapshots each measure is judged.

    Parameters
    ----------
    levels
        Levels of all snapshots, each of shape (measures,), dB.
    limits
        Limit of each measure, dB.
    sound
        Number of snapshots before an alarm; their number without one. Later ones reach the limit
        because of the damage.

    >>> judged_counts([np.full(1, 9.0)] * 6 + [np.zeros(1)] * 10, [6.0], 16)
    [7]

    """
    until = max(sound - FEWEST + 1, 0)
    earlier = np.reshape(levels[max(until - EARLIER, 0) : until], (-1, len(limits)))
    return [judged(count) for count in (earlier >= limits).sum(axis=0).tolist()]


def levels_reached(newest: NDArray[np.float64], counts: Sequence[int]) -> NDArray[np.float64]:
    """
    Return the level of each measure that all but one of its newest snapshots reach.

    A higher level counts if it comes and goes and ``OFTEN`` of them reach it. ``newest`` are the
    levels of up to ``EARLIER`` snapshots, shape (snapshots, measures); ``counts`` says how many of
    them are judged.

    >>> levels_reached(np.array([[0.0], [9.0], [7.0], [0.0], [8.0]]), [4])
    array([7.])
    >>> levels_reached(np.array([[0.0], [9.0], [0.0], [9.0], [9.0]] * 12), [7])
    array([9.])

    """
    staying = np.array([np.sort(newest[-count:, n])[:2][-1] for n, count in enumerate(counts)])
    if len(newest) < EARLIER:
        return staying
    often, lately = np.sort(newest, axis=0)[-OFTEN], np.sort(newest[-FEWEST:], axis=0)[-LATELY]
    found: NDArray[np.float64] = np.maximum(staying, np.minimum(often, lately))
    return found


def lasting(levels: NDArray[np.float64], count: int) -> NDArray[np.float64]:
    """
    Return the level that all but one of a snapshot and the next ones reach, ``count`` in all.

    Single shocks do not raise it. ``levels``, dB, of shape (n,); the last ``count - 1`` have none.

    >>> lasting(np.array([0.0, 9.0, 0.0, 0.0, 9.0, 8.0, 9.0]), 3)
    array([0., 0., 0., 8., 9.])

    """
    found: NDArray[np.float64] = np.sort(sliding_window_view(levels, count), axis=1)[:, 1]
    return found
