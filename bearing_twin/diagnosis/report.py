# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Make the diagnosis of a window from its verdict, or one without a verdict."""

from __future__ import annotations

import math
from typing import Any, TYPE_CHECKING

from bearing_twin.bearing import fault_frequencies, PLACES
from bearing_twin.diagnosis.detection_power import smallest_detectable
from bearing_twin.diagnosis.result import Diagnosis, Spectrum
from bearing_twin.diagnosis.signal.severity import Severity
from bearing_twin.diagnosis.thresholds import HARMONICS
import numpy as np

if TYPE_CHECKING:
    from collections.abc import Sequence

    from bearing_twin.bearing import Bearing
    from bearing_twin.diagnosis.rules.verdict import Verdict
    from bearing_twin.diagnosis.window import Window
    from numpy.typing import NDArray


def report(
    verdict: Verdict,
    window: Window,
    bearing: Bearing,
    *,
    notes: Sequence[str] = (),
    simulated: bool = False,
    sample_rate: float,
    temperature: float = math.nan,
    **taken: Any,
) -> Diagnosis:
    """
    Return the diagnosis of a window from its verdict and from properties of the samples.

    ``notes`` come before the reasons of the verdict; ``taken`` are further fields of the
    diagnosis. The smallest detectable fault is named only for ``simulated`` samples.

    >>> from bearing_twin.bearing import find_bearing
    >>> from bearing_twin.diagnosis.chain import Excerpt
    >>> from bearing_twin.diagnosis.rules.evidence import Evidence
    >>> from bearing_twin.diagnosis.rules.table import decide
    >>> from bearing_twin.diagnosis.settings import DiagnosisSettings
    >>> noise, bearing = np.random.default_rng(0).standard_normal(51200), find_bearing('6307')
    >>> excerpt = Excerpt.of(noise, 25.0, 25600.0, bearing, DiagnosisSettings())
    >>> window = excerpt.analyse().window
    >>> taken = {'first_sample': 0, 'sample_count': 51200, 'shaft_hz_given': 25.0}
    >>> verdict = report(decide(Evidence.of()), window, bearing, sample_rate=25600.0, **taken)
    >>> verdict.result, verdict.fault_code
    ('healthy', 'BEARING_OK')

    """
    shaft_hz = window.speed.shaft_hz
    expected = fault_frequencies(bearing, shaft_hz)
    strongest = verdict.strongest
    # Without a fault the envelope spectrum of the whole band is shown.
    band = strongest.band if strongest else 0
    values, floor = window.envelopes.power[band], window.envelopes.floor(band)
    line_hz = line_level = np.zeros(0, dtype=np.float32)
    fault_hz = fault_hz_expected = math.nan
    if strongest is not None:
        fault_hz = strongest.order * shaft_hz
        fault_hz_expected = expected.impacts(strongest.place)
        harmonics_hz = fault_hz * np.arange(1, HARMONICS + 1)
        rows = np.clip(
            np.rint(harmonics_hz / window.envelopes.bin_hz).astype(int) - 1, 0, len(values) - 1
        )
        line_hz = harmonics_hz.astype(np.float32)
        line_level = values[rows] / floor[rows]
    unit = window.severity.unit
    smallest, reasons = math.nan, (*notes, *verdict.reasons)
    if simulated:
        smallest = smallest_detectable(
            window.seconds, shaft_hz, temperature, window.severity.rms, unit, bearing.d_ball
        )
    if simulated and verdict.result == 'insufficient':
        shown = f'one {smallest:.2g} mm wide' if math.isfinite(smallest) else 'none is sure to'
        reasons = (*reasons, f'smallest race fault that would have shown: {shown}')
    amplitude, first_hz, group_hz = coarse_spectrum(window.amplitude, window.bin_hz)
    return Diagnosis(
        **taken,
        sample_rate=sample_rate,
        temperature=temperature,
        result=verdict.result,
        rule=verdict.rule,
        level=verdict.level,
        faults=verdict.faults,
        confidence=verdict.confidence,
        reasons=reasons,
        shaft_hz=shaft_hz,
        slip=strongest.slip if strongest else math.nan,
        expected=expected,
        fault_hz=fault_hz,
        fault_hz_expected=fault_hz_expected,
        score={name: verdict.candidates[name].z for name in PLACES},
        modulation_index={name: verdict.candidates[name].index for name in PLACES},
        band=window.bands[band],
        line_hz=line_hz,
        line_level=line_level,
        severity=window.severity,
        smallest_detectable=smallest,
        spectrum=Spectrum(
            kind='spectrum',
            unit=unit,
            start_hz=first_hz,
            bin_hz=group_hz,
            band=(0.0, 0.5 * sample_rate),
            values=amplitude,
        ),
        envelope_spectrum=Spectrum(
            kind='squared_envelope_spectrum',
            unit='1',
            start_hz=window.envelopes.bin_hz,
            bin_hz=window.envelopes.bin_hz,
            band=window.bands[band],
            values=values,
            floor=floor,
        ),
        found_hz={name: c.order * shaft_hz for name, c in verdict.candidates.items()},
        trust=verdict.trust,
        kind=verdict.kind,
    )


def coarse_spectrum(
    amplitude: NDArray[np.float32], bin_hz: float
) -> tuple[NDArray[np.float32], float, float]:
    """
    Return the largest amplitude in each group of bins about 1 Hz wide: lines keep their height.

    For pictures and trends; the decision uses the full resolution.

    Parameters
    ----------
    amplitude
        One-sided amplitude spectrum, bin k at k bin_hz, shape (K,).
    bin_hz
        Hz.

    Returns
    -------
    Amplitudes, the middle of the first group and the spacing of the groups, Hz. Bins wider than
    2/3 Hz are returned as they are.

    >>> amplitude = np.array([1.0, 0.0, 5.0, 0.0, 2.0, 0.0, 0.0, 3.0], np.float32)
    >>> values, first_hz, step_hz = coarse_spectrum(amplitude, 0.25)
    >>> values.tolist(), first_hz, step_hz
    ([5.0, 3.0], 0.375, 1.0)

    """
    group = max(round(1.0 / bin_hz), 1)
    count = -(-len(amplitude) // group)
    padded = np.zeros(count * group, dtype=np.float32)
    padded[: len(amplitude)] = amplitude
    # Along columns: numpy is slow at the maximum of a few neighbours.
    highest = np.ascontiguousarray(padded.reshape(count, group).T).max(axis=0)
    return highest, 0.5 * (group - 1) * bin_hz, group * bin_hz


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
