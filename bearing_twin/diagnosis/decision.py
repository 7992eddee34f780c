# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""From comb scores to a verdict: which fault, if any, and why."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from bearing_twin.bearing import fault_orders
from bearing_twin.diagnosis.comb import HARMONICS, CombScores, OrderSpectra, comb_scores
from bearing_twin.diagnosis.gate import CAGE_TURNS
from bearing_twin.diagnosis.result import FAMILIES
from bearing_twin.diagnosis.spectra import WHITENINGS

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from bearing_twin.bearing import Bearing, FaultFrequencies
    from bearing_twin.diagnosis.shaft import ShaftSpeed

__all__ = [
    'INDEX_FAULT',
    'INDEX_SUSPECT',
    'SLIP',
    'Z_CAGE',
    'Z_FAULT',
    'Candidate',
    'Verdict',
    'decide',
]

Z_FAULT = 5.5
"""Score above which a comb is not chance."""

Z_CAGE = 8.0
"""The same for the cage, whose low orders have a wider null."""

INDEX_FAULT = 0.6
"""Modulation index above which a significant comb is a fault."""

INDEX_SUSPECT = 0.3
"""Modulation index above which a significant comb is worth a remark."""

SLIP = (-0.015, 0.06)
"""Cage slip looked for. Below zero: a contact angle that the geometry does not know of."""

_SLIP_COST = 0.02
_SIDEBANDS = (-2, -1, 0, 1, 2)


def family_order(family: str, orders: FaultFrequencies) -> float:
    """Order of the impacts of a family: a ball strikes twice a spin."""
    return {
        'inner': orders.bpfi,
        'outer': orders.bpfo,
        'ball': 2.0 * orders.bsf,
        'cage': orders.ftf,
    }[family]


@dataclass(frozen=True)
class Candidate:
    """The best comb of one family."""

    family: str
    order: float
    """Measured fundamental, multiples of the shaft speed."""
    slip: float
    z: float
    """Score less the cost of an unlikely slip."""
    index: float
    """Modulation index."""
    band: int
    """Number of the band in the tree."""
    teeth: tuple[float, ...]
    """Orders of the teeth that may speak."""


@dataclass(frozen=True)
class Verdict:
    """The decision on one window or on the mean of several."""

    result: str
    level: str
    faults: tuple[str, ...]
    confidence: float
    reasons: tuple[str, ...]
    candidates: dict[str, Candidate]
    strongest: Candidate | None = field(default=None)


def _lines(candidate: Candidate, orders: FaultFrequencies, top: float) -> list[float]:
    """Orders of all lines that a fault of this family explains, sidebands included."""
    gap = {'inner': 1.0, 'outer': 1.0, 'ball': orders.ftf, 'cage': 0.0}[candidate.family]
    sides = _SIDEBANDS if gap else (0,)
    count = int(top / candidate.order) + 1
    return [h * candidate.order + k * gap for h in range(1, count + 1) for k in sides]


def _index(
    spectra: OrderSpectra, order: float, band_scores: NDArray[np.float32]
) -> tuple[float, int]:
    """Modulation index, the largest of the bands in which the comb shows, and that band."""
    power = np.zeros(spectra.excess.shape[1])
    for harmonic in range(1, HARMONICS + 1):
        row = int(spectra.rows([harmonic * order])[0])
        # A line spreads over three bins of the Hann window, whose noise bandwidth is 1.5 bins.
        power += spectra.excess[max(row - 1, 0) : row + 2].sum(axis=0) / 1.5
    index = 2.0 * np.sqrt(power)
    shown = band_scores >= min(3.0, float(band_scores.max()))
    band = int(np.argmax(np.where(shown, index, -1.0)))
    return float(index[band]), band


