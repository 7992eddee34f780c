# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""
False alarms and smallest detected changes of :mod:`bearing_twin.calibration.residual`.

``python -m bearing_twin.studies.residual [MACHINES] [--seed N]`` simulates MACHINES machines of
each kind. The residual of each learns healthy decisions and judges 1000 new ones. Then the study
finds the smallest change that nine of ten machines show.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
import functools
import math
from typing import TYPE_CHECKING

from bearing_twin.calibration.residual import (
    DAY,
    DECISIONS_A_YEAR,
    Residual,
    spectral_levels,
)  # fmt: skip
from bearing_twin.studies.disturbances import with_memory
from bearing_twin.studies.output import arguments, print_table
import numpy as np
from numpy.typing import NDArray
import scipy
from scipy.signal import lfilter

if TYPE_CHECKING:
    from numpy.random import Generator

    Draw = Callable[[Generator, tuple[int, int]], NDArray[np.float64]]


RATE, SECONDS, MACHINE_HZ = 12800.0, 4.0, 24.0
LEARNT = (30, 100, 300, 1000, 10000)
"""Numbers of healthy decisions; of the largest one, only a day's decisions are learnt."""
BANDS = 64
WITHIN = (10, 60)
"""Decisions within which a change has to be an alarm."""
TRIALS = 40
"""Number of machines on which a change is tried."""
IMBALANCE = 0.3
"""Height of order 1 of the healthy machine; its own lines scatter by 0.5 dB, its level by 0.3."""
OWN = ((2.0, 0.1), (17.0, 0.2))
LOOSE = (0.5, 1.5, 2.5, 3.0, 4.0)
OTHER = (3.517, 11.3)
ADDED = {'looseness': LOOSE, 'another machine': OTHER}
"""Orders of the lines that a change adds; its size is their height over the healthy order 1."""
SIZES = {
    'imbalance': (0.5, 1, 1.5, 2, 3, 4, 5, 6, 8, 10, 14, 20),
    'looseness': (-24, -20, -16, -12, -10, -8, -6, -4, -2, 0, 4, 8, 14),
    'another machine': (-24, -20, -16, -12, -10, -8, -6, -4, -2, 0, 4, 8, 14),
    'gain': (0.5, 1, 1.5, 2, 3, 4, 5, 6, 8, 10, 14, 20),
}
"""Sizes of the changes, dB, ascending."""


def _normal(rng: Generator, shape: tuple[int, int]) -> NDArray[np.float64]:
    """Bands that scatter by 1 dB each and by 1 dB together."""
    return rng.standard_normal(shape) + rng.standard_normal((shape[0], 1))


def _long_tails(rng: Generator, shape: tuple[int, int]) -> NDArray[np.float64]:
    # The variance of Student's t with n degrees of freedom is n / (n - 2).
    return rng.standard_t(6, shape) / math.sqrt(1.5) + rng.standard_normal((shape[0], 1))


def _noise_lines(rng: Generator, shape: tuple[int, int]) -> NDArray[np.float64]:
    """Levels of noise lines: scatter 5.6 dB, far wider below the mean than above it."""
    return np.asarray(10.0 * np.log10(rng.exponential(size=shape)))


def _sway(rng: Generator, shape: tuple[int, int]) -> NDArray[np.float64]:
    """Half of the variance of each band is from load or speed, which vary within half an hour."""
    return rng.standard_normal(shape) + with_memory(rng.standard_normal(shape), 30.0)


def _bursts(rng: Generator, shape: tuple[int, int]) -> NDArray[np.float64]:
    """Bands whose scatter grows and shrinks within ten minutes."""
    size = np.exp(0.5 * with_memory(rng.standard_normal((shape[0], 1)), 10.0))
    return np.asarray(size * rng.standard_normal(shape))


def _day(rng: Generator, shape: tuple[int, int]) -> NDArray[np.float64]:
    """Bands that rise and fall by up to 1 dB with the day, and scatter by 0.3 dB."""
    turn = np.sin(2.0 * np.pi * (np.arange(shape[0])[:, None] / DAY + rng.random()))
    return np.asarray(0.3 * rng.standard_normal(shape) + turn * rng.uniform(-1, 1, shape[1]))


