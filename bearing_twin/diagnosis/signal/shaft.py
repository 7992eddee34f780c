# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Shaft speed: refinement of the given value, and angular resampling if it varies."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
import itertools
import math
from typing import Any, NamedTuple, TYPE_CHECKING

from bearing_twin.diagnosis.signal.lines import without_two_highest
from bearing_twin.diagnosis.signal.spectra import local_floor, quantiles
from bearing_twin.diagnosis.thresholds import Z_ELSEWHERE
from bearing_twin.errors import BearingTwinError
from bearing_twin.numerics.compiled import compiled
import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from bearing_twin.diagnosis.signal.spectra import EnvelopeSpectra


SHAFT_FOUND = 5.0
"""Score from which harmonics of the shaft are significant."""

_HARMONICS = 6
_MARGIN = 3.0
_BESIDE = np.concatenate((np.linspace(0.68, 0.73, 64), np.linspace(1.18, 1.23, 64)))
"""Combs of the null, relative to the speed: away from the shaft and its simple fractions."""
_STEADY = 0.005
"""Relative change of a speed from which lines smear."""
_FACTOR = 4.0
"""Largest assumed factor of a wrong given speed: motors have 2, 4, 6 or 8 poles."""
_OTHERS = 2


class ShaftSpeed(NamedTuple):
    """Shaft speed and its uncertainty: exact, or refined by :func:`refine_shaft_hz`."""

    shaft_hz: float
    uncertainty: float = 0.0
    """Relative uncertainty."""
    score: float = 0.0
    """Score of its harmonics: standard deviations over combs beside it; 0 if not looked for."""
    tolerance: float = 0.0
    """Relative tolerance of the given speed; 0: it is exact."""
    spread: float = math.inf
    """Relative distance of the farthest speed within the tolerance with 2/3 of the score."""

    @property
    def shows(self) -> bool:
        """Whether lines of the shaft show within the tolerance of the given speed."""
        return self.score >= SHAFT_FOUND

    @property
    def steady(self) -> bool:
        """Whether they show, and at one speed only."""
        return self.shows and self.spread <= _STEADY


