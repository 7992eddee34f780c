# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""
Significance of ball impacts in groups, one group in each passage through the load zone.

A damaged ball strikes in groups, one group each turn of the cage. Its spin loses its phase from
group to group. So the lines at its order are wide, and no comb of narrow lines finds them. But two
lines of the envelope spectrum that are a cage order apart keep the phase of the load zone relative
to each other, in all bands and at all harmonics of the ball. Their mean product is the cyclic
spectrum of the envelope at the order of the cage (Antoni, Mech. Syst. Signal Process. 2007, 21,
597). It is high around these harmonics; a plain modulation by the cage has the same cyclic
spectrum at all orders.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from bearing_twin.bearing import fault_orders
from bearing_twin.diagnosis.signal.spectra import local_floor
from bearing_twin.diagnosis.thresholds import HARMONICS, SLIP
import numpy as np
from numpy.typing import NDArray
from scipy import fft

if TYPE_CHECKING:
    from bearing_twin.bearing import Bearing


_HALF_WIDTH = 0.75
"""Half width of a harmonic, in cage orders: a passage lasts up to half a cage turn, so its line is
two cage orders wide. Each harmonic must stay apart from the next."""

_LOWEST = 1.5
"""Lowest order of the background: below it healthy machines sway."""

_WINDOWS = 4
"""Least width of the background from which its scatter is estimated, in widths of a harmonic."""

_TINY = 1e-30

_LOUDEST, _HIGHEST = 8.0, 2.5
"""Caps of the envelope over its mean, and of the amplitude of a line over its floor: noise exceeds
them three times in ten thousand, and twice in a thousand."""


def ball_passages(envelopes: NDArray[np.float32], turns: float, bearing: Bearing) -> float:
    """
    Return the significance of ball impacts in groups, one group each turn of the cage.

    Parameters
    ----------
    envelopes
        Squared envelopes of several bands, shape (n, bands), over time or over angle.
    turns
        Number of shaft turns in the envelopes.
    bearing
        Geometry.

    Returns
    -------
    Mean product around the harmonics of the ball over its scatter elsewhere, at the cage slip with
    the highest value; 0 if the window is too short, or sampled too slowly for the harmonics. In
    noise the square of the value at one slip has an exponential distribution with mean 1.

    Impacts of a ball in the load zone, with a random phase in each passage:

    >>> from bearing_twin.bearing import find_bearing
    >>> bearing, rng = find_bearing('6205'), np.random.default_rng(1)
    >>> turn = np.arange(0.0, 250.0, 0.02)
    >>> cage, spin = (0.98 * order * turn for order in (0.398, 2.0 * 2.357))
    >>> passage = np.floor(cage).astype(int)
    >>> strikes = (spin + rng.uniform(size=passage[-1] + 1)[passage]) % 1.0 < 0.1
    >>> noise = rng.exponential(size=(len(turn), 4)).astype(np.float32)
    >>> struck = noise * (1.0 + 2.0 * (strikes & (cage % 1.0 < 0.5)))[:, np.newaxis]
    >>> ball_passages(noise, 250.0, bearing) < 4.0 < ball_passages(struck, 250.0, bearing)
    True

    """
    orders = fault_orders(bearing)
    ball, cage = orders.impacts('ball'), orders.ftf
    slowest, fastest = 1.0 - SLIP[1], 1.0 - SLIP[0]
    half = round(_HALF_WIDTH * cage * turns)
    at_bins, between = _lines(envelopes, turns, fastest * (HARMONICS * ball + 2.0 * cage))
    below = at_bins.conj()
    found = 0.0
    # At whole bins the cage's order lies up to half a bin off, where the phase between two lines
    # turns by half a turn within the window and 2/pi of their product is left; at half bins 0.9.
    first, last = (2.0 * turning * cage * turns for turning in (slowest, fastest))
    for half_bins in range(math.ceil(first), int(last) + 1):
        bins, odd = divmod(half_bins, 2)
        above = (between if odd else at_bins)[:, bins:]
        products = (above * below[:, : above.shape[1]]).sum(axis=0)
        sums = np.concatenate((np.zeros(1), np.cumsum(products, dtype=np.complex128)))
        sums = sums[2 * half :] - sums[: -2 * half]
        # Bins, halfway between the two lines; the first place is no harmonic.
        apart = 0.5 * half_bins
        spin, wide = apart * ball / cage, (0.5 + _HALF_WIDTH) * apart
        harmonic = spin * np.arange(HARMONICS + 1)
        begin = np.maximum(harmonic + wide, apart * _LOWEST / cage)
        places = np.array((harmonic, begin, harmonic + spin - wide)) - half - 0.5 * apart
        at, *beside = np.ceil(places).astype(int)
        rest = np.concatenate([sums[i:j] for i, j in zip(*beside, strict=True)])
        if half == 0 or len(rest) < _WINDOWS * 2 * half or at[-1] >= len(sums):
            return 0.0
        middle = np.median(rest.real) + 1j * np.median(rest.imag)
        # The median of an exponential distribution is ln 2 times its mean.
        scatter = np.median(np.abs(rest - middle) ** 2) / math.log(2.0)
        together = abs((sums[at[1:]] - middle).sum())
        found = max(found, together / math.sqrt(max(HARMONICS * scatter, _TINY)))
    return float(found)


def _lines(
    envelopes: NDArray[np.float32], turns: float, highest: float
) -> tuple[NDArray[np.complex64], NDArray[np.complex64]]:
    """
    Return the lines of the envelopes up to an order over the root of the floor, (bands, K) each.

    The first are those at whole bins, the others those half a bin above them.
    """
    limit = np.float32(_LOUDEST) * envelopes.mean(axis=0)
    capped = np.minimum(envelopes.T, limit[:, np.newaxis], order='C')
    capped -= capped.mean(axis=1, keepdims=True)
    count = min(math.ceil(highest * turns), capped.shape[1] // 2)
    lines = fft.rfft(capped, 2 * capped.shape[1])[:, : 2 * count]
    power = lines.real**2 + lines.imag**2
    floor = local_floor(power[:, ::2], max(int(4.0 * turns), 32))
    lowest = power * np.float32(1.0 / _HIGHEST**2)
    at_bins, between = (
        lines[:, odd::2] * (1.0 / np.sqrt(np.maximum(floor, lowest[:, odd::2]))) for odd in (0, 1)
    )
    return at_bins, between
