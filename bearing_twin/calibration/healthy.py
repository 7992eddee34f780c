# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""
The smallest defect that a record without one would have shown.

Defects of candidates are simulated, brought to the unit of the record and added to it.
One is shown if the comb of its frequency stands out of the squared envelope spectrum and modulates
the envelope as much as the diagnosis asks of a suspect, or if it doubles the vibration.
"""

from __future__ import annotations

from dataclasses import replace
import math
from typing import NamedTuple, TYPE_CHECKING

from bearing_twin.bearing import fault_frequencies
from bearing_twin.calibration.cloud import unknowns, vibrations
from bearing_twin.calibration.summaries import squared_envelope
from bearing_twin.diagnosis.thresholds import INDEX_SUSPECT
import numpy as np
import numpy.typing as npt
import scipy
from scipy import fft

if TYPE_CHECKING:
    from bearing_twin.calibration.cloud import Situation


FloatArray = npt.NDArray[np.float64]

SHOWN_SHARE = 0.95
"""Least share of the candidates with a wider defect that has to show."""
SHOWN_NEAR, _NEAR = 0.8, 16
"""Least share of so many whose defect is barely wider."""
LOUDER = 2.0
"""RMS over that of the record from which on nobody calls the bearing healthy: 6 dB."""
LOSSES_DB = 20.0, 10.0
"""Most that is supposed to be lost between the twin's housing, which is one rigid mass, and the
sensor: joints and distance take 10 dB and more each. Less only where no defect shows else."""
LOUDER_DB = 20.0
"""Most that a machine of unknown unit is supposed to be louder than the healthy twin, to whose
level it is brought: the healthy machine of CWRU is 17 dB louder."""
_EACH = 128
"""Candidates on each race: a batch of the cloud."""
_SECONDS, _TURNS, _MOST_SECONDS = 1.2, 12.0, 4.0
"""Of the record that is looked at: so many shaft turns, as far as the memory of a small computer
holds 128 candidates."""
_HARMONICS = 3
COMB_OVER_FLOOR = 25.0
"""A line, or the mean of a comb's, over the floor: noise reaches it once in e^25 bins."""
SLIPPED = 0.03
"""Most that slip, with an error of the speed, moves the impacts."""
SPEED_ERROR, LOBE = 0.005, 3.0
"""How far a line of an order of the shaft may lie from it: share of its frequency, and bins of a
spectrum with a Hann window."""
ABOVE_ORDERS = 2.0
"""Least power of an outer race's line at an order of the shaft over the orders beside it: what
swells with the shaft has orders of like height. An outer race that strikes at an order, with less
than they have, is not told from them."""


def shown(x: FloatArray, sample_rate: float, frequency: float) -> bool:
    """
    Whether a comb at a frequency stands out of the squared envelope spectrum of a signal.

    Parameters
    ----------
    x
        Samples, shape (n,).
    sample_rate
        Hz.
    frequency
        Of the impacts, Hz.

    Examples
    --------
    >>> rng = np.random.default_rng(1)
    >>> x = rng.standard_normal(25600)
    >>> shown(x, 25600.0, 64.0)
    False
    >>> x[::400] += 12.0
    >>> shown(x, 25600.0, 64.0)
    True

    """
    envelope, rate = squared_envelope(x, sample_rate)
    spectrum = np.abs(fft.rfft(envelope)) ** 2
    power = spectrum / max(float(spectrum[0]), 1e-300)
    step = rate / len(envelope)
    lines = []
    ratios = []
    for harmonic in range(1, _HARMONICS + 1):
        at = harmonic * frequency / step
        near = power[math.floor(0.99 * at) : math.ceil(1.01 * at) + 1]
        around = power[math.floor(0.8 * at) : math.ceil(1.2 * at) + 1]
        if not len(near):
            break
        lines.append(float(near.max()))
        ratios.append(lines[-1] / max(float(np.median(around)) / math.log(2.0), 1e-300))
    index = 2.0 * math.sqrt(sum(lines))
    return index >= INDEX_SUSPECT and float(np.mean(ratios or [0.0])) >= COMB_OVER_FLOOR


def line_over_floor(x: FloatArray, situation: Situation) -> float:
    """
    Highest line at the frequency of the impacts, whatever their slip, over the floor about it.

    Harmonics are left out: three of an outer race may be two of an inner one. A line of the shaft
    that lies where the part may strike counts as the part's; see `order_of_the_shaft`.

    Parameters
    ----------
    x
        Samples, shape (n,).
    situation
        Of the machine.

    Examples
    --------
    >>> from bearing_twin.calibration.cloud import example
    >>> machine = example()
    >>> x = np.random.default_rng(1).standard_normal(25600)
    >>> line_over_floor(x, machine) < 15.0
    True
    >>> x[::143] += 12.0
    >>> line_over_floor(x, machine) > 100.0
    True

    """
    envelope, rate = squared_envelope(x, situation.sample_rate)
    power = np.abs(fft.rfft(envelope)) ** 2
    hertz = np.arange(len(power)) * rate / len(envelope)
    apart = hertz / situation.strikes - 1.0
    near = np.abs(apart) < SLIPPED
    floor = float(np.median(power[np.abs(apart) < 0.2])) / math.log(2.0)
    return float(power.max(initial=0.0, where=near)) / max(floor, 1e-300)


