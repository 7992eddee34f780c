# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Diagnosis of rolling element bearings from vibration, without training."""

from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
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


def __getattr__(name: str) -> object:
    """Look a name up where it stands: the compiled half takes half a second to import."""
    if name in __all__:
        for module in ('result', 'settings', 'streaming', 'record'):
            found = import_module(f'{__name__}.{module}')
            if name in vars(found):
                return getattr(found, name)
    msg = f'module {__name__!r} has no attribute {name!r}'
    raise AttributeError(msg)


def __dir__() -> list[str]:
    """Names that are looked up late are listed with the others."""
    return sorted({*globals(), *__all__})
