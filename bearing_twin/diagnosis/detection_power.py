# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""
Smallest race fault that the diagnosis of a window could have shown.

The table comes from simulations with the twin. It is a data file beside this module, written by
``python -m bearing_twin.studies.detection_power OUT.json``.
"""

from __future__ import annotations

import functools
from importlib import resources
import json
import math
from typing import Any

from bearing_twin.diagnosis.signal.acceleration import acceleration_factor
import numpy as np


@functools.cache
def _table() -> dict[str, Any]:
    text = resources.files('bearing_twin.diagnosis').joinpath('detection_power.json')
    table: dict[str, Any] = json.loads(text.read_text('utf-8'))
    return table


def smallest_detectable(
    seconds: float, shaft_hz: float, temperature: float, rms: float, unit: str, d_ball: float
) -> float:
    """
    Return the smallest width of a race fault, mm, that a window could have shown; NaN if none.

    It is the larger of the widths on inner and outer race, scaled with the ball diameter. The
    simulated window is the next shorter one, in seconds and in shaft turns, at the nearest speed,
    temperature and noise. With an unknown unit the middle noise of the table is used. Speeds below
    half the lowest or above twice the highest of the table give NaN.

    Parameters
    ----------
    seconds
        Length of the window.
    shaft_hz
        Hz.
    temperature
        degC; NaN is taken as the lowest of the table.
    rms
        RMS of the signal, in ``unit``.
    unit
        See :func:`bearing_twin.diagnosis.signal.acceleration.acceleration_factor`.
    d_ball
        m.

    >>> smallest_detectable(8.0, 25.0, 30.0, 1.0, 'm/s^2', 0.0135) < 0.5
    True
    >>> smallest_detectable(8.0, 3.0, 30.0, 1.0, 'm/s^2', 0.0135)
    nan

    """
    table = _table()
    speeds = np.asarray(table['shaft_hz'])
    if not 0.5 * speeds[0] <= shaft_hz <= 2.0 * speeds[-1]:
        return math.nan
    speed = int(np.argmin(np.abs(np.log(speeds / shaft_hz))))
    windows = np.asarray(table['window_s'])
    # At least as many seconds, and as many turns, as in the simulated window.
    seconds = min(seconds, seconds * shaft_hz / float(speeds[speed]))
    window = int(np.searchsorted(windows, seconds + 1e-6)) - 1
    if window < 0:
        return math.nan
    noise = rms * acceleration_factor(unit)
    levels = np.asarray(table['noise_m_s2'])
    quiet = len(levels) // 2
    if math.isfinite(noise) and noise > 0.0:
        quiet = int(np.argmin(np.abs(np.log(levels / noise))))
    heat = _nearest(table['temperature_C'], temperature)
    found = [table['smallest_mm'][race][speed][heat][quiet][window] for race in ('inner', 'outer')]
    if None in found:
        return math.nan
    return float(max(found) * d_ball / table['d_ball_m'])


def _nearest(values: list[float], wanted: float) -> int:
    if not math.isfinite(wanted):
        return 0
    return int(np.argmin(np.abs(np.asarray(values) - wanted)))
