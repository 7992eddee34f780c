# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""The whole chain on one window, and on a whole record cut into windows."""

from __future__ import annotations

from dataclasses import replace
import math
from typing import TYPE_CHECKING

from bearing_twin.diagnosis.comb import accumulate, OrderSpectra
from bearing_twin.diagnosis.evidence import Evidence
from bearing_twin.diagnosis.gate import check_record, check_speeds
from bearing_twin.diagnosis.report import insufficient, not_shown, report
from bearing_twin.diagnosis.rules import decide
from bearing_twin.diagnosis.search import CombSearch
from bearing_twin.diagnosis.settings import DiagnosisSettings
from bearing_twin.diagnosis.shaft import (
    resample_to_angle,
    ShaftSpeed,
    varies,
)
from bearing_twin.diagnosis.sidebands import sideband_ratio
from bearing_twin.diagnosis.window import analyse_window, highest_fault_order, Window
from bearing_twin.errors import BearingTwinError
import numpy as np
from scipy import fft

if TYPE_CHECKING:
    from collections.abc import Sequence

    from bearing_twin.bearing import Bearing
    from bearing_twin.diagnosis.result import Diagnosis
    from bearing_twin.diagnosis.verdict import Verdict
    from numpy.typing import ArrayLike

__all__ = ['conclude', 'diagnose_record']

_WINDOW_TURNS = 256.0
_CLEARER = 1.1
_SIDEBANDS_SHOWN = 0.25


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
    verdict = _verdict(accumulate(windows), bearing, speed, turns)
    if speed.shaft_hz != shaft_hz_given:
        # A fault beside an integer order can pass for a shaft that runs a little off: the speed
        # under which the fault shows more clearly is then the right one.
        apart = abs(speed.shaft_hz / shaft_hz_given - 1.0)
        given = ShaftSpeed(shaft_hz_given, max(speed.uncertainty, apart), 0.0, speed.tolerance)
        at_given = accumulate([window.at_given_speed() for window in windows])
        other = _verdict(at_given, bearing, given, turns)
        clearer = other.level == 'fault' and other.weight > _CLEARER * verdict.weight
        if clearer and _mistaken(at_given, other, speed.shaft_hz / shaft_hz_given):
            verdict, newest = other, replace(newest, speed=given)
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


def _verdict(spectra: OrderSpectra, bearing: Bearing, speed: ShaftSpeed, turns: float) -> Verdict:
    return decide(Evidence(CombSearch(spectra, bearing, speed), turns))


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
