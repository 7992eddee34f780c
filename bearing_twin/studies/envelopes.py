# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""
Which envelope names most: the chain with other spectra of the envelopes.

``python -m bearing_twin.studies.envelopes [BALLS [FIRST]]`` draws BALLS (99) machines with a
damaged ball and a third as many of each other condition, with the trains of impacts of
:mod:`bearing_twin.studies.generalisation`, from number FIRST (3400000) on. It judges them,
each record as one window, with the chain as it is and with each variant. A variant gains if it
names more without a wrong name or an alarm more.
"""

from __future__ import annotations

from collections import Counter
from dataclasses import replace
import functools
import itertools
import sys
from typing import Any, TYPE_CHECKING

from bearing_twin.diagnosis import DiagnosisSettings
from bearing_twin.diagnosis.chain import Excerpt
from bearing_twin.diagnosis.signal.periodogram import Lapping
from bearing_twin.diagnosis.signal.shaft import Turning
from bearing_twin.diagnosis.signal.spectra import envelope_spectra, WHITENINGS
from bearing_twin.memory import keep_freed_memory
from bearing_twin.studies import impact_machines
from bearing_twin.studies.disturbances import CONDITIONS
from bearing_twin.studies.generalisation import outcome
from bearing_twin.studies.output import arguments, print_table
import numpy as np

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Sequence

    from bearing_twin.diagnosis.signal.spectra import EnvelopeSpectra
    from numpy.typing import NDArray

    _Logs = NDArray[np.float32]


def _rescored(change: Callable[[_Logs, int], _Logs]) -> Callable[..., EnvelopeSpectra]:
    """Score other values of the bands; the effect sizes stay as they are."""

    def spectra(envelopes: Iterable[Lapping], rate: float, **known: Any) -> EnvelopeSpectra:
        found = envelope_spectra(envelopes, rate, **known)
        logs: _Logs = change(found.logs, len(found.power))
        return replace(found, logs=logs)

    return spectra


def _of_log(envelopes: Iterable[Lapping], rate: float, *, share: float, **known: Any) -> Any:
    """Score the spectrum of the logarithm of the envelope, or its mean with the squared one's."""
    parts = list(envelopes)
    wholes = (part.joined() for part in parts)
    # The offset keeps the mean above zero; lines over their floor do not depend on it.
    logs = [Lapping([np.log(np.maximum(p / p.mean(axis=0), 1e-3)) + 14.0]) for p in wholes]
    found, other = (envelope_spectra(each, rate, **known) for each in (parts, logs))
    delta = other.logs - found.logs
    return replace(found, logs=np.asarray(found.logs + share * delta))


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


VARIANTS: dict[str, Callable[..., EnvelopeSpectra]] = {
    'as it is': envelope_spectra,
    'log envelope': functools.partial(_of_log, share=1.0),
    'log and squared envelope': functools.partial(_of_log, share=0.5),
    'capped lines alone': _rescored(functools.partial(_one_whitening, which=0)),
    'cepstral pre-whitening alone': _rescored(functools.partial(_one_whitening, which=1)),
    'spectral coherence': _rescored(functools.partial(_coherence, weighted=False)),
    'weighted coherence': _rescored(functools.partial(_coherence, weighted=True)),
}
"""What makes the spectra of the squared envelopes, by name."""


def judge(number: int) -> tuple[str, dict[str, str]]:
    """
    Return the condition of a machine, and the :func:`outcome` for its record with each variant.

    >>> judge(3_400_000)[0]
    'inner'

    """
    case = impact_machines.draw(number)
    x = impact_machines.record(case)
    turning = Turning(np.array([case.given_hz]), np.array([len(x)]))
    excerpt = Excerpt.of(x, turning, case.sample_rate, case.geometry, DiagnosisSettings())
    found = {}
    for variant, spectra_of in VARIANTS.items():
        # What is demodulated already is that of all.
        said = replace(excerpt, spectra_of=spectra_of).analyse().alone
        alarm = case.condition == 'none' and said.level == 'fault'
        found[variant] = 'wrong' if alarm else outcome(case, said)
    return case.condition, found


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
    told: Counter[tuple[str, str, str]] = Counter()
    for number in numbers(args.balls, args.first):
        condition, found = judge(number)
        told.update((variant, condition, said) for variant, said in found.items())
    rows = [
        (
            variant,
            *(told[variant, name, 'right'] for name in CONDITIONS),
            sum(told[variant, name, 'wrong'] for name in CONDITIONS),
        )
        for variant in VARIANTS
    ]
    print_table(('variant', *(f'{name}: right' for name in CONDITIONS), 'wrong, alarms'), rows)


if __name__ == '__main__':
    main()
