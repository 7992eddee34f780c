# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""
Sidebands of a part that moves through the load zone: basis of ``SWAY`` and ``RIPPLE``.

``python -m bearing_twin.studies.load_sidebands [RECORDS]`` draws RECORDS (40) trains of impacts in
noise for each spread of the load, and prints the sidebands of one turn over their harmonics, and
how many lie below ``SWAY``.

The deflection of the rolling elements of a loaded bearing is 1 - (1 - cos a) / (2 e) of the
largest, a being the angle from the load and e the spread of the load zone (Harris and Kotzalas,
Rolling Bearing Analysis, 2006, chapter 7): 0.5 without clearance, less with clearance, 1 where a
preload keeps the element opposite the load just in contact, more with more preload. An impact that
follows the deflection varies as 1 + m cos a with m = 1 / (2 e - 1). The squared envelope of the
impacts then has sidebands of m / (1 + m^2 / 2) of the harmonics one turn beside them, and of a
quarter of m times that two turns beside them. ``SWAY`` is the root of their mean square at
m = 0.3: a load zone of e = 2.2, in which the least loaded element is deflected by 54 % of the
most loaded. ``RIPPLE`` is the height of the higher harmonics of a ball that strikes within the
narrowest load zone, of e = 0.1.
"""

from __future__ import annotations

from collections.abc import Sequence

from bearing_twin.bearing import fault_orders, find_bearing
from bearing_twin.diagnosis.chain import Excerpt
from bearing_twin.diagnosis.combs.search import CombSearch
from bearing_twin.diagnosis.settings import DiagnosisSettings
from bearing_twin.diagnosis.thresholds import SWAY
from bearing_twin.studies.output import arguments, print_table
import numpy as np
from numpy.typing import NDArray

SPREADS = (np.inf, 4.0, 2.2, 1.5, 1.0)
"""Spreads of the load zone; infinite: a part that does not move through the load."""

RATE, SHAFT_HZ, SECONDS = 12800.0, 25.0, 4.0


def expected(spread: float) -> float:
    """
    Return sidebands over harmonics: root mean square of those one and two turns beside them.

    >>> round(expected(2.2), 2), round(expected(1.0), 2)
    (0.2, 0.49)

    """
    m = 1.0 / (2.0 * spread - 1.0)
    first = m / (1.0 + 0.5 * m * m)
    return float(np.sqrt(0.5 * (first**2 + (0.25 * m * first) ** 2)))


def ripple(spread: float) -> float:
    """
    Return the power of harmonics 5 to 8 over that of 1 to 4 of impacts within a load zone.

    The harmonics are those of the squared envelope. The force of a contact is proportional to the
    deflection to the power of 1.5.

    >>> round(ripple(0.1), 2), round(ripple(0.2), 2)
    (0.2, 0.04)

    """
    angle = np.linspace(-np.pi, np.pi, 4096, endpoint=False)
    deflection = np.maximum(1.0 - (1.0 - np.cos(angle)) / (2.0 * spread), 0.0)
    power = np.abs(np.fft.rfft(deflection**3.0)) ** 2
    return float(power[5:9].sum() / power[1:5].sum())


def measured(spread: float, seed: int) -> float:
    """Return the sidebands over harmonics that the search measures on a record in noise."""
    rng = np.random.default_rng([2029, seed])
    bearing = find_bearing('6205')
    order = fault_orders(bearing, 0.01).bpfi
    gaps = (1.0 + 0.005 * rng.standard_normal(int(order * SHAFT_HZ * SECONDS))) / order
    places = np.cumsum(gaps)
    places = places[places < SHAFT_HZ * SECONDS - 1.0]
    m = 1.0 / (2.0 * spread - 1.0)
    phase = rng.uniform(0.0, 2.0 * np.pi)
    x: NDArray[np.float64] = rng.standard_normal(int(RATE * SECONDS))
    at = (places / SHAFT_HZ * RATE).astype(int)
    strength = rng.uniform(2.5, 8.0)
    x[at] += strength * (1.0 + m * np.cos(2.0 * np.pi * places + phase))
    window = Excerpt.of(x, SHAFT_HZ, RATE, bearing, DiagnosisSettings()).analyse().window
    assert window is not None
    combs = CombSearch(window.orders, bearing, window.speed)
    return combs.sidebands.shaft_sideband_ratio(combs.best('inner'))


def main(argv: Sequence[str] | None = None) -> None:
    """Print the table."""
    args = arguments(__name__, records=40).parse_args(argv)
    rows = []
    for spread in SPREADS:
        found = np.array([measured(spread, seed) for seed in range(args.records)])
        low, middle, high = np.quantile(found, (0.05, 0.5, 0.95))
        below = f'{100.0 * (found < SWAY).mean():.0f} %'
        cells = (f'{v:.2f}' for v in (expected(spread), low, middle, high))
        rows.append((f'{spread:g}', *cells, below))
    heading = ('spread of the load zone', 'expected', '5 %', 'median', '95 %', f'below {SWAY:g}')
    print_table(heading, rows)
    print()
    narrow = (0.1, 0.15, 0.2, 0.3, 0.5)
    print_table(
        ('ball: spread of the load zone', *(f'{spread:g}' for spread in narrow)),
        [('harmonics 5 to 8 over 1 to 4', *(f'{ripple(spread):.3f}' for spread in narrow))],
    )


if __name__ == '__main__':
    main()
