# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Diagnosis of one window: the verdict, its evidence and its spectra; or none, and why."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
import math
from typing import TYPE_CHECKING

from bearing_twin.bearing import FAULT_CODES, fault_frequencies, PLACES
from bearing_twin.diagnosis.rules.confidence import Trust
from bearing_twin.diagnosis.signal.severity import Severity
import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from bearing_twin.bearing import Bearing, FaultFrequencies


def _nothing() -> NDArray[np.float32]:
    return np.zeros(0, dtype=np.float32)


def _unknown() -> dict[str, float]:
    return dict.fromkeys(PLACES, math.nan)


@dataclass(frozen=True, kw_only=True)
class Spectrum:
    """Values at equally spaced frequencies, and their local noise floor if there is one."""

    kind: str = 'spectrum'
    """``'spectrum'``: largest amplitude, in ``unit``, in each step of about 1 Hz (see
    :func:`bearing_twin.diagnosis.window.coarse_spectrum`); or ``'squared_envelope_spectrum'``:
    power of the squared envelope relative to that of its mean, at full resolution."""
    unit: str
    start_hz: float = 0.0
    bin_hz: float = math.nan
    band: tuple[float, float] = (0.0, math.nan)
    """Demodulated band, Hz; the whole range for a plain spectrum."""
    values: NDArray[np.float32] = field(default_factory=_nothing)
    floor: NDArray[np.float32] = field(default_factory=_nothing)
    """Local floor of ``values``, same length; empty if there is none."""


@dataclass(frozen=True, kw_only=True)
class Diagnosis:
    """Verdict on one window of vibration; ``Diagnosis.msg`` describes the published fields."""

    result: str
    rule: str
    """Name of the rule of :data:`bearing_twin.diagnosis.rules.table.RULES` that decided;
    'record_gate' if the window was refused, 'another_speed' if the lines of the shaft show at
    another speed than the given one, '' if a series holds an answer that no rule gave."""
    level: str
    faults: tuple[str, ...] = ()
    confidence: float = 0.0
    reasons: tuple[str, ...]
    first_sample: int
    sample_count: int
    sample_rate: float
    shaft_hz_given: float
    shaft_hz: float = math.nan
    slip: float = math.nan
    expected: FaultFrequencies
    fault_hz: float = math.nan
    fault_hz_expected: float = math.nan
    score: dict[str, float] = field(default_factory=_unknown)
    modulation_index: dict[str, float] = field(default_factory=_unknown)
    band: tuple[float, float] = (0.0, math.nan)
    line_hz: NDArray[np.float32] = field(default_factory=_nothing)
    line_level: NDArray[np.float32] = field(default_factory=_nothing)
    severity: Severity
    temperature: float
    smallest_detectable: float = math.nan
    spectrum: Spectrum
    envelope_spectrum: Spectrum
    window: tuple[str, str] | None = None
    """Answer and level of this window alone, if an earlier answer is held; else None."""
    found_hz: dict[str, float] = field(default_factory=dict)
    """Frequency of the clearest comb of each place, Hz, however weak; not in the message."""
    trust: Trust = field(default_factory=Trust)
    """Basis of the confidence; not in the message."""
    kind: str = ''
    """Kind of answer that the confidence belongs to; '' if there is none; not in the message."""

    @property
    def fault_code(self) -> str:
        """Fault code of the result."""
        return FAULT_CODES[self.result]


def insufficient(
    reasons: Sequence[str],
    bearing: Bearing,
    *,
    first_sample: int = 0,
    sample_count: int = 0,
    sample_rate: float = math.nan,
    shaft_hz: float = math.nan,
    temperature: float = math.nan,
    unit: str = '',
    severity: Severity | None = None,
) -> Diagnosis:
    """
    Return an insufficient diagnosis with its reasons, and with the severity if it was measured.

    >>> from bearing_twin.bearing import find_bearing
    >>> verdict = insufficient(['the record is empty'], find_bearing('6307'))
    >>> verdict.result, verdict.level, verdict.reasons
    ('insufficient', 'none', ('the record is empty',))

    """
    return Diagnosis(
        result='insufficient',
        rule='record_gate',
        level='none',
        reasons=tuple(reasons),
        first_sample=first_sample,
        sample_count=sample_count,
        sample_rate=sample_rate,
        shaft_hz_given=shaft_hz,
        expected=fault_frequencies(bearing, shaft_hz),
        severity=severity or Severity(unit=unit),
        temperature=temperature,
        spectrum=Spectrum(unit=unit),
        envelope_spectrum=Spectrum(kind='squared_envelope_spectrum', unit='1'),
    )
