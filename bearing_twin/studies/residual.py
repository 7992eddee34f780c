# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""
How often a residual is a false alarm, and what it sees: :mod:`bearing_twin.calibration.residual`.

``python -m bearing_twin.studies.residual [MACHINES] [--data FOLDER]`` lets each of MACHINES
simulated machines learn from its first 60 healthy decisions and judges the 1000 after them, which
are all new to it; then it changes a machine and prints after how many decisions that is seen. With
the folder of the real recordings it also judges the first halves of FEMTO's longest runs, in which
a rig warms up.
"""

from __future__ import annotations

import math
from pathlib import Path
import sys
from typing import TYPE_CHECKING

from bearing_twin.calibration.residual import DECISIONS_A_YEAR, LEAST, Residual, spectral_levels
from bearing_twin.recording.snapshots import read_snapshots
from bearing_twin.studies.disturbances import with_memory
from bearing_twin.studies.output import arguments, print_table
import numpy as np
from scipy.signal import lfilter
from scipy.stats import chi2

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence

    from numpy.typing import NDArray


RATE, SECONDS, MACHINE_HZ = 12800.0, 4.0, 24.0
LEARNT = 60
BANDS = 64
JOINED = 20
"""Snapshots of a decision: 2 s of vibration in three minutes."""


def false_alarms(
    machines: int, decisions: int, *, memory: float = 0.0, heavy: bool = False, seed: int = 0
) -> tuple[int, float]:
    """
    Alarms on healthy decisions that were not learnt from, and the largest number.

    Differences of 64 bands scatter by 1 dB each and by 1 dB together; with a ``memory`` in
    decisions, or with the long tails of Student's t with six degrees of freedom.
    """
    rng = np.random.default_rng(seed)
    names = tuple(f'band {n}' for n in range(BANDS))
    alarms, largest = 0, 0.0
    for _ in range(machines):
        shape = (LEARNT + decisions + 100, BANDS)
        # The variance of Student's t with n degrees of freedom is n / (n - 2).
        drawn = rng.standard_t(6, shape) / math.sqrt(1.5) if heavy else rng.standard_normal(shape)
        drawn += rng.standard_normal((len(drawn), 1))
        if memory:
            drawn = with_memory(drawn, memory)
        residual = Residual()
        for row in drawn[100 : 100 + LEARNT]:
            residual.learn(names, row)
        numbers = np.array([residual.judge(names, row).number for row in drawn[100 + LEARNT :]])
        alarms += int((numbers >= 1.0).sum())
        largest = max(largest, float(numbers.max()))
    return alarms, largest


def poisson_bound(count: int) -> float:
    """Return the most events to be expected (95 %) where ``count`` independent ones came."""
    return float(chi2.ppf(0.95, 2 * (count + 1))) / 2.0


def _healthy(rng: np.random.Generator) -> NDArray[np.float64]:
    """Acceleration of a machine: noise through its housing, unbalance and mesh."""
    time = np.arange(round(SECONDS * RATE)) / RATE
    ringing = lfilter([1.0], [1.0, -1.2, 0.9], rng.standard_normal(len(time)))
    phase = 2.0 * np.pi * (MACHINE_HZ * time + rng.random())
    lines = 0.3 * np.sin(phase) + 0.1 * np.sin(2.0 * phase) + 0.2 * np.sin(17.0 * phase)
    level = 10.0 ** (0.3 * rng.standard_normal() / 20.0)
    return np.asarray(level * (ringing + lines), dtype=np.float64)


def _tones(x: NDArray[np.float64], *lines: tuple[float, float]) -> NDArray[np.float64]:
    """Add tones: orders of the shaft and amplitudes."""
    turns = 2.0 * np.pi * MACHINE_HZ * np.arange(len(x)) / RATE
    return np.asarray(x + sum(height * np.sin(order * turns) for order, height in lines))


CHANGES: dict[str, Callable[[NDArray[np.float64], int], NDArray[np.float64]]] = {
    'healthy': lambda x, _: x,
    'imbalance': lambda x, _: _tones(x, (1.0, 2.0)),
    'looseness': lambda x, _: _tones(x, *((order, 0.5) for order in (0.5, 1.5, 2.5, 3.0, 4.0))),
    'another machine': lambda x, _: _tones(x, (3.517, 0.7), (11.3, 0.5)),
    'sensor that loses 0.2 dB a decision': lambda x, number: x * 10.0 ** (-0.2 * number / 20.0),
}


def residual_of(rng: np.random.Generator, twin: NDArray[np.float64]) -> Residual:
    """Residual that has learnt from a healthy machine beside a twin."""
    residual = Residual()
    names, own = spectral_levels(twin, RATE, MACHINE_HZ)
    for _ in range(LEARNT):
        residual.learn(names, spectral_levels(_healthy(rng), RATE, MACHINE_HZ)[1] - own)
    return residual


def seen_after(change: str) -> tuple[int, str]:
    """Decisions until a change is an alarm (-1: none of 60 is), and where it shows."""
    rng = np.random.default_rng(0)
    twin = _healthy(rng)
    residual = residual_of(rng, twin)
    names, own = spectral_levels(twin, RATE, MACHINE_HZ)
    for decision in range(1, 61):
        x = CHANGES[change](_healthy(rng), decision)
        found = residual.judge(names, spectral_levels(x, RATE, MACHINE_HZ)[1] - own)
        if found.alarm:
            return decision, found.where
    return -1, ''


def real_runs(data: Path) -> Iterator[tuple[object, ...]]:
    """
    Run, decisions learnt from and judged, alarms, and the largest number, of first halves.

    Twenty snapshots of 0.1 s, 10 s apart, are one decision. The twin at one speed is a constant.
    Runs too short for a limit are left out.
    """
    for path in sorted((data / 'femto').glob('femto_*_[HV].npz')):
        trend = path.with_name(f'{path.stem[:-1]}trend.npz')
        snapshots = [snap.signal for snap in read_snapshots([path, trend])]
        half = len(snapshots) // 2 // JOINED
        residual, numbers, learnt = Residual(), [], max(LEAST, half // 2)
        for number in range(half):
            part = snapshots[JOINED * number : JOINED * (number + 1)]
            x = np.concatenate([signal.x - signal.x.mean() for signal in part])
            names, levels = spectral_levels(x, part[0].sample_rate, part[0].shaft_hz)
            if number < learnt:
                residual.learn(names, levels)
            else:
                numbers.append(residual.judge(names, levels).number)
        if numbers:
            run = path.stem.removeprefix('femto_Bearing').replace('_', ' ')
            alarms = sum(number >= 1.0 for number in numbers)
            yield run, learnt, len(numbers), alarms, f'{max(numbers):.2f}'


def main(argv: Sequence[str] | None = None) -> None:
    """Print both tables."""
    parser = arguments(sys.modules[__name__])
    parser.add_argument('machines', type=int, nargs='?', default=30)
    parser.add_argument('--data', type=Path, help='folder that holds femto/')
    args = parser.parse_args(argv)
    machines = args.machines
    print_table(
        ('healthy decisions', 'judged', 'false alarms', 'a year', '95 % below', 'largest number'),
        rates(machines),
    )
    print()
    print_table(
        ('change', 'decisions until the alarm', 'shows at'),
        ((change, *(said if (said := seen_after(change))[0] > 0 else ('none in 60', '-')))
         for change in CHANGES),
    )  # fmt: skip
    if args.data:
        print()
        print_table(('run', 'learnt', 'judged', 'alarms', 'largest number'), real_runs(args.data))


def rates(machines: int) -> Iterator[tuple[object, ...]]:
    """Alarms of healthy machines, a year, their bound where they are independent, and numbers."""
    for name, memory, heavy in (
        ('independent', 0.0, False),
        ('memory of 5 decisions', 5.0, False),
        ('memory of 20 decisions', 20.0, False),
        ('long tails', 0.0, True),
    ):
        alarms, largest = false_alarms(machines, 1000, memory=memory, heavy=heavy)
        judged = machines * 1000
        # At one decision a minute.
        year = DECISIONS_A_YEAR / judged
        yield (
            name, judged, alarms, f'{alarms * year:.2f}',
            # Alarms with a memory come in clusters, which are no Poisson number.
            '-' if memory else f'{poisson_bound(alarms) * year:.1f}', f'{largest:.2f}',
        )  # fmt: skip


if __name__ == '__main__':
    main()
