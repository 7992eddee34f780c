# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""
Diagnosis of rolling element bearings from vibration, without training.

The rooms, from samples to an answer; each uses those before it: ``signal`` (gate, envelopes,
spectra, shaft speed, levels), ``combs`` (lines of the fault orders), ``rules`` (evidence, the
table of rules, confidence), ``machine`` (baseline and trend of one machine) and ``series`` (many
short snapshots of one machine). The files beside them connect the rooms: the `chain` analyses a
`window` and makes its `result`, for a whole `record` or a stream (`streaming`).
"""

from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from bearing_twin.diagnosis.record import diagnose_record
    from bearing_twin.diagnosis.result import Diagnosis, Spectrum
    from bearing_twin.diagnosis.settings import DiagnosisSettings
    from bearing_twin.diagnosis.signal.severity import Severity
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
    """Import a public name on first use: the compiled modules take half a second to import."""
    if name in __all__:
        for module in ('result', 'settings', 'signal.severity', 'streaming', 'record'):
            found = import_module(f'{__name__}.{module}')
            if name in vars(found):
                return getattr(found, name)
    raise AttributeError(f'module {__name__!r} has no attribute {name!r}')


def __dir__() -> list[str]:
    """List the names that are imported on first use with the others."""
    return sorted({*globals(), *__all__})
