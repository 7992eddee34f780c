# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""
False alarm rate of each threshold, and of the verdicts, on noise alone.

``python -m bearing_twin.studies.noise_windows [WINDOWS [FIRST]]`` draws windows of noise, from
number FIRST (0) on: white, pink, and with the lines of a machine (shaft, mains, stray lines and a
modulated gear mesh). They have 1, 2 or 4 s at 12 to 25.6 kHz, and are diagnosed for four bearings
at 10 to 50 Hz, with a speed that is off by up to 1 %. They contain no bearing, so that each named
fault is a false alarm. It prints the verdicts by length, and how often the noise passes each
threshold of a score and of an effect size.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import NamedTuple, TYPE_CHECKING

from bearing_twin.bearing import find_bearing, PLACES
from bearing_twin.diagnosis import diagnose_record
from bearing_twin.diagnosis.chain import Excerpt
from bearing_twin.diagnosis.combs.search import CombSearch
from bearing_twin.diagnosis.rules.evidence import Evidence
from bearing_twin.diagnosis.settings import DiagnosisSettings
from bearing_twin.diagnosis.signal.demodulation import highest_fault_order
from bearing_twin.diagnosis.thresholds import (
    INDEX_FAULT,
    INDEX_SUSPECT,
    Z_CAGE,
    Z_ELSEWHERE,
    Z_FAULT,
    Z_PASSAGES,
    Z_SECOND_LOOK,
)
from bearing_twin.studies.output import arguments, print_table
import numpy as np
from numpy.typing import NDArray
from scipy import fft

if TYPE_CHECKING:
    from bearing_twin.bearing import Bearing
    from bearing_twin.diagnosis import Diagnosis


KINDS = ('white', 'pink', 'lines')
BEARINGS = ('6205', '6307', 'ZA-2115', 'UER204')
RATES = (12000.0, 20000.0, 25600.0)
SECONDS = (1.0, 2.0, 4.0)


@dataclass(frozen=True)
class NoiseWindow:
    """One window without a bearing."""

    kind: str
    seconds: float
    bearing: Bearing
    sample_rate: float
    """Hz."""
    given_hz: float
    """Speed given to the diagnosis, Hz."""
    x: NDArray[np.float64]


class Reached(NamedTuple):
    """Scores and effect sizes that a window of noise reaches."""

    scores: dict[str, float]
    indices: dict[str, float]
    elsewhere: tuple[float, float]
    """Score and index of the best comb at any order."""
    second_look: tuple[float, ...]
    """Scores on a second look, if there is one."""
    passages: float
    """Significance of a ball that strikes in groups."""


