# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Diagnosis of rolling element bearings from vibration, without training."""

from bearing_twin.diagnosis.record import diagnose_record
from bearing_twin.diagnosis.result import Diagnosis, Severity, Spectrum
from bearing_twin.diagnosis.settings import DiagnosisSettings
from bearing_twin.diagnosis.streaming import StreamingDiagnoser

__all__ = [
    'Diagnosis',
    'DiagnosisSettings',
    'Severity',
    'Spectrum',
    'StreamingDiagnoser',
    'diagnose_record',
]
