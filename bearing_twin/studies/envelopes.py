# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""
Which envelope names most: one stage of the chain replaced at a time.

``python -m bearing_twin.studies.envelopes [BALLS [FIRST]]`` draws BALLS (99) machines with a
damaged ball and a third as many of each other condition, with the trains of impacts of
:mod:`bearing_twin.studies.generalisation`, from number FIRST (3400000) on. It judges them with the
chain as it is and with each variant. A variant gains if it names more without a wrong name or an
alarm more.
"""

from __future__ import annotations

from collections import Counter
import copy
from dataclasses import replace
import functools
import itertools
import sys
from typing import Any, TYPE_CHECKING
from unittest.mock import patch

from bearing_twin.diagnosis.combs.comb import comb_scores
from bearing_twin.diagnosis.combs.search import CombSearch
from bearing_twin.diagnosis.signal.lines import NEUTRAL
from bearing_twin.diagnosis.signal.spectra import envelope_spectra, local_floor, whiten, WHITENINGS
from bearing_twin.diagnosis.thresholds import SLIP
from bearing_twin.memory import keep_freed_memory
from bearing_twin.studies import impact_machines
from bearing_twin.studies.disturbances import CONDITIONS
from bearing_twin.studies.generalisation import judge_case, outcome
from bearing_twin.studies.output import arguments, print_table
import numpy as np

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Sequence

    from bearing_twin.diagnosis.combs.candidate import Candidate
    from bearing_twin.diagnosis.combs.comb import OrderSpectra
    from bearing_twin.diagnosis.signal.spectra import EnvelopeSpectra
    from numpy.typing import NDArray

    _Logs = NDArray[np.float32]


def _partial(
    spectrum: NDArray[np.complex64], width: int, *, cap: float = 4.0
) -> NDArray[np.complex64]:
    """Keep the root of each line's height over the floor. The cepstral one keeps nothing of it."""
    white = whiten(spectrum, width, cap=cap)
    flat = spectrum / np.sqrt(local_floor(np.abs(spectrum) ** 2, width))
    white[1] = flat / np.sqrt(np.maximum(np.abs(flat), 1e-6))
    return white


def _rescored(change: Callable[[_Logs, int], _Logs]) -> Callable[..., EnvelopeSpectra]:
    """Score other values of the bands; the effect sizes stay as they are."""

    def spectra(envelopes: Iterable[_Logs], rate: float, **known: Any) -> EnvelopeSpectra:
        found = envelope_spectra(envelopes, rate, **known)
        logs: _Logs = change(found.logs, len(found.power))
        return replace(found, logs=logs)

    return spectra


def _of_log(envelopes: Iterable[_Logs], rate: float, *, share: float, **known: Any) -> Any:
    """Score the spectrum of the logarithm of the envelope, or its mean with the squared one's."""
    parts = list(envelopes)
    found = envelope_spectra(parts, rate, **known)
    # The offset keeps the mean above zero; lines over their floor do not depend on it.
    logs = [np.log(np.maximum(p / p.mean(axis=0), 1e-3)) + 14.0 for p in parts]
    other = envelope_spectra(logs, rate, **known).logs
    return replace(found, logs=np.asarray(found.logs + share * (other - found.logs)))


