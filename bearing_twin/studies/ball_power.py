# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""
Which envelope shows balls best: one stage of the chain replaced at a time.

``python -m bearing_twin.studies.ball_power [BALLS [FIRST [MODEL]]]`` draws BALLS (99) machines
with a damaged ball, and a third as many of each other condition, with a MODEL (impacts) of
:mod:`bearing_twin.studies.generalisation`, from number FIRST (600000) on, and judges them with the
chain as it is and with each variant. A variant gains if it names more balls without a wrong name
or an alarm more.
"""

from __future__ import annotations

from collections import Counter
from contextlib import ExitStack
from dataclasses import replace
import functools
import sys
from typing import Any, TYPE_CHECKING
from unittest.mock import patch

from bearing_twin.diagnosis import comb
from bearing_twin.diagnosis.comb import comb_scores, CombScores, NEUTRAL
from bearing_twin.diagnosis.rules import RULES
from bearing_twin.diagnosis.search import CombSearch
from bearing_twin.diagnosis.spectra import (
    envelope_spectra,
    EnvelopeSpectra,
    local_floor,
    whiten,
    WHITENINGS,
)
from bearing_twin.diagnosis.thresholds import SLIP
from bearing_twin.memory import keep_freed_memory
from bearing_twin.studies import impact_machines, twin_machines
from bearing_twin.studies.disturbances import CONDITIONS
from bearing_twin.studies.generalisation import judge_case, MODELS, outcome
from bearing_twin.studies.output import arguments, print_table
import numpy as np

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Sequence

    from bearing_twin.diagnosis.comb import OrderSpectra
    from bearing_twin.diagnosis.search import Candidate
    from numpy.typing import NDArray

    _Stage = Callable[..., Any]

__all__ = ['VARIANTS', 'main']


def _partial_phase(
    spectrum: NDArray[np.complex64], width: int, *, cap: float = 4.0
) -> NDArray[np.complex64]:
    """Keep the root of each line's height over the floor where the cepstral one keeps none."""
    white = whiten(spectrum, width, cap=cap)
    flat = spectrum / np.sqrt(local_floor(np.abs(spectrum) ** 2, width))
    white[1] = flat / np.sqrt(np.maximum(np.abs(flat), 1e-6))
    return white


def _of_envelope(
    change: Callable[[NDArray[np.float32]], NDArray[np.float32]],
    envelopes: Iterable[NDArray[np.float32]],
    rate: float,
    *,
    both: bool = False,
    **known: Any,
) -> EnvelopeSpectra:
    """Score the spectrum of a function of the squared envelope; effect sizes stay as they are."""
    parts = list(envelopes)
    found = envelope_spectra(parts, rate, **known)
    logs = envelope_spectra([change(part) for part in parts], rate, **known).logs
    return replace(found, logs=np.asarray(0.5 * (logs + found.logs) if both else logs))


def _log(squared: NDArray[np.float32]) -> NDArray[np.float32]:
    mean = squared.mean(axis=-1, keepdims=True)
    least = np.float32(1e-3)
    # The offset keeps the mean above zero; lines over their floor do not depend on it.
    return np.asarray(np.log(np.maximum(squared / mean, least)) - 2.0 * np.log(least))