def draw(number: int) -> NoiseWindow:
    """
    Draw a window; a number is always the same window.

    >>> window = draw(2)
    >>> window.kind, window.seconds, len(window.x) == round(2.0 * window.sample_rate)
    ('lines', 2.0, True)

    """
    rng = np.random.default_rng([2028, number])
    kind, seconds = KINDS[number % len(KINDS)], SECONDS[number // 3 % 3 - 2]
    bearing = find_bearing(BEARINGS[number % len(BEARINGS)])
    # Four harmonics of the highest order must fit: see the record gate.
    rates = [rate for rate in RATES if rate >= 400.0 * highest_fault_order(bearing)]
    rate = float(rng.choice(rates or RATES[-1:]))
    shaft_hz = float(rng.uniform(10.0, min(50.0, rate / (8.0 * highest_fault_order(bearing)))))
    n = round(seconds * rate)
    x = rng.standard_normal(n)
    if kind == 'pink':
        spectrum = fft.rfft(x)
        spectrum[1:] /= np.sqrt(np.arange(1, len(spectrum)))
        x = np.asarray(fft.irfft(spectrum, n))
    elif kind == 'lines':
        x = x + _lines(rng, np.arange(n) / rate, rate, shaft_hz)
    given_hz = shaft_hz * float(rng.uniform(0.99, 1.01))
    return NoiseWindow(kind, seconds, bearing, rate, given_hz, x)


def _lines(
    rng: np.random.Generator, t: NDArray[np.float64], sample_rate: float, shaft_hz: float
) -> NDArray[np.float64]:
    """Harmonics of shaft and mains, stray lines and a modulated gear mesh."""
    x = np.zeros(len(t))
    stray = rng.uniform(10.0, sample_rate / 2.0, 30)
    for hertz in (*(shaft_hz * np.arange(1, 30)), *(50.0 * np.arange(1, 12)), *stray):
        x += rng.exponential() * np.sin(2.0 * np.pi * (hertz * t + rng.random()))
    mesh = rng.integers(15, 60) * shaft_hz
    for k in (1, 2, 3):
        wave = np.sin(2.0 * np.pi * (k * mesh * t + rng.random()))
        x += rng.exponential(2.0) * (1.0 + 0.5 * np.cos(2.0 * np.pi * shaft_hz * t)) * wave
    return x


def _judge(window: NoiseWindow) -> tuple[Diagnosis, Reached] | None:
    """Return diagnosis and scores of a window; None if the record gate refuses it."""
    excerpt = Excerpt.of(
        window.x, window.given_hz, window.sample_rate, window.bearing, DiagnosisSettings()
    )
    found = excerpt.analyse().window
    if found is None:
        return None
    combs = CombSearch(found.orders, window.bearing, found.speed)
    candidates = Evidence(combs, found.revolutions).candidates
    anywhere = combs.strongest_anywhere(beyond=True)
    said = diagnose_record(window.x, window.sample_rate, window.bearing, window.given_hz)
    return said, Reached(
        {place: c.z for place, c in candidates.items()},
        {place: c.index for place, c in candidates.items()},
        (anywhere.z, anywhere.index),
        tuple(
            combs.second_look(c).z
            for c in candidates.values()
            if c.place != 'cage' and Z_SECOND_LOOK <= c.z < Z_FAULT
        ),
        found.ball_passages,
    )


def _exceeded(reached: Sequence[Reached]) -> Iterator[tuple[str, ...]]:
    """Yield each threshold, and the share of windows that pass it without and with its index."""

    def share(passed: list[bool]) -> str:
        return f'{100.0 * sum(passed) / len(passed):.2g} %'

    for name, z, places, index in (
        ('Z_FAULT', Z_FAULT, PLACES[:3], INDEX_SUSPECT),
        ('Z_CAGE', Z_CAGE, PLACES[3:], INDEX_SUSPECT),
    ):
        passed = [[p for p in places if r.scores[p] >= z] for r in reached]
        strong = [
            any(r.indices[p] >= index for p in ps) for r, ps in zip(reached, passed, strict=True)
        ]
        yield name, f'{z:g}', share([bool(p) for p in passed]), share(strong)
    above = [r.elsewhere[0] >= Z_ELSEWHERE for r in reached]
    strong = [a and r.elsewhere[1] >= INDEX_FAULT for a, r in zip(above, reached, strict=True)]
    yield 'Z_ELSEWHERE', f'{Z_ELSEWHERE:g}', share(above), share(strong)
    again = [any(z >= Z_FAULT for z in r.second_look) for r in reached]
    strong = [
        any(z >= Z_FAULT for z in r.second_look) and max(r.indices.values()) >= INDEX_FAULT
        for r in reached
    ]
    yield 'Z_SECOND_LOOK', f'{Z_SECOND_LOOK:g}', share(again), share(strong)
    yield 'Z_PASSAGES', f'{Z_PASSAGES:g}', share([r.passages >= Z_PASSAGES for r in reached]), ''


def main(argv: Sequence[str] | None = None) -> None:
    """Print the verdicts by length and what passes the thresholds."""
    args = arguments(__name__, windows=3024, first=0).parse_args(argv)
    answers: dict[float, Counter[str]] = {seconds: Counter() for seconds in SECONDS}
    reached = []
    for number in range(args.first, args.first + args.windows):
        window = draw(number)
        judged = _judge(window)
        if judged is None:
            answers[window.seconds]['too short'] += 1
            continue
        said, found = judged
        answers[window.seconds]['alarm' if said.level == 'fault' else said.result] += 1
        reached.append(found)
    kinds = ('alarm', 'suspect', 'ambiguous', 'healthy', 'insufficient', 'too short')
    print_table(
        ('window', 'windows', *kinds),
        ((f'{s:g} s', c.total(), *(c[kind] or '' for kind in kinds)) for s, c in answers.items()),
    )
    print()
    print_table(('threshold', 'value', 'passed', 'passed with its index'), _exceeded(reached))
    print()
    places = np.array([[r.scores[p] for p in PLACES] for r in reached])
    rows = {
        'races and ball': places[:, :3].max(axis=1),
        'cage': places[:, 3],
        'any order': np.array([r.elsewhere[0] for r in reached]),
        'index of races and ball': np.array(
            [max(r.indices[p] for p in PLACES[:3]) for r in reached]
        ),
        'index of any order': np.array([r.elsewhere[1] for r in reached]),
        'groups of a ball': np.array([r.passages for r in reached]),
    }
    quantiles = (0.5, 0.95, 0.99, 0.999)
    print_table(
        ('reached by noise', *(f'{100.0 * q:g} %' for q in quantiles)),
        ((name, *(f'{v:.2f}' for v in np.quantile(row, quantiles))) for name, row in rows.items()),
    )


if __name__ == '__main__':
    main()