def _coherence(logs: _Logs, bands: int, *, weighted: bool) -> _Logs:
    """
    Put the mean over all narrow bands in the place of the whole range.

    The mean of the lines of many narrow bands over their floor is the enhanced envelope spectrum:
    the squared spectral coherence integrated over the carriers (Antoni, Xin and Hamzaoui 2017).
    Each band may be weighted by how far its lines stand out.
    """
    ratio = np.expm1(logs).reshape(len(logs), -1, bands)[..., -((bands + 1) // 2) :]
    weight = np.maximum(ratio.var(axis=0) - 1.0, 1e-3) if weighted else np.ones(ratio.shape[1:])
    out = np.array(logs)
    out[:, ::bands] = np.log1p((weight * ratio).sum(axis=-1) / weight.sum(axis=-1))
    return out


def _one_whitening(logs: _Logs, bands: int, *, which: int) -> _Logs:
    return np.asarray(np.tile(logs[:, which * bands : (which + 1) * bands], len(WHITENINGS)))


def _cage_synchronous(spectra: OrderSpectra, orders: Any) -> OrderSpectra:
    """Mean of each line and of those a turn of the cage beside it, at the slip of its ball."""
    line = spectra.step * np.arange(1, len(spectra.logs) + 1)
    ball = orders.impacts('ball')
    gap = orders.ftf * line / (ball * np.maximum(np.rint(line / ball), 1.0))
    logs = np.where(spectra.quiet[:, np.newaxis], np.float32(NEUTRAL), spectra.logs)
    sides = (logs[spectra.rows(line + side * gap)] for side in (-1.0, 0.0, 1.0))
    return replace(spectra, logs=np.asarray(sum(sides) / np.float32(3.0)))


_best = CombSearch.best


def _best_ball(
    self: CombSearch,
    place: str,
    spectra: OrderSpectra | None = None,
    slips: tuple[float, float] = SLIP,
) -> Candidate:
    """Score a ball by its cycle: the lines of its impacts and of the cage beside them."""
    if place != 'ball':
        return _best(self, place, spectra, slips)
    again = copy.copy(self)
    again.spectra = _cage_synchronous(self.spectra, self.orders)
    again._scores = comb_scores(again.spectra, self._highest, len(WHITENINGS))
    given = None if spectra is None else _cage_synchronous(spectra, self.orders)
    return _best(again, place, given, slips)


_ENVELOPES = 'bearing_twin.diagnosis.window.envelope_spectra'

_BEST = 'bearing_twin.diagnosis.combs.search.CombSearch.best'

VARIANTS: dict[str, tuple[str, Any]] = {
    'as it is': (_BEST, _best),
    'log envelope': (_ENVELOPES, functools.partial(_of_log, share=1.0)),
    'log and squared envelope': (_ENVELOPES, functools.partial(_of_log, share=0.5)),
    'capped lines alone': (_ENVELOPES, _rescored(functools.partial(_one_whitening, which=0))),
    'cepstral pre-whitening alone': (
        _ENVELOPES,
        _rescored(functools.partial(_one_whitening, which=1)),
    ),
    'partial cepstral pre-whitening': (
        'bearing_twin.diagnosis.signal.demodulation.whiten',
        _partial,
    ),
    'spectral coherence': (_ENVELOPES, _rescored(functools.partial(_coherence, weighted=False))),
    'weighted coherence': (_ENVELOPES, _rescored(functools.partial(_coherence, weighted=True))),
    'cycle-synchronous with the cage': (_BEST, _best_ball),
}
"""What each variant puts in the place of a stage of the chain, by name."""


def numbers(balls: int, first: int) -> list[int]:
    """
    Return numbers of so many machines with a damaged ball, and a third of each other condition.

    >>> len(numbers(3, 0))
    7

    """
    wanted = {name: balls if name == 'ball' else balls // 3 for name in CONDITIONS}
    found: list[int] = []
    for number in itertools.count(first):
        if not any(wanted.values()):
            break
        condition = impact_machines.draw(number).condition
        if wanted[condition]:
            wanted[condition] -= 1
            found.append(number)
    return found


def main(argv: Sequence[str] | None = None) -> None:
    """Print the table."""
    parser = arguments(sys.modules[__name__], balls=99, first=3_400_000)
    args = parser.parse_args(argv)
    keep_freed_memory()
    cases = numbers(args.balls, args.first)
    rows = []
    for variant, (stage, instead) in VARIANTS.items():
        told: Counter[tuple[str, str]] = Counter()
        with patch(stage, instead):
            for number in cases:
                case, said = judge_case('impacts', number)
                alarm = case.condition == 'none' and said.level == 'fault'
                told[case.condition, 'wrong' if alarm else outcome(case, said)] += 1
        right = [told[name, 'right'] for name in CONDITIONS]
        rows.append((variant, *right, sum(told[name, 'wrong'] for name in CONDITIONS)))
    print_table(('variant', *(f'{name}: right' for name in CONDITIONS), 'wrong, alarms'), rows)


if __name__ == '__main__':
    main()
