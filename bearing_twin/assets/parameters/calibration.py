# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Parameters of the calibration node."""

from __future__ import annotations

from bearing_twin.assets.parameters.diagnosis import SPECS as DIAGNOSIS
from bearing_twin.assets.parameters.shared import (
    GEOMETRY,
    HARDWARE_ID,
    JOINT,
    STATE_DIRECTORY,
    STATE_OWNER,
)
from bearing_twin.assets.parameters.spec import fixed

_SHARED = {spec.name: spec for spec in DIAGNOSIS}

SPECS = (
    _SHARED['bearing'],
    GEOMETRY,
    _SHARED['shaft_hz'],
    JOINT,
    _SHARED['axis'],
    fixed('load_low', 0.0, 'Lowest radial load; 0: 0.003 of the dynamic rating.', 'N', 0.0, 1e7),
    fixed('load_high', 0.0, 'Highest radial load; 0: 0.1 of the dynamic rating.', 'N', 0.0, 1e7),
    fixed('period', 30.0, 'Time between calibrations; at least three times the duration of one.',
          's', 1.0, 86400.0),
    fixed('window', 6.0, 'Length of the record that is fitted.', 's', 2.0, 60.0),
    fixed('candidates', 256, 'Machines simulated in each of the two rounds of a fit.',
          '', 64, 4096),
    fixed('state_name', '', 'File in the state folder that keeps the healthy twin and its '
          "residual; '' for none."),
    STATE_DIRECTORY,
    STATE_OWNER,
    HARDWARE_ID,
)  # fmt: skip
