# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Knocks that are no bearing's: what does not come back with each turn of the cage."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

__all__ = ['limit_knocks']

_ABOVE = 2.0
_TURNS = 8


def limit_knocks(
    x: NDArray[np.float64], sample_rate: float, cage_hz: float
) -> NDArray[np.float64]:
    """
    Limit single knocks to twice the height that the turns of the cage usually reach.

    Every fault of a bearing strikes at least once a cage turn, so half of the turns at least show
    its height. A knock from elsewhere stands in few of them; a handful of knocks fills the
    squared envelope spectrum with broad ripples that look like combs, and hides true ones.

    Parameters
    ----------
    x
        Samples without their mean, shape (n,).
    sample_rate
        Hz.
    cage_hz
        Turns of the cage a second.

    Returns
    -------
    The samples limited, or ``x`` itself where nothing stands out.

    """
    length = max(round(sample_rate / cage_hz), 1)
    turns = len(x) // length
    if turns < _TURNS:
        return x
    tiles = x[: turns * length].reshape(turns, length)
    heights = np.maximum(tiles.max(axis=1), -tiles.min(axis=1))
    limit = _ABOVE * float(np.median(heights))
    if max(float(x.max()), -float(x.min())) <= limit:
        return x
    return np.clip(x, -limit, limit)