def order_of_the_shaft(x: FloatArray, situation: Situation) -> int:
    """
    Order of the shaft whose line is the only one where an outer race may strike; 0 if none is.

    A line at an order is the part's if it is higher than those at the orders beside it. That says
    nothing of an inner race, whose own sidebands are there: of 16 twins of a 6307 up to 15 have
    sidebands of half its line and more.

    Parameters
    ----------
    x
        Samples, shape (n,).
    situation
        Of the machine, with a defect of the outer race.

    Examples
    --------
    Noise that swells with orders 1 to 6; the outer race of a 6307 strikes 3.026 times a turn:

    >>> from bearing_twin.bearing import find_bearing
    >>> from bearing_twin.calibration.cloud import Situation
    >>> machine = Situation(
    ...     bearing=find_bearing('6307'), place='outer', shaft_hz=25.0, sample_rate=12800.0
    ... )
    >>> turns = 25.0 * np.arange(51200) / 12800.0
    >>> swelling = 1.0 + 0.1 * np.cos(2.0 * np.pi * np.outer(range(1, 7), turns)).sum(axis=0)
    >>> x = np.random.default_rng(1).standard_normal(51200)
    >>> order_of_the_shaft(swelling * x, machine)
    3
    >>> x[::169] += 12.0
    >>> order_of_the_shaft(x, machine)
    0

    """
    envelope, rate = squared_envelope(x, situation.sample_rate)
    windowed = scipy.signal.windows.hann(len(envelope), sym=False) * (envelope - envelope.mean())
    power = np.abs(fft.rfft(windowed)) ** 2
    step = rate / len(envelope)
    hertz = np.arange(len(power)) * step
    apart = hertz / situation.strikes - 1.0
    floor = float(np.median(power[np.abs(apart) < 0.2])) / math.log(2.0)
    orders = np.round(hertz / situation.shaft_hz)
    away = np.abs(hertz - orders * situation.shaft_hz)
    on_order = (away <= SPEED_ERROR * hertz + LOBE * step) & (orders > 0)
    near = np.abs(apart) < SLIPPED
    order = int(orders[np.argmax(np.where(near & on_order, power, 0.0))])
    own = float(power.max(initial=0.0, where=near & ~on_order))
    if not order or own >= COMB_OVER_FLOOR * floor:
        return 0
    line = float(power.max(initial=0.0, where=near & on_order))
    beside = on_order & (np.abs(orders - order) == 1)
    return order if line < ABOVE_ORDERS * power.max(initial=0.0, where=beside) else 0


class Shown(NamedTuple):
    """The smallest defect that a record would have shown."""

    width_mm: float
    """NaN if none would."""
    loss_db: float
    """Most that is supposed to be lost between housing and sensor."""


def smallest_shown(
    measured: FloatArray, situation: Situation, factor: float, louder_db: float, seed: int
) -> Shown:
    """
    Return the width above which 95 % of race defects would have shown.

    Parameters
    ----------
    measured
        The record, shape (n,).
    situation
        Of the machine.
    factor
        From the record's unit to m/s^2.
    louder_db
        Most that the record is louder than that, dB.
    seed
        Of all draws.

    Examples
    --------
    Quiet noise of 0.01 m/s^2 would have shown the narrowest defect that is tried:

    >>> from bearing_twin.calibration.cloud import example
    >>> machine = example('none')
    >>> quiet = 0.01 * np.random.default_rng(1).standard_normal(12800)
    >>> smallest_shown(quiet, machine, 1.0, 0.0, 0)
    Shown(width_mm=0.1, loss_db=20.0)

    """
    rng = np.random.default_rng([seed, 2])
    seconds = min(max(_SECONDS, _TURNS / situation.shaft_hz), _MOST_SECONDS)
    n = min(len(measured), int(seconds * situation.sample_rate))
    background = measured[:n] - measured[:n].mean()
    rates = fault_frequencies(situation.bearing, situation.shaft_hz, situation.slip)
    limits = np.zeros(len(LOSSES_DB))
    for place in ('inner', 'outer'):
        there = replace(situation, place=place)
        prior = unknowns(there)
        drawn = {name: about.place(rng.random(_EACH)) for name, about in prior.items()}
        # As many from one width to twice as from there to twice that.
        about = replace(prior['defect_width_mm'], logarithmic=True)
        drawn['defect_width_mm'] = about.place(np.arange(_EACH) / _EACH)
        drawn['noise_ratio'] = np.zeros(_EACH)
        candidates = (
            x for batch in vibrations(there, drawn, n / situation.sample_rate, seed) for x in batch
        )
        seen = np.zeros((_EACH, len(LOSSES_DB)), dtype=bool)
        for one, (x, share) in enumerate(zip(candidates, rng.random(_EACH), strict=True)):
            for at, loss_db in enumerate(LOSSES_DB):
                y = background[: len(x)] + x[:n] / factor * 10.0 ** (
                    -share * (loss_db + louder_db) / 20.0
                )
                louder = y.std() > LOUDER * background.std()
                if louder or shown(y, situation.sample_rate, rates.impacts(place)):
                    # And all the more where less is lost.
                    seen[one, at:] = True
                    break
        # Of n candidates that are as wide or wider, k show: k + 1/2 of n + 1 are expected to.
        wider = np.arange(_EACH, 0, -1)
        share_seen = (seen[::-1].cumsum(axis=0)[::-1] + 0.5) / (wider[:, None] + 1.0)
        near = scipy.ndimage.uniform_filter1d(
            seen.astype(np.float64), _NEAR, axis=0, origin=-_NEAR // 2, mode='nearest'
        )
        enough = (share_seen >= SHOWN_SHARE) & (near >= SHOWN_NEAR)
        first = np.argmax(enough, axis=0)
        width = np.where(enough.any(axis=0), drawn['defect_width_mm'][first], math.nan)
        limits = np.maximum(limits, width)
    told = int(np.argmax(np.isfinite(limits)))
    return Shown(float(limits[told]), LOSSES_DB[told])