def _enhanced(
    envelopes: Iterable[NDArray[np.float32]], rate: float, *, weighted: bool = False, **known: Any
) -> EnvelopeSpectra:
    """
    Put the mean over all narrow bands in the place of the whole range.

    The mean of the lines of many narrow bands over their floor is the enhanced envelope spectrum:
    the squared spectral coherence integrated over the carriers (Antoni, Xin and Hamzaoui 2017).
    Each band may be weighted by how far its lines stand out.
    """
    found = envelope_spectra(envelopes, rate, **known)
    bands = found.power.shape[0]
    ratio = np.expm1(found.logs).reshape(len(found.logs), -1, bands)[..., -((bands + 1) // 2) :]
    weight = np.maximum(ratio.var(axis=0) - 1.0, 0.0) + 1e-3 if weighted else np.ones(1)
    logs = found.logs.copy()
    logs[:, ::bands] = np.log1p((weight * ratio).sum(axis=-1) / (weight + 0.0 * ratio[0]).sum(-1))
    return replace(found, logs=logs)


def _sums_with(
    factors: Sequence[float], sides: Sequence[float], spectra: OrderSpectra, grid: Any
) -> NDArray[np.float32]:
    """Sum over multiples of each order, and lines beside each of them."""
    total = np.zeros((len(grid), spectra.logs.shape[1]), np.float32)
    logs = np.where(spectra.quiet[:, np.newaxis], np.float32(NEUTRAL), spectra.logs)
    for factor in factors:
        for side in sides:
            total += logs[spectra.rows(factor * grid + side)]
    return total


def _score(self: CombScores, spectra: OrderSpectra, grid: Any) -> NDArray[np.float64]:
    """Score as the kernel does, from the sums that stand in the place of its own."""
    bands = (comb._sums(spectra, grid) - self.center) * self.inverse
    best = bands.reshape(len(grid), self.whitenings, -1).max(axis=2).mean(axis=1)
    return np.asarray((best - self.best_center) / self.best_spread, np.float64)


_best = CombSearch.best


def _ball_by(
    factors: Sequence[float],
    caged: bool,
    self: CombSearch,
    place: str,
    spectra: OrderSpectra | None = None,
    slips: tuple[float, float] = SLIP,
) -> Candidate:
    """Score a ball by more lines than its four harmonics: cycle-synchronous with the cage."""
    if place != 'ball':
        return _best(self, place, spectra, slips)
    gap = self.orders.ftf
    sums = functools.partial(_sums_with, factors, (0.0, -gap, gap) if caged else (0.0,))
    plain = self._scores
    with patch.object(comb, '_sums', sums), patch.object(CombScores, 'score', _score):
        if '_ball_scores' not in self.__dict__:
            self.__dict__['_ball_scores'] = comb_scores(
                self.spectra, self._highest, len(WHITENINGS)
            )
        self._scores = self.__dict__['_ball_scores']
        try:
            return _best(self, place, spectra, slips)
        finally:
            self._scores = plain


_off_shaft = CombSearch._off_shaft


def _anywhere(self: CombSearch, grid: Any, z: Any) -> Candidate:
    """Best comb of a grid, also at the turns of the cage."""
    with patch.object(self, '_cage_orders', lambda: (np.inf, -np.inf)):
        return _off_shaft(self, grid, z)


_OFF_SHAFT = 'bearing_twin.diagnosis.search.CombSearch._off_shaft'
_BEST = 'bearing_twin.diagnosis.search.CombSearch.best'
_WINDOW = 'bearing_twin.diagnosis.window'
_WHITEN = 'bearing_twin.diagnosis.demodulation.whiten'

_FOUR = (1.0, 2.0, 3.0, 4.0)
_EIGHT = (0.5, 1.0, 1.5, 2.0, 2.5, 3.0, 3.5, 4.0)


def _method(factors: Sequence[float], *, caged: bool) -> _Stage:
    """Return a method of a search that scores balls by these lines."""

    def best(self: CombSearch, *args: Any) -> Candidate:
        return _ball_by(factors, caged, self, *args)

    return best


VARIANTS: dict[str, dict[str, Any]] = {
    'as it is': {},
    'log envelope': {f'{_WINDOW}.envelope_spectra': functools.partial(_of_envelope, _log)},
    'log and squared envelope': {
        f'{_WINDOW}.envelope_spectra': functools.partial(_of_envelope, _log, both=True)
    },
    'partial cepstral pre-whitening': {_WHITEN: _partial_phase},
    'enhanced envelope (coherence)': {f'{_WINDOW}.envelope_spectra': _enhanced},
    'weighted coherence': {
        f'{_WINDOW}.envelope_spectra': functools.partial(_enhanced, weighted=True)
    },
    'both impacts of a spin (odd harmonics)': {_BEST: _method(_EIGHT, caged=False)},
    'cage sidebands': {_BEST: _method(_FOUR, caged=True)},
    'both impacts and cage sidebands': {_BEST: _method(_EIGHT, caged=True)},
    'without the rule ball_ripple': {
        'bearing_twin.diagnosis.rules.RULES': [r for r in RULES if r.name != 'ball_ripple']
    },
    'lines of the cage count as elsewhere': {_OFF_SHAFT: _anywhere},
}
"""Stages that each variant puts in the place of those of the chain, by name."""


def _judge(variant: str, model: str, numbers: Sequence[int]) -> Counter[tuple[str, str]]:
    """Count the outcomes by condition."""
    told: Counter[tuple[str, str]] = Counter()
    with ExitStack() as stack:
        for name, stage in VARIANTS[variant].items():
            stack.enter_context(patch(name, stage))
        for number in numbers:
            case, said = judge_case(model, number)
            alarm = case.condition == 'none' and said.level == 'fault'
            told[case.condition, 'wrong' if alarm else outcome(case, said)] += 1
    return told


def _numbers(model: str, balls: int, first: int) -> list[int]:
    """Numbers of as many machines with a damaged ball, and a third as many of each condition."""
    wanted = {name: balls if name == 'ball' else balls // 3 for name in CONDITIONS}
    draw = twin_machines.draw if model == 'twin' else impact_machines.draw
    found = []
    number = first
    while any(wanted.values()):
        condition = draw(number).condition
        if wanted[condition]:
            wanted[condition] -= 1
            found.append(number)
        number += 1
    return found


def main(argv: Sequence[str] | None = None) -> None:
    """Print the table."""
    parser = arguments(sys.modules[__name__])
    parser.add_argument('balls', type=int, nargs='?', default=99)
    parser.add_argument('first', type=int, nargs='?', default=600_000)
    parser.add_argument('model', choices=MODELS, nargs='?', default='impacts')
    parser.add_argument('--only', action='append', choices=tuple(VARIANTS), help='of the variants')
    args = parser.parse_args(argv)
    keep_freed_memory()
    numbers = _numbers(args.model, args.balls, args.first)
    rows = []
    for variant in args.only or VARIANTS:
        told = _judge(variant, args.model, numbers)
        right = [told[name, 'right'] for name in ('ball', 'inner', 'outer', 'cage', 'none')]
        rows.append((variant, *right, sum(told[name, 'wrong'] for name in CONDITIONS)))
        print(rows[-1], file=sys.stderr, flush=True)
    conditions = ('ball', 'inner', 'outer', 'cage', 'none')
    print_table(('variant', *(f'{name}: right' for name in conditions), 'wrong, alarms'), rows)


if __name__ == '__main__':
    main()
