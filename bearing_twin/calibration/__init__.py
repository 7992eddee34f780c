# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""
The twin fitted to its machine: path of the sensor, width of a defect, and what is not told.

In all functions of this room ``x`` is a record of one axis, shape (n,), at ``sample_rate``, Hz,
and ``situation`` what is known of its machine. ``whole`` is its correlation over all lags,
``measured`` the summary over those of simulated defects, and ``longest`` the greatest time between
the impacts of one passage that is looked for, s. ``unit`` is that of a record, '' if unknown,
``refusal`` why a width is not told, and ``seed`` that of all draws.
"""

from bearing_twin.calibration.answer.result import Calibration, Estimate
from bearing_twin.calibration.fit import fit

__all__ = ['Calibration', 'Estimate', 'fit']
