# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""The twin fitted to its machine: path of the sensor, width of a defect, and what is not told."""

from bearing_twin.calibration.fit import fit
from bearing_twin.calibration.result import Calibration, Estimate

__all__ = ['Calibration', 'Estimate', 'fit']
