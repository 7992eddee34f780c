# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Blocks of vibration that repeat the one before."""

from __future__ import annotations

from typing import Any, TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray


FEWEST_STEPS = 32
"""Fewest steps from sample to sample in a block that is compared with the one before."""
REPEATED = (
    'its samples are those of the block before: the driver sends each block twice, or hangs; '
    'correct or restart it; a simulation whose period is a block needs noise'
)
"""Why a block is refused that a :class:`RepeatCheck` recognises."""


class RepeatCheck:
    """
    Recognise a block whose samples are those of the block before, which no live sensor gives.

    A driver that sends each block twice, or that has stopped and sends its last buffer again,
    does. Blocks of few steps do not count, as they may be equal by chance: those of a sensor that
    is not connected, or of a machine at rest that changes the last bit of the counts now and then.

    Examples
    --------
    >>> check = RepeatCheck()
    >>> noise = np.random.default_rng(0).normal(size=128)
    >>> [check.repeats(block) for block in (noise, noise[::-1], noise[::-1])]
    [False, False, True]

    """

    def __init__(self) -> None:
        self._former: NDArray[Any] | None = None

    def repeats(self, samples: NDArray[Any]) -> bool:
        """Whether ``samples``, shape (n,) or (channels, n), are those of the last call."""
        former, self._former = self._former, samples
        return (
            former is not None
            and np.array_equal(samples, former)
            and int(np.count_nonzero(samples[..., 1:] != samples[..., :-1])) >= FEWEST_STEPS
        )
