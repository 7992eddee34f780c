# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""
The smallest fault that the diagnosis detects, simulated with the twin.

``python -m bearing_twin.studies.detection_power OUT.json`` writes the table that the diagnosis
reads as ``bearing_twin/diagnosis/detection_power.json`` and prints it (some minutes).
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from bearing_twin.bearing import find_bearing
from bearing_twin.diagnosis import diagnose_record
from bearing_twin.dynamics.presets import preset
from bearing_twin.dynamics.single.simulator import Simulator
from bearing_twin.studies.output import arguments, print_table, write_table
import numpy as np

BEARING = '6307-catalogue'
RATE = 25600.0
SPEEDS = (12.5, 25.0, 50.0)
TEMPERATURES = (30.0, 90.0)
NOISES = (0.2, 1.0, 5.0)
WINDOWS = (1.0, 2.0, 4.0, 8.0)
WIDTHS = (0.1, 0.2, 0.3, 0.5, 0.8, 1.2, 2.0)
SEEDS = (1, 2, 3)


def _record(
    defect: str, width: float, shaft_hz: float, temperature: float, noise: float, seed: int
) -> np.ndarray[Any, Any]:
    """Vertical acceleration of the twin, m/s^2, as long as the longest window."""
    parameters = preset(
        'incipient',
        bearing=BEARING,
        defect=defect,
        width=width * 1e-3,
        # The width limits how deep a ball sinks: it never touches a floor this deep.
        depth=50e-6,
        noise=noise,
    )
    twin = Simulator(
        parameters, sample_rate=RATE, seed=seed, temperature=temperature, shaft_hz=shaft_hz
    )
    twin.advance(int(0.5 * RATE), temperature, shaft_hz)
    return twin.advance(int(WINDOWS[-1] * RATE), temperature, shaft_hz).y.astype(float)


def _shown(
    defect: str, width: float, shaft_hz: float, temperature: float, noise: float
) -> list[bool]:
    """Return for each window whether the fault is named with most seeds."""
    bearing = find_bearing(BEARING)
    hits = np.zeros(len(WINDOWS), dtype=int)
    for seed in SEEDS:
        x = _record(defect, width, shaft_hz, temperature, noise, seed)
        for number, seconds in enumerate(WINDOWS):
            part = x[: int(seconds * RATE)]
            found = diagnose_record(part, RATE, bearing, shaft_hz, speed_tolerance=0.002)
            hits[number] += found.level == 'fault' and defect in found.faults
    return [bool(hit > len(SEEDS) / 2) for hit in hits]


def _smallest(
    defect: str, shaft_hz: float, temperature: float, noise: float
) -> list[float | None]:
    """Return for each window the width, mm, from which all are detected; None if there is none."""
    shown = np.array([_shown(defect, width, shaft_hz, temperature, noise) for width in WIDTHS])
    smallest: list[float | None] = []
    for column in shown.T:
        hidden = np.flatnonzero(~column)
        first = hidden[-1] + 1 if len(hidden) else 0
        smallest.append(WIDTHS[first] if first < len(WIDTHS) else None)
    return smallest


def simulate_table() -> dict[str, Any]:
    """Return the table that ``bearing_twin.diagnosis.detection_power`` reads."""
    smallest = {
        defect: [
            [[_smallest(defect, speed, heat, noise) for noise in NOISES] for heat in TEMPERATURES]
            for speed in SPEEDS
        ]
        for defect in ('inner', 'outer', 'ball')
    }
    return {
        'about': 'written by python -m bearing_twin.studies.detection_power',
        'bearing': BEARING,
        'd_ball_m': find_bearing(BEARING).d_ball,
        'sample_rate': RATE,
        'shaft_hz': SPEEDS,
        'temperature_C': TEMPERATURES,
        'noise_m_s2': NOISES,
        'window_s': WINDOWS,
        'width_mm': WIDTHS,
        'smallest_mm': smallest,
    }


def main(argv: Sequence[str] | None = None) -> None:
    """Write the data file and print the table."""
    args = arguments(__name__, writes=True).parse_args(argv)
    table = simulate_table()
    write_table(args.output, table)
    print_table(
        ('fault', 'shaft Hz', 'degC', *(f'noise {noise:g} m/s^2' for noise in NOISES)),
        (
            (defect, f'{SPEEDS[i]:g}', f'{TEMPERATURES[j]:g}', *map(_by_window, rows[i][j]))
            for defect, rows in table['smallest_mm'].items()
            for i, j in np.ndindex(len(SPEEDS), len(TEMPERATURES))
        ),
    )


def _by_window(smallest: Sequence[float | None]) -> str:
    """Return the smallest widths by window as text."""
    return ', '.join('-' if mm is None else f'{mm:g}' for mm in smallest)


if __name__ == '__main__':
    main()