def refine_shaft_hz(
    power: NDArray[np.float32],
    bin_hz: float,
    envelopes: EnvelopeSpectra,
    given_hz: float,
    tolerance: float,
) -> ShaftSpeed:
    """
    Return the shaft speed refined by its harmonics, within the tolerance of the given speed.

    Parameters
    ----------
    power
        Power spectrum of the signal, bin k at k bin_hz, shape (>= 8 given_hz / bin_hz,).
    bin_hz
        Spacing of the bins, Hz.
    envelopes
        Squared envelope spectra of the same window.
    given_hz
        Given speed, Hz.
    tolerance
        Relative tolerance of the given speed, e.g. 0.02; above 0.

    Returns
    -------
    The refined speed, or the given one with its tolerance if no harmonics are significant.

    >>> from bearing_twin.diagnosis.signal.spectra import EnvelopeSpectra
    >>> power = np.ones(2001, np.float32)
    >>> power[1010 * np.arange(1, 7) // 10] = 1e4
    >>> flat = np.ones((2000, 3), np.float32)
    >>> envelopes = EnvelopeSpectra(0.25, flat, flat[:, :2], flat.T, flat.T, 0.0, 1)
    >>> round(refine_shaft_hz(power, 0.25, envelopes, 25.0, 0.02).shaft_hz, 1)
    25.2

    """
    step = bin_hz / (2.0 * _HARMONICS)
    reach = max(tolerance * given_hz, step)
    near = given_hz + np.arange(-int(reach / step), int(reach / step) + 1) * step
    beside = given_hz * _BESIDE
    last = min(int(np.ceil(8.0 * given_hz / bin_hz)), len(power) - 1, len(envelopes.logs))
    low = power[1 : last + 1]
    direct = np.log1p(low / local_floor(low, max(int(4.0 * given_hz / bin_hz), 32)))
    # Numpy's mean of each row takes four times as long.
    indirect = np.einsum('kb->k', envelopes.logs[:last]) / np.float32(envelopes.logs.shape[1])
    both = direct + np.float32(2.0) * indirect[: len(direct)]
    scores = _standardised(_comb(both, bin_hz, near), _comb(both, bin_hz, beside))
    best = float(scores.max())
    if best < SHAFT_FOUND:
        return ShaftSpeed(given_hz, tolerance, best, tolerance)
    # Fault lines and their sidebands beside an integer order look like a shaft at a slightly
    # different speed: only clearly better harmonics replace the given speed.
    if best < scores[len(near) // 2] + _MARGIN:
        shaft_hz = given_hz
    else:
        # Harmonics are rounded to bins: the middle of a run of equal scores is the best estimate.
        ties = near[scores >= best - 1e-9]
        shaft_hz = float(ties[np.argmin(np.abs(ties - np.median(ties)))])
    uncertainty = bin_hz / (2.0 * shaft_hz)
    # If the speed moves, the lines smear, and other speeds have about the same score.
    spread = float(np.abs(near[scores >= best / 1.5] / shaft_hz - 1.0).max())
    return ShaftSpeed(shaft_hz, min(uncertainty, tolerance), best, tolerance, spread)


def _comb(
    logs: NDArray[np.float32], bin_hz: float, hertz: NDArray[np.floating]
) -> NDArray[np.float64]:
    """Return the sum over the harmonics of each fundamental, without the two highest."""
    # A fault order near an integer imitates one harmonic and its double; the shaft has more.
    sums = np.empty(len(hertz))
    without_two_highest(logs, hertz, bin_hz, 1, _HARMONICS, sums)
    return sums


def _standardised(scores: NDArray[Any], null: NDArray[Any]) -> NDArray[Any]:
    """Return scores in upper standard deviations over the median of a null."""
    center, upper = (float(q) for q in quantiles(null))
    return np.asarray((scores - center) / max(upper - center, 1e-3))


def other_shafts_hz(
    power: NDArray[np.float32], bin_hz: float, given_hz: float, tolerance: float
) -> list[float]:
    """
    Return speeds of other shafts if no lines of a shaft show at the given speed.

    The given speed may be that of another shaft, or of a motor with another number of poles.

    Parameters
    ----------
    power, bin_hz, given_hz, tolerance
        As in :func:`refine_shaft_hz`, with ``power`` up to ``24 given_hz``.

    Returns
    -------
    At most two speeds with significant harmonics, Hz, from a quarter to four times the given
    speed: the clearest, and the clearest without the lines of the first, which may be a belt or
    the impacts themselves. Empty if lines of the given speed show.

    >>> power = np.ones(8001, np.float32)
    >>> power[101 * np.arange(1, 7)] = 1e4
    >>> [round(hertz, 1) for hertz in other_shafts_hz(power, 0.25, 40.0, 0.02)]
    [25.2]
    >>> other_shafts_hz(power, 0.25, 25.0, 0.02)
    []

    """
    logs, grid, given = _around(power, bin_hz, given_hz, tolerance)
    found: list[float] = []
    while len(found) < _OTHERS:
        scores = _comb(logs, bin_hz, grid)
        scores = _standardised(scores, scores)
        best = int(np.argmax(scores))
        if scores[best] < Z_ELSEWHERE or scores[given].max() >= SHAFT_FOUND:
            break
        # The middle of a run of equal scores, as in `refine_shaft_hz`.
        row = grid[(scores >= scores[best] - 1e-9) & (np.abs(grid - grid[best]) < bin_hz)]
        found.append(float(np.median(row)))
        _silence(logs, bin_hz, np.arange(found[-1], len(logs) * bin_hz, found[-1]))
    return found


def shafts_instead_hz(
    power: NDArray[np.float32],
    bin_hz: float,
    given_hz: float,
    tolerance: float,
    ranges: Mapping[str, tuple[float, float]],
    known_hz: NDArray[np.float64],
) -> dict[str, float]:
    """
    Return speeds in some ranges whose lines show while those of the given speed do not.

    Lines of both, such as each third one at 1.5 times the speed, are then of the other shaft.

    Parameters
    ----------
    power, bin_hz, given_hz, tolerance
        As in :func:`other_shafts_hz`.
    ranges
        Lowest and highest speed of each range, Hz, by name.
    known_hz
        Lines of something else, Hz, shape (n,); they do not count.

    Returns
    -------
    Speeds, Hz, by the name of their range; without the ranges that have none.

    >>> power = np.ones(8001, np.float32)
    >>> power[101 * np.arange(1, 7)] = 1e4
    >>> known = {'ranges': {'slow': (24.5, 25.5), 'fast': (29.5, 30.5)}, 'known_hz': np.empty(0)}
    >>> found = shafts_instead_hz(power, 0.25, 37.87, 0.02, **known)
    >>> list(found), round(found['slow'], 1)
    (['slow'], 25.2)

    """
    logs, grid, near = _around(power, bin_hz, given_hz, tolerance)
    unknown, given = logs.copy(), grid[near]
    _silence(unknown, bin_hz, known_hz)
    # Of two shafts that share lines the clearer one has them.
    least = _comb(logs, bin_hz, given).max()
    clearer = {}
    for name, (low, high) in ranges.items():
        inside = grid[(grid >= low) & (grid <= high)]
        combs = _comb(unknown, bin_hz, inside)
        if len(combs) and combs.max() > least:
            clearer[name] = float(inside[np.argmax(combs)])
    if not clearer:
        return {}
    null = _comb(unknown, bin_hz, grid)

    def shows(logs: NDArray[np.float32], hertz: NDArray[np.float64]) -> bool:
        """Return whether lines of one of some speeds show."""
        return bool(_standardised(_comb(logs, bin_hz, hertz), null).max() >= SHAFT_FOUND)

    found = {}
    for name, hertz in clearer.items():
        rest = logs.copy()
        _silence(rest, bin_hz, np.arange(hertz, len(rest) * bin_hz, hertz))
        if shows(unknown, np.array([hertz])) and not shows(rest, given):
            found[name] = hertz
    return found


def _around(
    power: NDArray[np.float32], bin_hz: float, given_hz: float, tolerance: float
) -> tuple[NDArray[np.float32], NDArray[np.float64], NDArray[np.bool_]]:
    """Return log spectrum, speeds around a given one, Hz, and which are within its tolerance."""
    low = power[1 : int(_HARMONICS * _FACTOR * given_hz / bin_hz) + 2]
    logs = np.log1p(low / local_floor(low, max(int(2.0 * given_hz / bin_hz), 32)))
    grid = np.arange(given_hz / _FACTOR, _FACTOR * given_hz, bin_hz / (2.0 * _HARMONICS))
    return logs, grid, np.abs(grid / given_hz - 1.0) <= tolerance + bin_hz / given_hz


def _silence(logs: NDArray[np.float32], bin_hz: float, lines_hz: NDArray[np.float64]) -> None:
    """Remove lines from a log spectrum."""
    near = np.rint(lines_hz / bin_hz).astype(np.intp)[:, None] + np.arange(-3, 2)
    logs[np.clip(near, 0, len(logs) - 1)] = 0.0


class SpeedProfile(NamedTuple):
    """
    Speed of the shaft during each part of a window.

    >>> profile = SpeedProfile(np.array([25.0, 26.0]), np.array([300, 100]))
    >>> profile.mean_hz, profile.varies
    (25.25, True)

    """

    shaft_hz: NDArray[np.float64]
    """Speed during each part, Hz, shape (b,)."""
    lengths: NDArray[np.intp]
    """Number of samples of each part, shape (b,)."""

    @property
    def mean_hz(self) -> float:
        """Mean speed, Hz; NaN without samples."""
        count = int(self.lengths.sum())
        return float((self.shaft_hz * self.lengths).sum()) / count if count else math.nan

    @property
    def varies(self) -> bool:
        """Whether the speed varies so much that lines smear."""
        return bool(np.ptp(self.shaft_hz) > _STEADY * self.mean_hz)

    def parts(self, edges: Sequence[int] | NDArray[np.intp]) -> list[SpeedProfile]:
        """
        Return the speed from each sample of ``edges`` to before the next one.

        >>> profile = SpeedProfile(np.array([25.0, 26.0]), np.array([300, 100]))
        >>> [part.lengths.tolist() for part in profile.parts([0, 250, 400])]
        [[250], [50, 100]]

        """
        # Summed once: with a speed for each sample of an hour this takes a second.
        ends = np.cumsum(self.lengths)
        found = []
        for begin, end in itertools.pairwise(edges):
            some = slice(ends.searchsorted(begin, 'right'), ends.searchsorted(end) + 1)
            starts = ends[some] - self.lengths[some]
            lengths = np.minimum(ends[some], end) - np.maximum(starts, begin)
            found.append(SpeedProfile(self.shaft_hz[some][lengths > 0], lengths[lengths > 0]))
        return found

    def equal_angles(self, count: int) -> NDArray[np.float64]:
        """
        Return the fractional sample at which each of ``count`` equal parts of the angle begins.

        >>> SpeedProfile(np.array([20.0, 40.0]), np.array([100, 100])).equal_angles(6)
        array([  0.,  50., 100., 125., 150., 175.])

        """
        angle = np.concatenate(([0.0], np.cumsum(self.shaft_hz * self.lengths)))
        sample = np.concatenate(([0], np.cumsum(self.lengths)))
        return np.asarray(np.interp(angle[-1] / count * np.arange(count), angle, sample))


def resample(values: NDArray[np.floating], at: NDArray[np.float64]) -> NDArray[np.float32]:
    """
    Return the values at fractional positions along the first axis, in single precision.

    Four-point Lagrange interpolation: third order, local, exact at whole positions.

    Parameters
    ----------
    values
        Shape (N, ...), N at least 4.
    at
        Positions from 0 to N - 1, shape (M,).

    Raises
    ------
    BearingTwinError
        If there are fewer than four values.

    >>> x = np.cos(2.0 * np.pi * 25.0 * np.arange(25600) / 25600.0)
    >>> bool(np.allclose(resample(x, np.array([512.0, 512.5])), [x[512], x[512]], atol=1e-3))
    True

    """
    if len(values) < 4:
        msg = f'{len(values)} values cannot be resampled: give at least 4'
        raise BearingTwinError(msg)
    found = np.empty((len(at), *values.shape[1:]), np.float32)
    rows = np.ascontiguousarray(values, np.float32).reshape(len(values), -1)
    _interpolate(rows, at, found.reshape(len(at), -1))
    return found


@compiled(borrows=True)
def _interpolate(
    values: NDArray[np.float32], at: NDArray[np.float64], found: NDArray[np.float32]
) -> None:
    """Write the interpolated rows of ``values``, (N, C), at M positions to ``found``, (M, C)."""
    one, two, six = np.float32(1.0), np.float32(2.0), np.float32(6.0)
    for m in range(len(at)):
        base = min(max(int(np.floor(at[m])), 1), len(values) - 3)
        t = np.float32(at[m] - base)
        w1, w2 = -t * (t - one) * (t - two) / six, (t + one) * (t - one) * (t - two) / two
        w3, w4 = -(t + one) * t * (t - two) / two, (t + one) * t * (t - one) / six
        row1, row2, row3, row4 = values[base - 1], values[base], values[base + 1], values[base + 2]
        out = found[m]
        for c in range(len(out)):
            out[c] = w1 * row1[c] + w2 * row2[c] + w3 * row3[c] + w4 * row4[c]
