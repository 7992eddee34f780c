# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Change of a twin's impact amplitude with temperature."""

from __future__ import annotations

from dataclasses import replace
import math
from typing import TYPE_CHECKING

from bearing_twin.dynamics.equations.statics import against_load
from bearing_twin.dynamics.single.simulator import Simulator
from bearing_twin.thermal.gcr15 import TABLE_HIGH, TABLE_LOW
import numpy as np
import numpy.typing as npt

if TYPE_CHECKING:
    from bearing_twin.dynamics.parameters import TwinParameters


TOP_SHARE = 0.2
SETTLING, RECORD = 0.4, 3.0
"""Time left out, and length of the record, s: two beats between f_in and 5 f_r at 25.4 Hz."""
RATE = 25600.0
NO_CHANGE = 0.001
"""Integration error: smaller relative changes count as none."""


def impact_amplitude(
    acceleration: npt.NDArray[np.floating], rate: float, impact_hz: float
) -> float:
    """
    Mean of the largest 20 % of the maxima of |a - mean(a)|, m/s^2.

    There is one maximum in each period of ``impact_hz``; the largest fifth are the impacts in the
    load zone. The measure is intended for inner race defects. If ``impact_hz`` is lower than the
    actual impact frequency, a period contains several impacts and the largest counts.

    The acceleration, m/s^2, is at least one period long; both rates are in Hz.

    Examples
    --------
    >>> import numpy as np
    >>> a = np.zeros(1000)
    >>> a[50::100] = [1, -2, 3, -4, 5, -5, 6, -6, 9, -7]
    >>> impact_amplitude(a, 1000.0, 10.0)
    8.0

    """
    deviation = np.abs(acceleration - acceleration.mean())
    period = rate / impact_hz
    edges = np.round(np.arange(int(len(deviation) / period) + 1) * period).astype(int)
    maxima = np.maximum.reduceat(deviation[: edges[-1]], edges[:-1])
    return float(np.sort(maxima)[-max(1, round(TOP_SHARE * len(maxima))) :].mean())


def amplitude_change(parameters: TwinParameters, shaft_hz: float) -> float:
    """
    Return the computed relative change of the impact amplitude from 20 to 110 degC.

    It compares two short runs at constant temperatures. They use the acceleration along the load
    with the sensor, without jitter, noise and cage slip: slip shifts the impacts relative to the
    shaft, which would hide the change in a record of 3 s.

    Below a ``shaft_hz`` of 1 Hz there are too few impacts, and the result is NaN.

    Examples
    --------
    >>> from bearing_twin.dynamics import preset
    >>> amplitude_change(preset('paper'), 25.4) < 0.0 < amplitude_change(preset('incipient'), 25.4)
    True

    """
    if shaft_hz < 1.0:
        return math.nan
    quiet = replace(parameters, jitter=0.0, noise=0.0, slip_model='none')
    (up_x, up_y), found = against_load(quiet), []
    for temperature in (TABLE_LOW, TABLE_HIGH):
        simulator = Simulator(quiet, sample_rate=RATE, temperature=temperature, shaft_hz=shaft_hz)
        simulator.advance(int(SETTLING * RATE), temperature, shaft_hz)
        block = simulator.advance(int(RECORD * RATE), temperature, shaft_hz)
        impact_hz = block.condition.bpfi
        along = up_x * block.x.astype(float) + up_y * block.y.astype(float)
        found.append(impact_amplitude(along, RATE, impact_hz))
    return found[1] / found[0] - 1.0


def trend_sentence(parameters: TwinParameters, shaft_hz: float) -> str:
    """
    Return one line on the change of the impacts with temperature, compared with the paper.

    Examples
    --------
    >>> from bearing_twin.dynamics import preset
    >>> trend_sentence(preset('paper', defect='none'), 25.4)
    'no defect, so there are no impacts'

    """
    if not parameters.defects:
        return 'no defect, so there are no impacts'
    change = amplitude_change(parameters, shaft_hz)
    mode = parameters.thermal_mode
    lead = f'impact amplitude from {TABLE_LOW:g} to {TABLE_HIGH:g} degC in the mode {mode}'
    if math.isnan(change):
        return f'{lead}: not computed below 1 Hz'
    way = 'as the paper states' if change < -NO_CHANGE else "against the paper's statement"
    word = 'falls' if change < -NO_CHANGE else 'rises' if change > NO_CHANGE else 'does not move'
    return (
        f'{lead} at {shaft_hz:g} Hz: {100.0 * change:+.1f} %, it {word}, {way} '
        '(computed at held temperatures, without jitter, noise and slip)'
    )
