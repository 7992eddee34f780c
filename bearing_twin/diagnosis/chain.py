# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""The whole chain on one window, and on a whole record cut into windows."""

from __future__ import annotations

from dataclasses import dataclass, replace
import math
from typing import TYPE_CHECKING

from bearing_twin.bearing import fault_orders
from bearing_twin.diagnosis.comb import (
    accumulate,
    HARMONICS,
    order_spectra,
    OrderSpectra,
)
from bearing_twin.diagnosis.decision import decide, Verdict
from bearing_twin.diagnosis.families import family_order
from bearing_twin.diagnosis.gate import check_record, check_speeds, HEALTHY_TURNS
from bearing_twin.diagnosis.knocks import limit_knocks
from bearing_twin.diagnosis.lines import sideband_ratio
from bearing_twin.diagnosis.report import insufficient, not_shown, report
from bearing_twin.diagnosis.result import (
    Diagnosis,
    FAMILIES,
    Severity,
)
from bearing_twin.diagnosis.settings import DiagnosisSettings
from bearing_twin.diagnosis.severity import measure_severity
from bearing_twin.diagnosis.shaft import (
    refine_shaft_hz,
    resample_to_angle,
    ShaftSpeed,
    varies,
)
from bearing_twin.diagnosis.spectra import band_tree, envelope_spectra, line_cap, whiten
from bearing_twin.errors import BearingTwinError
import numpy as np
from scipy import fft

if TYPE_CHECKING:
    from collections.abc import Sequence

    from bearing_twin.bearing import Bearing
    from bearing_twin.diagnosis.spectra import EnvelopeSpectra
    from numpy.typing import ArrayLike, NDArray

__all__ = [
    'Window',
    'analyse_window',
    'conclude',
    'diagnose_record',
    'highest_fault_order',
]

_TREE_DEPTH = 3
_WINDOW_TURNS = 256.0
_CLEARER = 1.1
_SIDEBANDS_SHOWN = 0.25


@dataclass(frozen=True)
class Window:
    """Analysis of one window, before any decision."""

    orders: OrderSpectra
    speed: ShaftSpeed
    bands: list[tuple[float, float]]
    envelopes: EnvelopeSpectra
    amplitude: NDArray[np.float32]
    """One-sided amplitude spectrum in the signal's unit, bin k at k bin_hz."""
    bin_hz: float
    severity: Severity
    revolutions: float


def highest_fault_order(bearing: Bearing) -> float:
    """Order of the highest fault family."""
    orders = fault_orders(bearing)
    return max(family_order(name, orders) for name in FAMILIES)


def highest_order(bearing: Bearing) -> float:
    """Highest order that the chain looks at: four harmonics of the highest family, with slip."""
    return 1.1 * HARMONICS * highest_fault_order(bearing)


def analyse_window(
    x: NDArray[np.float64],
    sample_rate: float,
    bearing: Bearing,
    shaft_hz: float,
    settings: DiagnosisSettings,
    *,
    unit: str = '',
) -> Window:
    """
    Everything that is computed before windows are averaged and judged.

    The window must have passed :func:`check_record`.
    """
    x = x - x.mean()
    bin_hz = sample_rate / len(x)
    spectrum = fft.rfft(x.astype(np.float32) / np.float32(len(x)))
    severity = measure_severity(
        x,
        spectrum,
        sample_rate,
        unit=unit or settings.unit,
        power_group=settings.power_group,
        mounting=settings.mounting,
    )
    scale = np.float32(1.0) / np.float32(severity.rms)
    limited = limit_knocks(x, sample_rate, fault_orders(bearing).ftf * shaft_hz)
    if limited is x:
        scaled = spectrum * scale
    else:
        scaled = fft.rfft(limited.astype(np.float32) * (scale / np.float32(len(x))))
    width = max(int(8.0 * shaft_hz / bin_hz), 64)
    tree = band_tree(
        len(scaled) - 1,
        bin_hz,
        depth=_TREE_DEPTH,
        narrowest_hz=highest_order(bearing) * shaft_hz,
    )
    envelopes = envelope_spectra(
        whiten(scaled, width, cap=line_cap(len(x) / sample_rate * shaft_hz)),
        tree,
        max_hz=highest_order(bearing) * shaft_hz,
        floor_width=max(int(4.0 * shaft_hz / bin_hz), 32),
    )
    power = scaled.real**2 + scaled.imag**2
    speed = refine_shaft_hz(power, bin_hz, envelopes, shaft_hz, settings.speed_tolerance)
    return Window(
        order_spectra(envelopes, [band[0] for band in tree.bands], speed.shaft_hz, shaft_hz),
        speed,
        tree.bands,
        envelopes,
        2.0 * np.abs(spectrum),
        bin_hz,
        severity,
        len(x) / sample_rate * speed.shaft_hz,
    )


