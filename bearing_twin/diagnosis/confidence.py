# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Confidence: how often such an answer, with such a score, was right on simulated machines."""

from __future__ import annotations

import functools
from importlib import resources
import json

import numpy as np

__all__ = ['KINDS', 'LEAST_CONFIDENCE', 'confidence']

KINDS = ('fault', 'suspect', 'ambiguous', 'healthy')
"""Kinds of answers that have a confidence; ``'fault'`` stands for every named fault."""


LEAST_CONFIDENCE = 0.5
"""Confidence below which a bearing is not called healthy."""


@functools.cache
def _table() -> dict[str, dict[str, list[float]]]:
    text = resources.files('bearing_twin.diagnosis').joinpath('reliability.json')
    table: dict[str, dict[str, list[float]]] = json.loads(text.read_text('utf-8'))
    return table


def confidence(result: str, score: float) -> float:
    """
    Share of right answers among simulated ones of the same kind and score.

    Right is: a named fault that is there, and no other; a suspect or ambiguous answer that names
    the fault among others; healthy where there is no fault, however small. The machines are drawn
    at random, as many healthy as damaged ones (``python -m bearing_twin.studies.reliability``);
    the share on your machines is another one as their faults are larger or smaller.

    Parameters
    ----------
    result
        Answer, one of :data:`bearing_twin.bearing.RESULTS`.
    score
        Largest comb score of the families named; of all families where none is.

    Returns
    -------
    0 to 1; 0 for ``'insufficient'``.

    >>> confidence('insufficient', 9.0)
    0.0
    >>> confidence('inner', 12.0) > confidence('inner', 6.0)
    True

    """
    if result == 'insufficient':
        return 0.0
    rows = _table()[result if result in KINDS else 'fault']
    return float(np.interp(score, rows['score'], rows['right']))