def _drawn(rng: Generator, shape: tuple[int, int]) -> NDArray[np.float64]:
    """Bands with random scatter, memory, tails, bursts of scatter and daily change."""
    count, bands = shape
    each = rng.standard_t(rng.uniform(4.0, 30.0), shape)
    both = each + rng.uniform(0.0, 2.0) * rng.standard_normal((count, 1))
    scatter = 10.0 ** rng.uniform(-1.0, 0.3, bands) * with_memory(both, rng.uniform(1.0, 30.0))
    swelling = rng.uniform(0.0, 0.5) * with_memory(
        rng.standard_normal((count, 1)), rng.uniform(1.0, 60.0)
    )
    turn = np.sin(2.0 * np.pi * (np.arange(count)[:, None] / DAY + rng.random()))
    return np.asarray(np.exp(swelling) * scatter + turn * rng.uniform(-1.0, 1.0, bands))


def _shifts(rng: Generator, shape: tuple[int, int]) -> NDArray[np.float64]:
    """Each band is up to 1 dB higher or lower in every second shift of eight hours."""
    late = (np.arange(shape[0])[:, None] + rng.integers(960)) // 480 % 2
    return _normal(rng, shape) + late * rng.uniform(-1.0, 1.0, shape[1])


def _slow(rng: Generator, shape: tuple[int, int]) -> NDArray[np.float64]:
    """
    Levels of a floor and a resonance that change within hours, with a scatter of 1 dB.

    The floor changes by 0.7 dB. The resonance, ten times the floor and with a quality factor of
    20, changes by 1 % of its frequency, as with the temperature of oil and housing.
    """
    count, bands = shape
    slow = with_memory(rng.standard_normal((count + 720, 2)), 240.0)[720:]
    hertz = 2.0 ** (np.arange(4 * bands) / 24.0)
    ratio = hertz / (2.0 ** (rng.uniform(0.0, bands) / 6.0) * (1.0 + 0.01 * slow[:, 1:]))
    power = 1.0 + 10.0 / (1.0 + (20.0 * (ratio - 1.0 / ratio)) ** 2)
    levels = 10.0 * np.log10(power.reshape(count, bands, 4).mean(axis=2))
    return np.asarray(levels + 0.7 * slow[:, :1] + _normal(rng, shape))


HEALTHY: dict[str, Draw] = {
    'independent': _normal,
    'memory of 5 decisions': lambda rng, shape: with_memory(_normal(rng, shape), 5.0),
    'memory of 20 decisions': lambda rng, shape: with_memory(_normal(rng, shape), 20.0),
    'long tails (Student, 6 degrees of freedom)': _long_tails,
    'lines of noise': _noise_lines,
    'sway of load and speed': _sway,
    'bursts of scatter': _bursts,
    'day and night': _day,
    'all of these, drawn at random': _drawn,
    'load in shifts': _shifts,
    'floor and resonance that change within hours': _slow,
}
"""Differences of healthy machines, dB, shape (decisions, bands)."""


def false_alarms(kind: str, learnt: int, machines: int, *, seed: int) -> NDArray[np.float64]:
    """Return the numbers of 1000 healthy decisions of each machine, shape (machines, 1000)."""
    rng = np.random.default_rng([seed, learnt])
    names = tuple(f'band {n}' for n in range(BANDS))
    numbers = []
    for _ in range(machines):
        drawn = HEALTHY[kind](rng, (learnt + 1100, BANDS))[100:]
        residual = Residual()
        for row in drawn[:learnt]:
            residual.learn(names, row)
        numbers.append([residual.judge(names, row).number for row in drawn[learnt:]])
    return np.array(numbers)


def _healthy(rng: Generator, lines: Sequence[tuple[float, float]]) -> NDArray[np.float64]:
    """Acceleration of a machine: noise through its housing, and ``lines`` (order, height)."""
    time = np.arange(round(SECONDS * RATE)) / RATE
    x = lfilter([1.0], [1.0, -1.2, 0.9], rng.standard_normal(len(time)))
    for order, height in lines:
        scatter = 10.0 ** (0.5 * rng.standard_normal() / 20.0)
        x += scatter * height * np.sin(2.0 * np.pi * (order * MACHINE_HZ * time + rng.random()))
    return np.asarray(10.0 ** (0.3 * rng.standard_normal() / 20.0) * x, dtype=np.float64)


def levels_of(change: str, size: float, rng: Generator) -> NDArray[np.float64]:
    """Return the levels of a machine with a ``change`` of ``size`` dB."""
    height = 10.0 ** (size / 20.0)
    lines = [(1.0, IMBALANCE * (height if change == 'imbalance' else 1.0)), *OWN]
    if change in ADDED:
        lines += [(order, IMBALANCE * height) for order in ADDED[change]]
    x = _healthy(rng, lines) * (height if change == 'gain' else 1.0)
    return spectral_levels(x, RATE, MACHINE_HZ)[1]


