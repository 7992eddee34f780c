# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""
The smallest defect that would have shown in a record without a defect.

Candidate defects are simulated, converted to the unit of the record and added to it. A defect
shows if the harmonics of its frequency stand out of noise in the squared envelope spectrum, and
those of the record alone do not. It also shows if it is louder than the record.
"""

from __future__ import annotations

from dataclasses import replace
import math
from typing import NamedTuple, TYPE_CHECKING

from bearing_twin.calibration.candidates.cloud import unknowns, vibrations
from bearing_twin.calibration.measured.summaries import squared_envelope
from bearing_twin.diagnosis.thresholds import INDEX_SUSPECT
import numpy as np
import numpy.typing as npt
import scipy
from scipy import fft

if TYPE_CHECKING:
    from bearing_twin.calibration.candidates.cloud import Situation


FloatArray = npt.NDArray[np.float64]

CONFIDENCES = 0.95, 0.9, 0.8, 0.7
"""Shares of the candidates with a wider defect that have to show; the first one reached counts."""
_NEAR, _SHORT_OF = 8, 0.15
"""Number of candidates barely wider than the limit, and how far their share may be below the
confidence."""
LOUDER = 1.12
"""RMS of a defect over that of the record from which the record cannot contain it, with 1 dB for
chance."""
LOSS_DB = 20.0
"""Largest loss assumed between the twin's housing, which is one rigid mass, and the sensor, dB:
joints and distance take 10 dB and more each."""
LOUDER_DB = 20.0
"""Largest level assumed of a machine of unknown unit over the healthy twin, to whose level it is
scaled, dB. The healthy machine of CWRU is 17 dB louder."""
_EACH = 64
"""Candidates on each race."""
_MOST_SAMPLES = 1 << 18
"""Most samples of the record that are used."""
CHANCE = 1e-4
"""Share of noise records whose harmonics stand out."""
_HARMONICS = 3
COMB_OVER_FLOOR = 25.0
"""Least ratio of a line, or of the mean of harmonics, to the floor: noise reaches it once in e^25
bins."""
SLIPPED = 0.03
"""Largest relative shift of the impact frequency by slip and an error of the speed."""
SPEED_ERROR, LOBE = 0.005, 3.0
"""Largest distance of a line from its order of the shaft: share of its frequency, and bins of a
spectrum with a Hann window."""
ABOVE_ORDERS = 2.0
"""Least power of an outer race's line at an order of the shaft over the orders beside it: orders
of a modulation by the shaft are about equally high. A weaker line of an outer race that strikes at
an order cannot be told from them."""


class Comb(NamedTuple):
    """Harmonics of a part in the squared envelope spectrum."""

    over_floor: float
    """Mean of the harmonics over the floor about each."""
    chance: float
    """Value of ``over_floor`` that noise alone reaches in `CHANCE` of records."""
    modulation: float
    """Modulation index."""

    @property
    def suspect(self) -> bool:
        """Whether the harmonics are clear enough for the diagnosis to suspect the part."""
        return self.modulation >= INDEX_SUSPECT and self.over_floor >= COMB_OVER_FLOOR


def comb(x: FloatArray, sample_rate: float, frequency: float, orders_of: float = 0.0) -> Comb:
    """
    Return how far the harmonics of a frequency stand out of the squared envelope spectrum.

    Slip may move the ``frequency`` of the impacts, Hz, by `SLIPPED`. The orders of a shaft that
    turns at ``orders_of``, Hz, are left out, even if a defect has lines there; 0: none are.

    Examples
    --------
    >>> rng = np.random.default_rng(1)
    >>> x = rng.standard_normal(25600)
    >>> found = comb(x, 25600.0, 64.0)
    >>> found.over_floor < found.chance, found.suspect
    (True, False)
    >>> x[::400] += 12.0
    >>> comb(x, 25600.0, 64.0).suspect, comb(x, 25600.0, 64.0, 16.0).suspect
    (True, False)

    """
    power, step = _spectrum(x, sample_rate)
    if orders_of:
        power[_on_order(power, step, orders_of)] = 0.0
    lines, ratios, bins = [], [], []
    for harmonic in range(1, _HARMONICS + 1):
        at = harmonic * frequency / step
        near = power[math.floor((1.0 - SLIPPED) * at) : math.ceil((1.0 + SLIPPED) * at) + 1]
        around = power[math.floor(0.8 * at) : math.ceil(1.2 * at) + 1]
        if not len(near):
            break
        lines.append(float(near.max()))
        floor = _floor(around[around > 0.0]) if around.any() else math.inf
        ratios.append(lines[-1] / max(floor, 1e-300))
        bins.append(len(near))
    if not lines:
        return Comb(0.0, math.inf, 0.0)
    # The mean of k noise lines has a gamma distribution, and each is the highest of its bins.
    once = CHANCE / math.prod(bins)
    chance = float(scipy.special.gammainccinv(len(bins), once)) / len(bins)
    return Comb(float(np.mean(ratios)), chance, 2.0 * math.sqrt(sum(lines)))


def _spectrum(x: FloatArray, sample_rate: float) -> tuple[FloatArray, float]:
    """
    Return the squared envelope spectrum over the square of the mean, and its step, Hz.

    A window limits the leakage of the shaft's lines.
    """
    envelope, rate = squared_envelope(x, sample_rate)
    mean = float(envelope.mean())
    window = scipy.signal.windows.hann(len(envelope), sym=False)
    power = np.abs(fft.rfft(window * (envelope - mean))) ** 2
    return power / max((mean * window.sum()) ** 2, 1e-300), rate / len(envelope)


def _floor(power: FloatArray) -> float:
    """Return the mean power of noise: the median of an exponential distribution over ln 2."""
    return float(np.median(power)) / math.log(2.0)


def _on_order(power: FloatArray, step: float, shaft_hz: float) -> npt.NDArray[np.bool_]:
    """Return a mask of the frequencies of a spectrum that may be an order of the shaft."""
    hertz = np.arange(len(power)) * step
    away = np.abs(hertz - np.round(hertz / shaft_hz) * shaft_hz)
    return np.asarray(away <= SPEED_ERROR * hertz + LOBE * step)


def would_show(
    x: FloatArray, added: FloatArray, sample_rate: float, frequency: float, shaft_hz: float
) -> bool:
    """
    Whether a record would have shown a defect whose vibration is ``added``.

    Examples
    --------
    >>> x = np.random.default_rng(1).standard_normal(25600)
    >>> impacts = np.zeros(25600)
    >>> impacts[::400] = 6.0
    >>> [would_show(x, share * impacts, 25600.0, 64.0, 18.0) for share in (1.0, 0.1)]
    [True, False]

    """
    own, orders_of = _own(x, sample_rate, frequency, shaft_hz)
    return bool(added.std() > LOUDER * x.std()) or _stands_out(
        comb(x + added, sample_rate, frequency, orders_of), own
    )


def _own(x: FloatArray, rate: float, frequency: float, shaft_hz: float) -> tuple[Comb, float]:
    """Return a record's own harmonics, and the shaft speed of the orders left out, Hz, or 0."""
    own = comb(x, rate, frequency)
    if own.over_floor < own.chance:
        return own, 0.0
    return comb(x, rate, frequency, shaft_hz), shaft_hz


