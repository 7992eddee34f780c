# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Parameters of the calibration node."""

from __future__ import annotations

from bearing_twin.assets.diagnosis_parameters import SPECS as DIAGNOSIS
from bearing_twin.assets.shared_specs import GEOMETRY, HARDWARE_ID, JOINT, STATE_DIRECTORY
from bearing_twin.assets.spec import Spec

__all__ = ['SPECS']

_SHARED = {spec.name: spec for spec in DIAGNOSIS}

SPECS = (
    _SHARED['bearing'],
    GEOMETRY,
    _SHARED['shaft_hz'],
    JOINT,
    _SHARED['axis'],
    Spec(
        name='load_low',
        default=0.0,
        description='Least radial load; 0: 0.003 of the dynamic rating.',
        unit='N',
        low=0.0,
        high=1e7,
        running=False,
    ),
    Spec(
        name='load_high',
        default=0.0,
        description='Largest radial load; 0: 0.1 of the dynamic rating.',
        unit='N',
        low=0.0,
        high=1e7,
        running=False,
    ),
    Spec(
        name='period',
        default=30.0,
        description='Time between calibrations; longer where one takes over a third of it.',
        unit='s',
        low=1.0,
        high=86400.0,
        running=False,
    ),
    Spec(
        name='window',
        default=6.0,
        description='Length of the record that is fitted.',
        unit='s',
        low=2.0,
        high=60.0,
        running=False,
    ),
    Spec(
        name='candidates',
        default=256,
        description='Machines simulated in each of the two rounds of a fit.',
        low=64,
        high=4096,
        running=False,
    ),
    Spec(
        name='state_name',
        default='',
        description=(
            "File that keeps the healthy twin and its residual, in the state folder; '' for none."
        ),
        running=False,
    ),
    STATE_DIRECTORY,
    HARDWARE_ID,
)