@functools.cache
def _pool(change: str, size: float, count: int) -> NDArray[np.float64]:
    rng = np.random.default_rng([len(change), round(10 * size) + 1000])
    return np.array([levels_of(change, size, rng) for _ in range(count)])


def decisions_until(
    change: str, size: float, learnt: int, *, drift: float = 0.0
) -> list[tuple[float, str]]:
    """
    Return for each machine the decisions until a change is an alarm, and its band.

    Without an alarm in 60 decisions it is inf. With a ``drift``, dB per decision, the gain changes
    over up to 1000 decisions.
    """
    rng = np.random.default_rng(learnt)
    names = spectral_levels(_healthy(rng, OWN), RATE, MACHINE_HZ)[0]
    healthy, changed = _pool('', 0.0, DAY + 200), _pool(change, size, 60)
    gain = np.array([not name.startswith('line') for name in names])
    found = []
    for _ in range(TRIALS):
        order = rng.permutation(len(healthy))
        residual = Residual()
        for row in healthy[order[: min(learnt, DAY)]]:
            residual.learn(names, row)
        for row in healthy[order[-50:]]:
            residual.judge(names, row)
        if drift:
            rows = healthy[rng.integers(len(healthy), size=1000)]
            rows = rows + drift * np.arange(1, 1001)[:, None] * gain
        else:
            rows = changed[rng.permutation(len(changed))]
        judged = (residual.judge(names, row) for row in rows)
        alarms = ((n, said.where) for n, said in enumerate(judged, 1) if said.alarm)
        found.append(next(alarms, (math.inf, '')))
    return found


def smallest(change: str, learnt: int) -> str:
    """Return the smallest sizes, dB, that nine of ten machines show, one for each of `WITHIN`."""
    least = dict.fromkeys(WITHIN, '-')
    for size in reversed(SIZES[change]):
        seen = np.array([n for n, _ in decisions_until(change, size, learnt)])
        shown = [within for within in WITHIN if np.mean(seen <= within) >= 0.9]
        least |= dict.fromkeys(shown, f'{size:g}')
        if not shown:
            break
    return ', '.join(least.values())


def main(argv: Sequence[str] | None = None) -> None:
    """Print the tables."""
    parser = arguments(__name__, machines=30)
    parser.add_argument('--seed', type=int, default=1, help='of the healthy machines')
    args = parser.parse_args(argv)
    print_table(
        (
            'healthy decisions', 'judged', 'in alarm', 'alarms', 'machines with one',
            'a year, at most', 'largest number',
        ),
        rates(args.machines, args.seed),
    )  # fmt: skip
    print()
    print_table(('learnt', *(f'{change}, dB' for change in SIZES), 'drift, dB lost'), powers())


def rates(machines: int, seed: int) -> Iterator[tuple[object, ...]]:
    """
    Yield the alarms of healthy machines; a fifth of them learns each number in `LEARNT`.

    Successive decisions in alarm count as one alarm. The rate per year is the one-sided limit of
    Clopper and Pearson (95 %).
    """
    each = {
        kind: np.concatenate([
            false_alarms(kind, min(learnt, DAY), max(machines // len(LEARNT), 1), seed=seed)
            for learnt in LEARNT
        ])
        for kind in HEALTHY
    }  # fmt: skip
    for kind, numbers in (*each.items(), ('together', np.concatenate([*each.values()]))):
        over = numbers >= 1.0
        began = over & ~np.pad(over, ((0, 0), (1, 0)))[:, :-1]
        judged, alarms = int(np.isfinite(numbers).sum()), int(began.sum())
        told = scipy.stats.binomtest(alarms, judged, alternative='less')
        most = DECISIONS_A_YEAR * told.proportion_ci(0.95, 'exact').high
        with_one, largest = over.any(axis=1).sum(), np.nanmax(numbers)
        yield kind, judged, over.sum(), alarms, with_one, f'{most:.2f}', f'{largest:.2f}'


def powers() -> Iterator[tuple[object, ...]]:
    """Yield the smallest changes found in 10 and in 60 decisions, by healthy decisions learnt."""
    for learnt in LEARNT:
        drifts = [n for n, _ in decisions_until('', 0.0, learnt, drift=-0.02)]
        yield (
            learnt,
            *(smallest(change, learnt) for change in SIZES),
            f'{0.02 * np.quantile(drifts, 0.9):.1f}',
        )


if __name__ == '__main__':
    main()