def _stands_out(with_defect: Comb, own: Comb) -> bool:
    """Whether harmonics are clear that are not clear in the record itself."""
    if own.over_floor < own.chance:
        return with_defect.over_floor >= with_defect.chance
    return with_defect.suspect and not own.suspect


def line_over_floor(x: FloatArray, situation: Situation) -> float:
    """
    Return the highest line at the impact frequency, with any slip, over the floor around it.

    Harmonics are left out: the third of an outer race may be the second of an inner race. A line
    of the shaft within the range of slip counts as the part's; see `order_of_the_shaft`.

    Examples
    --------
    >>> from bearing_twin.calibration.candidates.cloud import example
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
    apart = hertz / situation.impact_rate - 1.0
    near, floor = np.abs(apart) < SLIPPED, _floor(power[np.abs(apart) < 0.2])
    return float(power.max(initial=0.0, where=near)) / max(floor, 1e-300)


def order_of_the_shaft(x: FloatArray, situation: Situation) -> int:
    """
    Return the shaft order that explains the line at the outer race frequency; 0 if none does.

    A line at an order is that of the race if it exceeds the orders beside it by `ABOVE_ORDERS`.
    This does not hold for an inner race, whose own sidebands are at these orders: of 16 twins of a
    6307 up to 15 have sidebands of half its line and more.

    Examples
    --------
    Noise modulated by orders 1 to 6; the outer race of a 6307 strikes 3.026 times a turn:

    >>> from bearing_twin.bearing import find_bearing
    >>> from bearing_twin.calibration.candidates.cloud import Situation
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
    power, step = _spectrum(x, situation.sample_rate)
    hertz = np.arange(len(power)) * step
    apart = hertz / situation.impact_rate - 1.0
    floor = _floor(power[np.abs(apart) < 0.2])
    orders = np.round(hertz / situation.shaft_hz)
    on_order = _on_order(power, step, situation.shaft_hz) & (orders > 0)
    near = np.abs(apart) < SLIPPED
    order = int(orders[np.argmax(np.where(near & on_order, power, 0.0))])
    own = float(power.max(initial=0.0, where=near & ~on_order))
    if not order or own >= COMB_OVER_FLOOR * floor:
        return 0
    line = float(power.max(initial=0.0, where=near & on_order))
    beside = on_order & (np.abs(orders - order) == 1)
    return order if line < ABOVE_ORDERS * power.max(initial=0.0, where=beside) else 0


