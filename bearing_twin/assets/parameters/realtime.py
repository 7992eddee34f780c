# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Parameters of nodes that publish in real time: catching up, thresholds, scheduling."""

from __future__ import annotations

from typing import NamedTuple

from bearing_twin.assets.parameters.shared import STATE_RATE, SUBSCRIBERS
from bearing_twin.assets.parameters.spec import fixed, parameter, Spec
from bearing_twin.assets.parameters.twin import FITTED


class Threshold(NamedTuple):
    """A timing statistic with its limits for a warning and for an error."""

    name: str
    """Name of the two parameters, without ``.warn`` and ``.error``."""
    measure: str
    unit: str
    warn: float
    error: float
    highest: float
    text: str
    """Text on /diagnostics for a value above a limit."""


THRESHOLDS = (
    Threshold('lateness', '99th percentile of the lateness', 's', 0.04, 0.2, 10.0,
              '1 % of the blocks are {:.4g} s late or more'),
    Threshold('periodicity.mean_error', 'Deviation of the mean rate of the cycles',
              'Hz', 1.0, 5.0, 1000.0, 'the rate of the cycles is off by {:.4g} Hz'),
    Threshold('periodicity.standard_deviation', 'Standard deviation of the rate of the cycles',
              'Hz', 5.0, 10.0, 1000.0, 'the rate of the cycles varies by {:.4g} Hz'),
    Threshold('execution_time', 'Mean execution time over the period', '', 0.5, 0.9, 10.0,
              'a cycle takes {:.2f} of the period'),
    Threshold('execution_time.standard_deviation',
              'Standard deviation of the execution time over the period', '', 0.25, 0.5, 10.0,
              'what a cycle takes varies by {:.2f} of the period'),
)  # fmt: skip


def _parameters(t: Threshold) -> tuple[Spec, Spec]:
    return (
        parameter(f'{t.name}.warn', t.warn, f'{t.measure} above which /diagnostics warns.',
                  t.unit, 0.0, t.highest),
        parameter(f'{t.name}.error', t.error, f'{t.measure} that is an error.',
                  t.unit, 0.0, t.highest),
    )  # fmt: skip


SPECS = (
    fixed('catch_up_blocks', 25, 'Most blocks published at once after a delay; older ones are '
          'dropped.', '', 1, 100),
    fixed('late_after', 0.02, 'Lateness above which a block counts as late.', 's', 0.001, 10.0),
    *(spec for threshold in THRESHOLDS for spec in _parameters(threshold)),
    fixed('priority', 0, 'Real-time priority (SCHED_FIFO) of the publishing thread; 0: normal.',
          '', 0, 98),
    fixed('lock_memory', False, 'Keep the memory of the process from being swapped out '
          '(mlockall).'),
)  # fmt: skip

PUBLISHING = (*SPECS, SUBSCRIBERS, STATE_RATE, *FITTED)
"""Parameters of a twin node besides those of its twin."""
