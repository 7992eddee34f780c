# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""
Envelope spectra of many short snapshots, averaged over orders.

The power of the squared envelope is averaged with its noise, and the local floor is taken off the
average. The floor of one short snapshot is too uncertain, and its median, log 2 of its mean, would
bias the difference. The average of N floors scatters by 1/sqrt(N).
"""

from __future__ import annotations

from dataclasses import dataclass
import math
from typing import TYPE_CHECKING

from bearing_twin.bearing import fault_orders, PLACES
from bearing_twin.diagnosis.combs.harmonics import MISSING
from bearing_twin.diagnosis.signal.spectra import whiten
from bearing_twin.diagnosis.thresholds import CARRIER, INDEX_FAULT, RIVAL
from bearing_twin.errors import BearingTwinError
import numpy as np
from numpy.typing import NDArray
from scipy import fft
from scipy.ndimage import median_filter

if TYPE_CHECKING:
    from bearing_twin.bearing import Bearing


STEP = 0.05
"""Orders a bin, the resolution of 20 turns. Longer snapshots are reduced to it: a bin has the mean
power over its width, so that no line falls between two bins."""
HIGHEST = 40.0
"""Highest order."""
_GROUPS = (
    ((1000.0,), 4000.0),
    ((2500.0,), 7500.0),
    ((5000.0,), 15000.0),
    (tuple(np.arange(1000.0, 5000.0, 500.0)), 500.0),
    (tuple(np.arange(1000.0, 22000.0, 1000.0)), 1000.0),
)
"""Lower edges of bands and their width, Hz. The wide ones overlap: a resonance across the edge of
two is inside the third, and below a sample rate of 25 kHz the highest band loses most. A resonance
is some hundred Hz wide, so most of a wide band is noise without impacts."""
BANDS = tuple((low, low + width) for lows, width in _GROUPS for low in lows)
"""Edges of the demodulated bands, Hz; a wide one is cut at 0.45 times the sample rate."""
_REACH = 0.8
"""Highest usable envelope frequency over the width of a band: at the full width the noise of the
envelope is zero."""
HARMONICS = 3
_FLOORS, _LEAST_FLOOR = 64, 16
"""Number of blocks of the floor that whitens a snapshot, and least bins of a block."""
_SLIP = 0.03
"""Largest slip of a race or ball that is searched."""
SPEED_ERROR = 0.01
"""Relative error of the given speed up to which strikes of the shaft are taken for no place."""
Z_PLACE = 5.0
"""Significance from which a place is named."""
LEAST_AVERAGED = 20
"""Least number of snapshots in an average that names a place."""


@dataclass(frozen=True)
class Comb:
    """Comb of a fault in an averaged envelope."""

    place: str
    order: float
    z: float
    """Significance: standard deviations over combs at orders of no part of the bearing."""
    snapshots: int
    turns: int
    """Strikes a turn of the shaft that it cannot be told from; 0: it can."""

    def __str__(self) -> str:
        """Return the comb in words."""
        other = f' or {self.turns} strikes a turn' if self.turns else ''
        return (
            f'{self.place}{other}: comb at {self.order:.2f} orders, significance {self.z:.1f}, '
            f'in the average of {self.snapshots} snapshots'
        )


def _lines(order: float) -> NDArray[np.intp]:
    """Return the bins of the harmonics of a comb."""
    return np.asarray(np.rint(order * np.arange(1, HARMONICS + 1) / STEP).astype(int) - 1)


def _at_whole_orders(grid: NDArray[np.float64], resolution: float) -> NDArray[np.bool_]:
    """
    Return which combs may be of whole orders, (G,).

    There a fault cannot be told from blades, a gear or the shaft. Their lines are as wide as the
    resolution, and share power with the bins beside them. The highest harmonic of a comb is
    farthest from theirs.
    """
    turns = np.rint(grid)
    width = (min(resolution, 0.3) + STEP) / HARMONICS
    near: NDArray[np.bool_] = np.abs(grid - turns) < SPEED_ERROR * turns + 0.5 * width
    return near


def _significance(scores: NDArray[np.float64], quiet: NDArray[np.bool_]) -> NDArray[np.float64]:
    """
    Return the significance of each comb in its best band, (G,); -inf where no band has the comb.

    The scores, (bands, G), are compared with those of ``quiet`` combs, which are of no fault.
    """
    null = scores[:, quiet]
    told = np.isfinite(null).sum(axis=1) >= 20
    if not told.any():
        return np.full(scores.shape[1], -math.inf)
    center, high = np.nanquantile(null[told], (0.5, 0.8413), axis=1)[:, :, None]
    z = (scores[told] - center) / np.maximum(high - center, 1e-3)
    return np.asarray(np.fmax.reduce(z, axis=0, initial=-math.inf))


class AveragedEnvelope:
    """
    Mean power of the squared envelope over orders, band by band.

    Examples
    --------
    >>> rng = np.random.default_rng(0)
    >>> average = AveragedEnvelope()
    >>> for _ in range(100):
    ...     average.add(rng.standard_normal(2560), 25600.0, 30.0)
    >>> bool(abs(average.excess().mean()) < 0.05)
    True

    """

    def __init__(self) -> None:
        self._edges = STEP * (np.arange(round(HIGHEST / STEP) + 1) + 0.5)
        self.clear()

    def clear(self) -> None:
        """Forget all snapshots."""
        self.power = np.zeros((len(BANDS), len(self._edges) - 1))
        self.turns = 0.0
        self.count = 0

    def load(self, count: int, turns: float, power: NDArray[np.float64]) -> None:
        """
        Restore a saved average.

        Raises
        ------
        BearingTwinError
            If it is not a valid average of ``count`` snapshots.

        """
        fits = power.shape == self.power.shape and power.dtype == self.power.dtype
        known = count >= 0 and 0.0 <= turns < math.inf and (turns > 0.0 or count == 0)
        if not (fits and known and np.isfinite(power).all() and (power >= 0.0).all()):
            msg = f'saved average of {count} snapshots is invalid; use what save() returned'
            raise BearingTwinError(msg)
        self.count, self.turns, self.power = count, turns, power

    def add(self, x: NDArray[np.float64], sample_rate: float, shaft_hz: float) -> None:
        """Add a snapshot: samples without their mean, shape (n,), their rate and speed in Hz."""
        # Scaled, because squares in a small or large unit exceed single precision.
        spectrum = fft.rfft(x / np.abs(x).max()).astype(np.complex64)
        # Steady lines of gears and converters beat within a band, so they are capped.
        spectrum = whiten(spectrum, max(_LEAST_FLOOR, len(spectrum) // _FLOORS))[0]
        seconds, row = len(x) / sample_rate, 0
        highest = round(0.45 * len(x))
        for lows, width in _GROUPS:
            first = np.rint(np.array(lows) * seconds).astype(int)
            count = min(round(width * seconds), highest - first[0])
            first = first[first + count <= highest]
            if count >= 16:
                # One-sided and shifted to zero: the analytic signal of each band, decimated.
                lines = spectrum[first[:, None] + np.arange(count)]
                rows = slice(row, row + len(first))
                self.power[rows] += self._powers(lines, seconds, shaft_hz)
            row += len(lows)
        self.turns += len(x) / sample_rate * shaft_hz
        self.count += 1

    def _powers(
        self, lines: NDArray[np.complex64], seconds: float, shaft_hz: float
    ) -> NDArray[np.float64]:
        """Return the power over orders of the squared envelopes of ``lines``, (bands, n)."""
        # Twice as many samples: the squared envelope of a band has lines up to its width.
        count = 2 * lines.shape[1]
        envelopes = np.abs(fft.ifft(lines, count)) ** 2
        envelopes = envelopes / np.maximum(envelopes.mean(axis=1, keepdims=True), 1e-30) - 1.0
        # Zero padding gives the spectrum between the bins of so short a snapshot.
        padded = fft.next_fast_len(2 * count, real=True)
        power = np.abs(fft.rfft(envelopes, padded)) ** 2 / count**2
        step_hz = count / (padded * seconds)
        below = np.zeros(power.shape)
        np.cumsum(0.5 * (power[:, 1:] + power[:, :-1]), axis=1, out=below[:, 1:])
        at = self._edges * shaft_hz / step_hz
        told = int(np.searchsorted(at[1:], _REACH * power.shape[1], side='right'))
        at = at[: told + 1]
        left = np.minimum(at.astype(int), power.shape[1] - 2)
        start = below.take(left, axis=1)
        edges = start + (at - left) * (below.take(left + 1, axis=1) - start)
        found = np.zeros((len(lines), len(self._edges) - 1))
        found[:, :told] = np.diff(edges) * step_hz / (STEP * shaft_hz)
        return found

    def join(self, other: AveragedEnvelope) -> None:
        """Add the snapshots of another average."""
        self.power += other.power
        self.turns += other.turns
        self.count += other.count

    def _floor(self) -> NDArray[np.float64]:
        """Return the mean power of the noise, (bands, K)."""
        mean = self.power / max(self.count, 1)
        turns = self.turns / max(self.count, 1)
        # Much wider than a line, but narrow enough to follow the slope of the floor.
        width = 2 * round(max(4.0 / max(turns, 1e-9), 1.5) / STEP) + 1
        floor, ends = np.zeros(mean.shape), np.count_nonzero(mean, axis=1)
        for end in set(ends.tolist()) - {0}:
            # Orders beyond the usable range of a band do not count as quiet.
            rows = mean[ends == end, :end]
            floor[ends == end, :end] = median_filter(
                rows, size=(1, min(width, end | 1)), mode='nearest'
            )
        return floor

    def excess(self) -> NDArray[np.float64]:
        """Return the power over its local floor less one, (bands, K); its mean in noise is 0."""
        mean, floor = self.power / max(self.count, 1), self._floor()
        return np.where(floor > 0.0, mean / np.maximum(floor, 1e-30) - 1.0, 0.0)

    def place(
        self, bearing: Bearing, before: AveragedEnvelope, *, whole: bool = False
    ) -> Comb | None:
        """
        Return the fault that is significant in this average and not in ``before``, or None.

        There is none with too few snapshots, without a significant comb, or if two places cannot
        be told apart at this resolution. A comb that may be of a ``whole`` order is returned only
        if it is asked for.
        """
        if self.count < LEAST_AVERAGED:
            return None
        resolution = self.count / self.turns
        if 1.5 * resolution >= HIGHEST / HARMONICS:
            return None
        excess = self.excess()
        if before.count >= LEAST_AVERAGED:
            # Lines that were there before, of the shaft and of other machines, are no damage.
            excess = excess - np.maximum(before.excess(), 0.0)
        # The step of the highest harmonic is a bin.
        grid = np.arange(1.5 * resolution, HIGHEST / HARMONICS, STEP / HARMONICS)
        shaft, orders = _at_whole_orders(grid, resolution), fault_orders(bearing)
        places = {place: orders.impacts(place) for place in PLACES[:3]}
        places = {place: order for place, order in places.items() if order > 1.5 * resolution}
        quiet = ~shaft
        for order in places.values():
            quiet &= np.abs(grid - order) >= resolution
        z = _significance(self._scores(excess, grid), quiet)
        best = []
        for place, order in places.items():
            reach = max(_SLIP, 0.5 * STEP / order)
            window = np.flatnonzero((whole | ~shaft) & (np.abs(grid / order - 1.0) <= reach))
            if len(window):
                at = window[z[window].argmax()]
                best.append((float(z[at]), place, float(grid[at])))
        best.sort(reverse=True)
        if not best or best[0][0] < Z_PLACE:
            return None
        top, place, order = best[0]
        row = int(np.searchsorted(grid, order))
        if top < z[max(row - HARMONICS, 0) : row + HARMONICS + 1].max():
            # A higher comb just outside the range of a place belongs to another source.
            return None
        for rival, other, at in best[1:]:
            close = abs(places[other] - places[place]) < resolution
            if rival * RIVAL > top and (close or abs(at - order) > STEP):
                return None
        if not self._own(excess, place, order):
            return None
        turns = round(order) if shaft[row] else 0
        return Comb(place, order, top, self.count, turns)

    def _scores(
        self, excess: NDArray[np.float64], grid: NDArray[np.float64]
    ) -> NDArray[np.float64]:
        """Return the score of each comb in each band, (bands, G); NaN above the band's lines."""
        scores = np.zeros((len(BANDS), len(grid)))
        for harmonic in range(1, HARMONICS + 1):
            rows = np.clip(np.rint(harmonic * grid / STEP).astype(int) - 1, 0, excess.shape[1] - 1)
            scores += np.log1p(np.maximum(excess[:, rows], -0.9))
        # The envelope of a band has no lines above its width; the last rows are the highest.
        scores[self.power[:, rows] <= 0.0] = np.nan
        return scores

    def _own(self, excess: NDArray[np.float64], place: str, order: float) -> bool:
        """Return whether a comb has all its harmonics and is no part of a denser series."""
        heights = np.log1p(np.maximum(excess, 0.0))
        band = int(np.argmax(heights[:, _lines(order)].sum(axis=1)))
        own = heights[band, _lines(order)]
        if own.min() < MISSING * own.mean():
            return False
        # A ball that strikes one race only has lines at its spin order.
        denser = [order / share for share in ((3, 4) if place == 'ball' else (2, 3, 4))]
        resolved = [each for each in denser if each * self.turns > 1.5 * self.count]
        return all(heights[band, _lines(each)].sum() * RIVAL <= own.sum() for each in resolved)

    def strong(self, bearing: Bearing, shaft_hz: float) -> Comb | None:
        """
        Return the fault that reaches the modulation index of a fault in a long record, or None.

        It needs no earlier average: a machine may be damaged from the first snapshot on. A comb at
        a whole order counts where no other place shows: it may be strikes in time with the shaft.
        """
        nothing = AveragedEnvelope()
        comb = self.place(bearing, nothing) or self.place(bearing, nothing, whole=True)
        if comb is None:
            return None
        lines = _lines(comb.order)
        rise = np.maximum(self.power / self.count - self._floor(), 0.0)[:, lines].sum(axis=1)
        # The width of a line is a bin, or 1 order over the turns of a snapshot.
        rise *= max(1.0, STEP * self.turns / self.count)
        lowest = np.array([low for low, _ in BANDS])
        if comb.place == 'outer':
            # As in `CombSearch`: lower bands show the variable compliance.
            limit = min(CARRIER * comb.order * shaft_hz, 0.5 * lowest[rise > 0.0].max(initial=0.0))
            rise[lowest < limit] = 0.0
        return comb if 2.0 * math.sqrt(rise.max()) >= INDEX_FAULT else None