def conclude(
    newest: Window,
    bearing: Bearing,
    *,
    earlier: Sequence[OrderSpectra] = (),
    first_sample: int,
    sample_count: int,
    sample_rate: float,
    shaft_hz_given: float,
    temperature: float = math.nan,
    notes: Sequence[str] = (),
) -> Diagnosis:
    """Judge the mean of several windows; spectra and severity are the newest window's."""
    speed = newest.speed
    windows = [*earlier, newest.orders]
    turns = newest.revolutions * len(windows)
    verdict = decide(accumulate(windows), bearing, speed, turns)
    if speed.shaft_hz != shaft_hz_given:
        # A fault beside an integer order can pass for a shaft that runs a little off: the speed
        # under which the fault shows more clearly is then the right one.
        apart = abs(speed.shaft_hz / shaft_hz_given - 1.0)
        given = ShaftSpeed(shaft_hz_given, max(speed.uncertainty, apart), 0.0, speed.tolerance)
        at_given = accumulate([window.at_given_speed() for window in windows])
        other = decide(at_given, bearing, given, turns)
        clearer = other.level == 'fault' and other.evidence > _CLEARER * verdict.evidence
        if clearer and _mistaken(at_given, other, speed.shaft_hz / shaft_hz_given):
            verdict, newest = other, replace(newest, speed=given)
    if verdict.result == 'healthy' and turns < HEALTHY_TURNS:
        needed = HEALTHY_TURNS / newest.speed.shaft_hz
        text = (
            f'{turns:.0f} shaft turns show strong faults only, and none is there: '
            f'{HEALTHY_TURNS:g} are needed to call it healthy, {needed:.1f} s'
        )
        verdict = replace(
            verdict,
            result='insufficient',
            level='none',
            reasons=(text,),
        )
    verdict = replace(verdict, reasons=(*notes, *verdict.reasons))
    return report(
        verdict,
        newest,
        bearing,
        first_sample=first_sample,
        sample_count=sample_count,
        sample_rate=sample_rate,
        shaft_hz_given=shaft_hz_given,
        temperature=temperature,
    )


def _mistaken(at_given: OrderSpectra, verdict: Verdict, gap: float) -> bool:
    """
    Whether the lines of a fault were mistaken for the harmonics of the shaft.

    They can be where the fault's order is a whole number at the refined speed, unless the fault
    itself has sidebands ``gap`` (refined over given speed) apart: the shaft does turn like that.
    """
    found = verdict.strongest
    if found is None:
        return False
    order = found.order / gap
    if abs(order - round(order)) > 3.0 * at_given.step:
        return False
    refined, given = (
        sideband_ratio(at_given, found.order, found.band, side) for side in (gap, 1.0)
    )
    return refined < max(_CLEARER * given, _SIDEBANDS_SHOWN)


def diagnose_record(
    x: ArrayLike,
    sample_rate: float,
    bearing: Bearing,
    shaft_hz: ArrayLike,
    *,
    speed_tolerance: float | None = None,
    unit: str = '',
    temperature: float = math.nan,
    settings: DiagnosisSettings | None = None,
) -> Diagnosis:
    """
    Diagnose a whole record.

    Parameters
    ----------
    x
        Vibration, one axis, shape (n,), in any unit.
    sample_rate
        Hz.
    bearing
        Geometry.
    shaft_hz
        Shaft speed, Hz; NaN (unknown) gives ``insufficient``. One number, or the speed at each
        sample, shape (n,): where it varies by more than 0.5 % the record is taken over angle.
    speed_tolerance
        Relative tolerance of ``shaft_hz``; by default that of the settings, for one number the
        nameplate's, for a speed that varies from sample to sample the measured one's.
    unit
        Unit of x, for the severity.
    temperature
        Bearing temperature, degC, if known.
    settings
        See :class:`DiagnosisSettings`.

    Raises
    ------
    BearingTwinError
        If x is not one-dimensional, ``shaft_hz`` has neither its shape nor none, or a setting is
        outside its range. A record that cannot be
        diagnosed is no error: the result is ``insufficient`` and the reasons say why.

    """
    settings = settings or DiagnosisSettings()
    if speed_tolerance is not None:
        settings = replace(settings, speed_tolerance=speed_tolerance)
    signal = np.asarray(x, dtype=np.float64)
    if signal.ndim != 1:
        msg = f'x has shape {signal.shape}; give one axis as a 1-D array'
        raise BearingTwinError(msg)
    speeds = np.asarray(shaft_hz, dtype=np.float64)
    if speeds.shape not in ((), signal.shape):
        msg = (
            f'shaft_hz has shape {speeds.shape}, x has {signal.shape}; give one number or one '
            'a sample'
        )
        raise BearingTwinError(msg)
    if speeds.size > 1 and np.ptp(speeds) > 0.0 and speed_tolerance is None:
        settings = replace(settings, speed_tolerance=settings.measured_speed_tolerance)
    mean_hz = float(speeds.mean()) if speeds.size else math.nan
    reasons = check_record(signal, sample_rate, mean_hz, highest_fault_order(bearing))
    if reasons:
        reasons += not_shown(
            signal, sample_rate, mean_hz, temperature=temperature, unit=unit, bearing=bearing
        )
    else:
        reasons = check_speeds(speeds)
    if reasons:
        return insufficient(
            reasons,
            bearing,
            sample_count=len(signal),
            sample_rate=sample_rate,
            shaft_hz=mean_hz,
            temperature=temperature,
            unit=unit,
        )
    if varies(speeds):
        signal, mean_hz = resample_to_angle(signal, sample_rate, speeds)
    turns = len(signal) / sample_rate * mean_hz
    pieces = max(1, round(turns / _WINDOW_TURNS))
    length = fft.prev_fast_len(len(signal) // pieces)
    windows = [
        analyse_window(
            signal[i * length : (i + 1) * length],
            sample_rate,
            bearing,
            mean_hz,
            settings,
            unit=unit,
        )
        for i in range(pieces)
    ]
    return conclude(
        windows[-1],
        bearing,
        earlier=[window.orders for window in windows[:-1]],
        first_sample=0,
        sample_count=len(signal),
        sample_rate=sample_rate,
        shaft_hz_given=mean_hz,
        temperature=temperature,
    )