def _candidate(
    family: str,
    bearing: Bearing,
    spectra: OrderSpectra,
    scores: CombScores,
    uncertainty: float,
    silent: NDArray[np.bool_],
) -> Candidate:
    slips = np.array([SLIP[0], 0.0, SLIP[1]])
    ends = [family_order(family, fault_orders(bearing, float(slip))) for slip in slips]
    low, high = min(ends) * (1.0 - uncertainty), max(ends) * (1.0 + uncertainty)
    first, last = np.searchsorted(scores.grid, (low, high))
    grid = scores.grid[first : max(last, first + 1)]
    z, bands = scores.judge(spectra, grid)
    # Position within the window as slip; what the speed's uncertainty may explain costs nothing.
    away = grid / ends[1] - 1.0
    away = np.sign(away) * np.maximum(np.abs(away) - uncertainty, 0.0)
    slip = away * ends[1] / (ends[2] - ends[1]) * SLIP[1]
    z = z - (slip / _SLIP_COST) ** 2
    best = int(np.argmax(z))
    order = float(grid[best])
    teeth = [h * order for h in range(1, HARMONICS + 1)]
    alive = tuple(
        tooth for tooth, row in zip(teeth, spectra.rows(teeth), strict=True) if not silent[row]
    )
    index, band = _index(spectra, order, bands[best, 0])
    return Candidate(family, order, float(slip[best]), float(z[best]), index, band, alive)


def decide(
    spectra: OrderSpectra, bearing: Bearing, speed: ShaftSpeed, revolutions: float
) -> Verdict:
    """Judge the envelope spectra of a window.

    Parameters
    ----------
    spectra
        Envelope spectra over orders of ``speed``.
    bearing
        Geometry.
    speed
        Refined shaft speed.
    revolutions
        Shaft turns in one window.
    """
    orders = fault_orders(bearing)
    top = float(len(spectra.logs)) * spectra.step
    shaft = np.arange(1.0, top + 1.0)
    width = 1.25 * spectra.step
    silent = spectra.near(shaft, width)
    quiet = spectra.silenced(shaft, width)
    highest = max(family_order(name, orders) for name in FAMILIES) * 1.08
    scores = comb_scores(quiet, highest, len(WHITENINGS))

    def best_of(family: str, within: OrderSpectra) -> Candidate:
        return _candidate(family, bearing, within, scores, speed.uncertainty, silent)

    def without(candidate: Candidate, within: OrderSpectra) -> OrderSpectra:
        return within.silenced(_lines(candidate, orders, top), 2.0 * spectra.step)

    candidates = {family: best_of(family, quiet) for family in FAMILIES}
    strong = [
        c
        for c in candidates.values()
        if c.z >= (Z_CAGE if c.family == 'cage' else Z_FAULT)
        and c.index >= INDEX_SUSPECT
        and len(c.teeth) >= 2
        and (c.family != 'cage' or revolutions * orders.ftf >= CAGE_TURNS)
    ]
    races = [c for c in strong if c.family != 'cage'] or strong
    # One comb in the windows of two families belongs to the likelier slip.
    races = [
        c
        for c in races
        if all(o.z <= c.z for o in races if abs(o.order - c.order) < 2.0 * spectra.step)
    ]
    if not races:
        largest = max(c.z for c in candidates.values())
        confidence = 1.0 / (1.0 + math.exp(min(largest, 20.0) - Z_FAULT))
        return Verdict('healthy', 'ok', (), 0.5 + 0.5 * confidence, (), candidates)
    # Explaining away: the primary fault is the one that survives when any other is taken out.
    residual = {
        c.family: min(
            [c.z] + [best_of(c.family, without(o, quiet)).z for o in races if o is not c]
        )
        for c in races
    }
    primary = max(races, key=lambda c: residual[c.family])
    rest = without(primary, quiet)
    found: list[Candidate] = [primary]
    weak: list[Candidate] = []
    for other in races:
        if other is primary:
            continue
        again = best_of(other.family, rest)
        if again.z >= Z_FAULT and len(again.teeth) >= 2:
            (found if again.index >= INDEX_FAULT else weak).append(again)
    faults = tuple(c.family for c in found if c.index >= INDEX_FAULT)
    margin = primary.z - max([c.z for c in weak], default=0.0)
    confidence = 1.0 - math.exp(-max(margin, 0.0) / Z_FAULT)
    reasons = [
        f'{c.family}: comb at {c.order:.3f} orders, z {c.z:.1f}, modulation index {c.index:.2f}'
        for c in (*found, *weak)
    ]
    if not faults:
        reasons.append(f'modulation index below {INDEX_FAULT:g}: not an alarm')
        named = tuple(c.family for c in (*found, *weak))
        return Verdict(
            'suspect', 'suspect', named, confidence, tuple(reasons), candidates, primary
        )
    candidates = candidates | {c.family: c for c in found}
    return Verdict(faults[0], 'fault', faults, confidence, tuple(reasons), candidates, primary)
