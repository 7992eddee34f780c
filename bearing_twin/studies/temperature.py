# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""
Effect of temperature and speed on the level of a healthy bearing in the physical mode.

``python -m bearing_twin.studies.temperature`` simulates healthy bearings and prints the change of
their level: the prior of :mod:`bearing_twin.diagnosis.machine.dependence`.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from itertools import product
import math
from typing import TYPE_CHECKING

from bearing_twin.dynamics import preset, Simulator
from bearing_twin.studies.output import arguments, print_table
import numpy as np

if TYPE_CHECKING:
    from bearing_twin.dynamics.parameters import TwinParameters


RATE = 25600.0
SPEEDS = (15.0, 30.0)
HEATS = (30.0, 60.0, 90.0, 110.0)
LOADS = (500.0, 2000.0, 4000.0)
CLEARANCES = (0.0, 5e-6, 10e-6)


def simulated_slopes() -> tuple[np.ndarray, np.ndarray]:
    """
    Return change of level with temperature, dB/K, and with speed, dB per doubling, of each twin.

    Their surfaces are perfect. The vibration of wavy surfaces changes by about 0.01 dB/K or less,
    so that these are the largest changes of a healthy bearing in the physical mode.
    """
    slopes, octaves = [], []
    for load, clearance in product(LOADS, CLEARANCES):
        twin = replace(
            preset('incipient', bearing='6307-catalogue', defect='none', thermal_mode='physical'),
            load=load, clearance=clearance, noise=0.0, waviness=0.0,
        )  # fmt: skip
        levels = np.array([[_level(twin, hertz, heat) for heat in HEATS] for hertz in SPEEDS])
        slopes += [np.polyfit(HEATS, row, 1)[0] for row in levels]
        octaves += list((levels[1] - levels[0]) / math.log2(SPEEDS[1] / SPEEDS[0]))
    return np.array(slopes), np.array(octaves)


def _level(twin: TwinParameters, hertz: float, heat: float) -> float:
    simulator = Simulator(twin, sample_rate=RATE, seed=1, temperature=heat, shaft_hz=hertz)
    simulator.advance(int(0.5 * RATE), heat, hertz)
    y = simulator.advance(int(4.0 * RATE), heat, hertz).y.astype(float)
    return 20.0 * math.log10(float(y.std()))


def main(argv: Sequence[str] | None = None) -> None:
    """Print median and spread of the simulated slopes."""
    arguments(__name__).parse_args(argv)
    rows = zip(('dB/K', 'dB per doubling of speed'), simulated_slopes(), strict=True)
    print_table(
        ('change of level', 'median', 'half of 16 to 84 %', 'from', 'to'),
        (
            (name, f'{np.median(found):+.3f}',
             f'{0.5 * np.diff(np.quantile(found, (0.16, 0.84)))[0]:.3f}',
             f'{found.min():+.3f}', f'{found.max():+.3f}')
            for name, found in rows
        ),
    )  # fmt: skip


if __name__ == '__main__':
    main()