def between_impacts(x: FloatArray, situation: Situation) -> float:
    """
    Return the highest line at 0.5 or 1.5 times the impact frequency, over the line at it.

    If it is high, the impacts are half as frequent: the given sample rate may be half, or the
    speed twice, the true one. Orders of the shaft are left out, and with them the sidebands of an
    inner race. It is 0 if noise alone may be as high: the line of faint impacts is hardly higher.

    Examples
    --------
    >>> from bearing_twin.calibration.candidates.cloud import example
    >>> machine = example()
    >>> x = np.random.default_rng(1).standard_normal(51200)
    >>> x[::143] += 12.0
    >>> between_impacts(x, machine) < 0.1
    True
    >>> between_impacts(x, replace(machine, shaft_hz=2.0 * machine.shaft_hz)) > 0.5
    True

    """
    power, step = _spectrum(x, situation.sample_rate)
    hertz = np.arange(len(power)) * step
    near = np.abs(hertz / situation.impact_rate - 1.0) < SLIPPED
    line = float(hertz[np.argmax(np.where(near, power, 0.0))])
    own = float(power.max(initial=0.0, where=near))
    away = np.minimum(*(np.abs(hertz - share * line) for share in (0.5, 1.5)))
    between = (away <= LOBE * step) & ~_on_order(power, step, situation.shaft_hz)
    highest = float(power.max(initial=0.0, where=between))
    floor = _floor(power[np.abs(hertz - line) < 0.6 * line])
    by_chance = floor * math.log(max(int(between.sum()), 1) / CHANCE)
    return highest / own if highest > by_chance else 0.0


class DetectableWidth(NamedTuple):
    """The smallest defect that a record would have shown."""

    width_mm: float
    """Width, mm; NaN if none would show."""
    confidence: float
    """Share of the wider defects that show; if the width is NaN, that of the widest eighth."""


def smallest_detectable_width(
    measured: FloatArray, situation: Situation, factor: float, louder_db: float, seed: int
) -> DetectableWidth:
    """
    Return the width above which race defects would have shown, and the share that shows.

    ``factor`` converts the record to m/s^2; the machine may be louder by up to ``louder_db``, dB.

    Examples
    --------
    Quiet noise of 0.01 m/s^2 would have shown the narrowest defect that is tried:

    >>> from bearing_twin.calibration.candidates.cloud import example
    >>> machine = example('none')
    >>> quiet = 0.01 * np.random.default_rng(1).standard_normal(12800)
    >>> smallest_detectable_width(quiet, machine, 1.0, 0.0, 0)
    DetectableWidth(width_mm=0.1, confidence=0.95)

    """
    rng = np.random.default_rng([seed, 2])
    background = measured[:_MOST_SAMPLES] - measured[:_MOST_SAMPLES].mean()
    limits, widest_seen = np.zeros(len(CONFIDENCES)), 1.0
    for place in ('inner', 'outer'):
        there = replace(situation, place=place)
        widths, seen = _candidates_seen(background, there, factor, louder_db, rng, seed)
        limits = np.maximum(limits, _limits(widths, seen))
        widest_seen = min(widest_seen, float(seen[-_NEAR:].mean()))
    if np.isnan(limits).all():
        return DetectableWidth(math.nan, widest_seen)
    first = int(np.argmax(np.isfinite(limits)))
    return DetectableWidth(float(limits[first]), CONFIDENCES[first])


def _candidates_seen(
    background: FloatArray,
    situation: Situation,
    factor: float,
    louder_db: float,
    rng: np.random.Generator,
    seed: int,
) -> tuple[FloatArray, FloatArray]:
    """Return the widths of candidates, mm, ascending, and 1 where one would show, else 0."""
    rate, level = situation.sample_rate, LOUDER * background.std()
    prior = unknowns(situation)
    drawn = {name: about.place(rng.random(_EACH)) for name, about in prior.items()}
    # The widths are uniform in their logarithm.
    about = replace(prior['defect_width_mm'], logarithmic=True)
    drawn['defect_width_mm'] = about.place(np.arange(_EACH) / _EACH)
    drawn['noise_ratio'] = np.zeros(_EACH)
    gains = 10.0 ** (-rng.random(_EACH) * (LOSS_DB + louder_db) / 20.0) / factor
    own, orders_of = _own(background, rate, situation.impact_rate, situation.shaft_hz)
    candidates = (
        x for batch in vibrations(situation, drawn, len(background) / rate, seed) for x in batch
    )
    seen = np.zeros(_EACH)
    for one, (x, gain) in enumerate(zip(candidates, gains, strict=True)):
        added = gain * x
        seen[one] = added.std() > level or _stands_out(
            comb(background[: len(x)] + added, rate, situation.impact_rate, orders_of), own
        )
    return drawn['defect_width_mm'], seen


def _limits(widths: FloatArray, seen: FloatArray) -> FloatArray:
    """Return the width from which enough candidates show for each confidence; NaN: none."""
    # If k of n candidates as wide or wider show, the expected share is (k + 1/2) / (n + 1).
    share_seen = (seen[::-1].cumsum()[::-1] + 0.5) / (np.arange(len(seen), 0, -1) + 1.0)
    near = scipy.ndimage.uniform_filter1d(seen, _NEAR, origin=-_NEAR // 2, mode='nearest')
    least = np.array(CONFIDENCES)[:, None]
    enough = (share_seen >= least) & (near >= least - _SHORT_OF)
    # The few widest candidates are too few for a share.
    enough[:, -_NEAR:] = False
    first = np.argmax(enough, axis=1)
    return np.where(enough.any(axis=1), widths[first], math.nan)
