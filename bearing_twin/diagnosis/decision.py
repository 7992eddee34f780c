# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""From comb scores to a verdict: which fault, if any, and why."""

from __future__ import annotations

from dataclasses import dataclass
import math
from typing import TYPE_CHECKING

from bearing_twin.bearing import fault_orders
from bearing_twin.diagnosis.comb import comb_scores, HARMONICS, OrderSpectra
from bearing_twin.diagnosis.gate import CAGE_TURNS
from bearing_twin.diagnosis.result import FAMILIES
from bearing_twin.diagnosis.spectra import WHITENINGS
import numpy as np

if TYPE_CHECKING:
    from collections.abc import Sequence

    from bearing_twin.bearing import Bearing, FaultFrequencies
    from bearing_twin.diagnosis.shaft import ShaftSpeed
    from numpy.typing import NDArray

__all__ = [
    'INDEX_FAULT',
    'INDEX_STRIKE',
    'INDEX_SUSPECT',
    'SLIP',
    'Z_CAGE',
    'Z_FAULT',
    'Candidate',
    'Judge',
    'Verdict',
    'decide',
    'family_order',
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

INDEX_STRIKE = 2.0
"""Modulation index of the cage's comb, with lines kept and with lines capped, above which the
envelope is more strike than ripple: half of the 4 that sharp impacts reach with four teeth."""

JOINT_SLIP = 0.008
"""Two faults of one bearing share one cage: their slips agree to this much."""

CARRIER = 12.0
"""Multiples of the outer race's frequency above which its carriers count."""

RIVAL = 1.4
"""Two faults that explain each other away are told apart from this ratio of evidence on."""

BLURRED = 0.9
"""Sidebands over teeth above which a comb may itself be a sideband of another fault."""

GATED = 0.5
"""Sidebands over teeth above which impacts are gated, not swayed. A force that varies as 1 + cos,
the most that a rotating load does to a fixed place, makes shaft sidebands of 0.49 in the squared
envelope. A damaged outer race stands still; an inner race passes through the load zone."""

_SLIP_COST = 0.02
_SLOW_CAGE = 0.12
_HANN_BINS = 1.5
_STEADY = 0.004
_SIDEBANDS = 4
_RACES = ('inner', 'outer')
_UNTESTED = 1.0


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
    """Cage slip that explains it."""
    z: float
    """Score less the cost of an unlikely slip."""
    index: float
    """Modulation index."""
    band: int
    """Number of the band in the tree."""
    teeth: int
    """Number of teeth that do not hide behind a shaft harmonic."""
    sidebands: float
    """Mean amplitude of the shaft sidebands over that of the teeth."""
    cage_sidebands: float
    """The same for sidebands at the cage's frequency; of the outer race only, else 0."""

    @property
    def evidence(self) -> float:
        """
        Return what faults that claim the same lines are compared by.

        The sidebands of a race fault are weaker than its teeth, so a comb that stands beside
        stronger lines is more likely a sideband itself.
        """
        return self.z * self.index / max(self.sidebands, 0.25)

    def __str__(self) -> str:
        return (
            f'{self.family}: comb at {self.order:.3f} orders, z {self.z:.1f}, '
            f'modulation index {self.index:.2f}'
        )


@dataclass(frozen=True)
class Verdict:
    """The decision on one window or on the mean of several."""

    result: str
    level: str
    faults: tuple[str, ...]
    confidence: float
    reasons: tuple[str, ...]
    candidates: dict[str, Candidate]
    strongest: Candidate | None = None

    @property
    def evidence(self) -> float:
        """Evidence of the strongest family; 0 without any."""
        return self.strongest.evidence if self.strongest else 0.0


class Judge:
    """Scores the families of one bearing in the envelope spectra of one window."""

    def __init__(self, spectra: OrderSpectra, bearing: Bearing, speed: ShaftSpeed) -> None:
        self.orders = fault_orders(bearing)
        self._slipped = fault_orders(bearing, SLIP[1])
        self._n_balls = bearing.n_balls
        self._uncertainty = speed.uncertainty
        self.top = len(spectra.logs) * spectra.step
        shaft = np.arange(1.0, self.top + 1.0)
        self._silent = spectra.near(shaft, 1.25 * spectra.step)
        self.spectra = spectra.silenced(shaft, 1.25 * spectra.step)
        self._all = spectra
        highest = 1.08 * max(family_order(name, self.orders) for name in FAMILIES)
        self._scores = comb_scores(self.spectra, highest, len(WHITENINGS))

    def best(
        self, family: str, spectra: OrderSpectra, slips: tuple[float, float] = SLIP
    ) -> Candidate:
        """Best comb of a family within a range of slip."""
        order = family_order(family, self.orders)
        slope = (family_order(family, self._slipped) - order) / SLIP[1]
        ends = sorted(order + slope * slip for slip in slips)
        slack = self._uncertainty * order
        first = int(np.searchsorted(self._scores.grid, ends[0] - slack))
        last = int(np.searchsorted(self._scores.grid, ends[1] + slack))
        first = min(first, len(self._scores.grid) - 1)
        grid = self._scores.grid[first : max(last, first + 1)]
        z, bands = self._scores.judge(spectra, grid)
        # What the uncertainty of the speed may explain is no slip and costs nothing.
        away = np.maximum(np.abs(grid - order) - slack, 0.0) * np.sign(grid - order)
        slip = away / slope
        z = z - (slip / _SLIP_COST) ** 2
        at = int(np.argmax(z))
        found = float(grid[at])
        index, band = modulation_index(spectra, found, bands[at, 0], family)
        teeth = found * np.arange(1, HARMONICS + 1)
        alive = int((~self._silent[spectra.rows(teeth)]).sum())
        tested = family in _RACES and z[at] >= Z_FAULT
        sidebands = sideband_ratio(spectra, found, band) if tested else _UNTESTED
        of_cage = 0.0
        if tested and family == 'outer':
            # A ball passes the outer race n_balls times a cage turn, whatever the slip.
            of_cage = sideband_ratio(spectra, found, band, found / self._n_balls)
        return Candidate(
            family, found, float(slip[at]), float(z[at]), index, band, alive, sidebands, of_cage
        )

    def capped_index(self, cage: Candidate) -> float:
        """Modulation index of the cage's comb with lines capped."""
        power = _comb_power(self.spectra, cage.order, cage.band) / _HANN_BINS
        return 2.0 * math.sqrt(power)

    def teeth_of_cage(self, found: Sequence[Candidate]) -> bool:
        """
        Whether the combs found are teeth of one comb of the cage's frequency.

        Either the outer race's has cage sidebands as high as its teeth; or there are several, and
        a cage with more slip than is looked for shows more than any of them.
        """
        cages = [c.order / self._n_balls for c in found if c.cage_sidebands > GATED]
        slow = self.slow_cage() if len(found) > 1 else None
        if slow is not None and slow.z >= max(c.z for c in found):
            sides = [sideband_ratio(self.spectra, c.order, c.band, slow.order) for c in found]
            cages += [slow.order] if min(sides) > GATED else []
        return any(all(_on_comb(c, cage, self._all.step) for c in found) for cage in cages)

    def slow_cage(self) -> Candidate | None:
        """Best comb of a cage that slips by up to ``_SLOW_CAGE``, whatever that costs."""
        slowest = self.orders.ftf + (self._slipped.ftf - self.orders.ftf) / SLIP[1] * _SLOW_CAGE
        first, last = np.searchsorted(self._scores.grid, (slowest, self.orders.ftf))
        if last <= first:
            return None
        at = int(first + np.argmax(self._scores.z[first:last]))
        order, z = float(self._scores.grid[at]), float(self._scores.z[at])
        slip = _SLOW_CAGE * (self.orders.ftf - order) / (self.orders.ftf - slowest)
        found = Candidate('cage', order, slip, z, 0.0, 0, HARMONICS, _UNTESTED, 0.0)
        return found if z >= Z_CAGE else None

    def mirrored(self, other: Candidate) -> float | None:
        """
        Amplitude of the inner race's comb over that of another's, where they coincide.

        A comb may be a shaft sideband of the inner race's if that one, an integer beside it, lies
        where a slip about as likely may put it. None if it does not.
        """
        order = self.orders.bpfi
        slope = (self._slipped.bpfi - order) / SLIP[1]
        # Not much less likely than the slip of the outer race that it would replace.
        likely = math.hypot(other.slip, _SLIP_COST)
        slack = self._uncertainty * order + 2.0 * self._all.step
        first = math.ceil(order + slope * max(SLIP[0], -likely) - slack - other.order)
        last = math.floor(order + slope * min(SLIP[1], likely) + slack - other.order)
        sides = [side for side in range(first, last + 1) if side]
        if not sides:
            return None
        # The inner race's own teeth may hide behind shaft harmonics: they are looked at here.
        near = np.arange(-2.0, 2.25, 0.25) * self._all.step
        own = _comb_power(self._all, other.order, other.band)
        power = max(
            _comb_power(self._all, other.order + side + away, other.band)
            for side in sides
            for away in near
        )
        return math.sqrt(power / max(own, 1e-30))

    @property
    def steady(self) -> bool:
        """Whether the shaft speed is known well enough to compare slips and place sidebands."""
        return self._uncertainty <= _STEADY

    def hidden(self, family: str) -> Candidate | None:
        """Comb of a family that shows, but whose teeth hide behind the shaft's harmonics."""
        order = family_order(family, self.orders)
        slack = self._uncertainty * order + 1.25 * self._all.step
        if abs(order - round(order)) > slack:
            return None
        found = self.best(family, self._all, (0.0, 0.0))
        return found if found.z >= Z_FAULT and found.index >= INDEX_FAULT else None

    def without(self, candidate: Candidate) -> OrderSpectra:
        """
        Spectra without the lines that a fault explains: its harmonics and their sidebands.

        A race fault is modulated at the shaft's speed, a ball fault at the cage's.
        """
        gap = {'inner': 1.0, 'outer': 1.0, 'ball': self.orders.ftf, 'cage': 0.0}
        reach = range(-_SIDEBANDS, _SIDEBANDS + 1) if gap[candidate.family] else (0,)
        count = int(self.top / candidate.order) + 1
        lines = [
            harmonic * candidate.order + side * gap[candidate.family]
            for harmonic in range(1, count + 1)
            for side in reach
        ]
        return self.spectra.silenced(lines, 2.0 * self.spectra.step)

    def joint_slips(self, primary: Candidate) -> tuple[float, float]:
        """Slip that another fault of the same bearing may have, given the primary one's."""
        if not self.steady or primary.family == 'cage':
            return SLIP
        return primary.slip - JOINT_SLIP, primary.slip + JOINT_SLIP


def modulation_index(
    spectra: OrderSpectra, order: float, band_scores: NDArray[np.float32], family: str
) -> tuple[float, int]:
    """
    Modulation index of a comb, the largest of the bands that show it, and that band.

    Root of the sum over harmonics of the squared relative amplitudes of the squared envelope,
    noise floor taken off: m for an envelope 1 + m cos. It is taken from the spectrum with capped
    lines, so that steady lines beating with one another do not count. The cage's, whose pulses
    are slow and smooth, is taken with lines kept. A healthy bearing forces its housing at the
    outer race's frequency and its low multiples (variable compliance); for that family the index
    counts only in bands that begin above ``CARRIER`` multiples.
    """
    bands = len(spectra.carrier)
    lines = slice(0, bands) if family == 'cage' else slice(bands, None)
    teeth = order * np.arange(1, HARMONICS + 1)
    rows = spectra.rows(teeth[:, None] + spectra.step * np.arange(-1, 2))
    # A line spreads over three bins of the Hann window, whose noise bandwidth is 1.5 bins.
    power = spectra.excess[rows.ravel(), lines].sum(axis=0) / _HANN_BINS
    if family == 'outer':
        # Half of the range stays in any case, for low sample rates.
        limit = min(CARRIER * order, 0.5 * float(spectra.carrier.max()))
        power[spectra.carrier < limit] = 0.0
    index = 2.0 * np.sqrt(power)
    shown = band_scores >= min(3.0, float(band_scores.max()))
    band = int(np.argmax(np.where(shown, index, -1.0)))
    return float(index[band]), band


def _comb_power(spectra: OrderSpectra, order: float, band: int) -> float:
    """Relative power of the lines of a comb in one band, lines capped."""
    teeth = order * np.arange(1, HARMONICS + 1)
    rows = spectra.rows(teeth[:, None] + spectra.step * np.arange(-1, 2))
    return float(spectra.excess[rows, len(spectra.carrier) + band].sum())


def sideband_ratio(spectra: OrderSpectra, order: float, band: int, gap: float = 1.0) -> float:
    """Amplitude of the lines one and two gaps beside the teeth of a comb over the teeth's."""
    teeth = order * np.arange(1, HARMONICS + 1)
    sides = gap * np.array([0.0, -2.0, -1.0, 1.0, 2.0])
    rows = spectra.rows(sides[:, None, None] + teeth[:, None] + spectra.step * np.arange(-1, 2))
    power = spectra.excess[rows, len(spectra.carrier) + band].sum(axis=(1, 2))
    return float(np.sqrt(power[1:].mean() / max(float(power[0]), 1e-30)))


def decide(
    spectra: OrderSpectra, bearing: Bearing, speed: ShaftSpeed, revolutions: float
) -> Verdict:
    """
    Judge the envelope spectra of a window, or of several averaged.

    Parameters
    ----------
    spectra
        Envelope spectra over orders of ``speed``.
    bearing
        Geometry.
    speed
        Refined shaft speed.
    revolutions
        Shaft turns in all windows together.

    """
    judge = Judge(spectra, bearing, speed)
    candidates = {family: judge.best(family, judge.spectra) for family in FAMILIES}
    strong = [
        c
        for c in candidates.values()
        if c.z >= (Z_CAGE if c.family == 'cage' else Z_FAULT)
        and c.index >= INDEX_SUSPECT
        and c.teeth >= 2
    ]
    # One comb in the windows of two families belongs to the likelier slip.
    strong = [
        c
        for c in strong
        if all(o.z <= c.z for o in strong if abs(o.order - c.order) < 2.0 * spectra.step)
    ]
    others = [c for c in strong if c.family != 'cage']
    cage = next((c for c in strong if c.family == 'cage'), None)
    if cage is not None and cage.index >= INDEX_FAULT and _rules(cage, others, spectra.step):
        return _judge_cage(judge, cage, candidates, revolutions)
    strong = others
    for gated in [c for c in strong if c.family in ('outer', 'ball')]:
        sidebands = sideband_ratio(judge.spectra, gated.order, gated.band)
        mirrored = judge.mirrored(gated) if sidebands > GATED else None
        if mirrored is None or mirrored * RIVAL <= 1.0:
            continue
        leads = all(c.evidence <= gated.evidence for c in strong)
        strong = [c for c in strong if c is not gated]
        if leads and (mirrored < BLURRED or all(c.family != 'inner' for c in strong)):
            inner = candidates['inner']
            text = (
                f'the comb at {gated.order:.3f} orders has shaft sidebands of {sidebands:.1f} of '
                'its height and may be one of the inner race, which passes through the load '
                'zone; a longer window or steadier conditions part them'
            )
            level = 'fault' if gated.index >= INDEX_FAULT else 'suspect'
            return Verdict(
                'ambiguous', level, ('inner', gated.family), 0.5,
                (str(gated), str(inner), text), candidates, gated,
            )  # fmt: skip
    hidden = [] if strong else [c for c in map(judge.hidden, FAMILIES[:3]) if c is not None]
    if hidden:
        text = (
            f'{hidden[0].family} order {hidden[0].order:.3f} and shaft order '
            f'{round(hidden[0].order)} coincide within the resolution of this window: the lines '
            'there belong to either; a longer window or an exact speed may part them'
        )
        return Verdict(
            'ambiguous', 'suspect', tuple(c.family for c in hidden), 0.5,
            (str(hidden[0]), text), candidates,
        )  # fmt: skip
    if not strong:
        largest = max(c.z for c in candidates.values())
        confidence = 1.0 / (1.0 + math.exp(min(largest, 20.0) - Z_FAULT))
        text = f'no fault comb above z {Z_FAULT:g} with modulation index {INDEX_SUSPECT:g}'
        return Verdict('healthy', 'ok', (), 0.5 + 0.5 * confidence, (text,), candidates)
    primary = max(strong, key=lambda c: c.evidence)
    rest = judge.without(primary)
    rivals = [
        c
        for c in strong
        if c is not primary
        and min(c.index, primary.index) >= INDEX_FAULT
        and (c.evidence * RIVAL > primary.evidence or primary.sidebands > BLURRED)
        and judge.best(c.family, rest).z < Z_FAULT
        and judge.best(primary.family, judge.without(c)).z < Z_FAULT
    ]
    if rivals:
        both = (primary, *rivals)
        text = (
            f'{primary.family} at {primary.order:.3f} and {rivals[0].family} at '
            f'{rivals[0].order:.3f} orders explain the same lines, one as sidebands of the other; '
            'a longer window or an exact speed may part them'
        )
        return Verdict(
            'ambiguous', 'fault', tuple(c.family for c in both), 0.5,
            (*map(str, both), text), candidates, primary,
        )  # fmt: skip
    found: list[Candidate] = [primary]
    weak: list[Candidate] = []
    for other in strong:
        if other is not primary:
            again = judge.best(other.family, rest, judge.joint_slips(primary))
            if again.z >= Z_FAULT and again.teeth >= 2:
                certain = again.index >= INDEX_FAULT and judge.steady
                (found if certain else weak).append(again)
    sure = [c for c in found if c.index >= INDEX_FAULT]
    doubtful = [c for c in weak if c.index >= INDEX_FAULT]
    if sure and judge.teeth_of_cage([*sure, *doubtful]):
        text = (
            'as high stand the other multiples of the cage order: a cage that strikes, or a ball '
            'that strikes once a cage turn; a longer window tells'
        )
        return Verdict(
            'suspect', 'suspect', ('cage',), 0.5, (*map(str, sure), text), candidates, sure[0]
        )
    faults = tuple(c.family for c in sure)
    margin = primary.z - max((c.z for c in weak), default=0.0)
    confidence = 1.0 - math.exp(-max(margin, 0.0) / Z_FAULT)
    reasons = [str(c) for c in (*found, *weak)]
    candidates |= {c.family: c for c in (*found, *weak)}
    if faults and doubtful:
        reasons.append(
            'the shaft speed is not known well enough to name a second fault beside the first: '
            'its lines may be sidebands; give a measured speed'
        )
        if max(c.z for c in doubtful) * RIVAL > primary.z:
            either = (primary.family, *(c.family for c in doubtful))
            return Verdict('ambiguous', 'fault', either, 0.5, tuple(reasons), candidates, primary)
    if not faults:
        reasons.append(f'modulation index below {INDEX_FAULT:g}: not an alarm')
        suspects = tuple(c.family for c in (*found, *weak))
        return Verdict(
            'suspect', 'suspect', suspects, confidence, tuple(reasons), candidates, primary
        )
    return Verdict(faults[0], 'fault', faults, confidence, tuple(reasons), candidates, primary)


def _rules(cage: Candidate, others: Sequence[Candidate], step: float) -> bool:
    """
    Whether the cage is behind all that shows.

    Others are then either no faults, or weaker and on multiples of the cage's order: a strike once
    a cage turn has harmonics everywhere, the ball pass order of the outer race among them.
    """
    for other in others:
        weaker = other.z < cage.z and other.index <= cage.index
        if other.index >= INDEX_FAULT and not (_on_comb(other, cage.order, step) and weaker):
            return False
    return True


def _on_comb(candidate: Candidate, cage_order: float, step: float) -> bool:
    """Whether every second tooth of a comb, at least, lies on a multiple of the cage's order."""
    multiple = round(2.0 * candidate.order / cage_order)
    away = abs(2.0 * candidate.order - multiple * cage_order)
    return away <= (4.0 + 0.25 * multiple) * step


def _judge_cage(
    judge: Judge, cage: Candidate, candidates: dict[str, Candidate], revolutions: float
) -> Verdict:
    """Tell a cage fault from a ball that strikes once a cage turn."""
    confidence = 1.0 - math.exp(-cage.z / Z_CAGE)
    turns = revolutions * judge.orders.ftf
    # A strike has every harmonic, the ball pass order of the outer race exactly among them; what
    # shows the ball's order better than that is the ripple of a ball in and out of the load.
    toothless = candidates['outer'].z < candidates['ball'].z
    if toothless or min(cage.index, judge.capped_index(cage)) < INDEX_STRIKE:
        text = (
            'ball and cage coincide: the envelope ripples with the cage; a ball strikes while it '
            'passes the load zone, once a cage turn, or the cage is damaged'
        )
        return Verdict(
            'ambiguous',
            'suspect',
            ('ball', 'cage'),
            confidence,
            (str(cage), text),
            candidates,
            cage,
        )
    if turns < CAGE_TURNS:
        text = f'{turns:.0f} cage turns: {CAGE_TURNS:g} are needed to call it a cage fault'
        return Verdict(
            'suspect',
            'suspect',
            ('cage',),
            confidence,
            (str(cage), text),
            candidates,
            cage,
        )
    return Verdict('cage', 'fault', ('cage',), confidence, (str(cage),), candidates, cage)
