# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""The twin fitted to its machine: path of the sensor, width of a defect, and what is not told."""

from bearing_twin.calibration.answer.result import Calibration, Estimate
from bearing_twin.calibration.fit import fit

__all__ = ['Calibration', 'Estimate', 'fit']
