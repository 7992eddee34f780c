# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""
Fit the twin to its machine: sensor path, width of a defect, and why a width is not identifiable.

In all functions of this package ``x`` is a record of one axis, shape (n,), at ``sample_rate``, Hz,
and ``situation`` describes its machine. ``whole`` is the autocorrelation of its envelope over all
lags, and ``measured`` summarises the lags of simulated defects. ``longest`` is the longest time
between the impacts of one passage that is searched, s. ``unit`` is the unit of a record, '' if
unknown, ``refusal`` the reason why a width is not identifiable, ``seed`` the seed of all draws.

A *passage* is that of a ball over the defect, and the *spacing* is the time or the distance
between its two impacts. A width is *identifiable* if the record determines it.
"""

from bearing_twin.calibration.answer.result import Calibration, Estimate
from bearing_twin.calibration.fit import fit

__all__ = ['Calibration', 'Estimate', 'fit']
