# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""From comb scores to a verdict: which fault, if any, and why."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from bearing_twin.bearing import PLACES
from bearing_twin.diagnosis.confidence import confidence
from bearing_twin.diagnosis.families import Candidate, Judge
from bearing_twin.diagnosis.gate import CAGE_TURNS
from bearing_twin.diagnosis.lines import on_comb, sideband_ratio
from bearing_twin.diagnosis.thresholds import (
    BLURRED,
    GATED,
    INDEX_FAULT,
    INDEX_STRIKE,
    INDEX_SUSPECT,
    RIVAL,
    SLIP_COST,
    Z_CAGE,
    Z_FAULT,
)

if TYPE_CHECKING:
    from collections.abc import Sequence

    from bearing_twin.bearing import Bearing
    from bearing_twin.diagnosis.comb import OrderSpectra
    from bearing_twin.diagnosis.shaft import ShaftSpeed

__all__ = ['Verdict', 'decide']


@dataclass(frozen=True)
class Verdict:
    """The decision on one window or on the mean of several."""

    result: str
    level: str
    faults: tuple[str, ...]
    reasons: tuple[str, ...]
    candidates: dict[str, Candidate]
    strongest: Candidate | None = None

    @property
    def confidence(self) -> float:
        """Share of right answers among simulated ones like this: see ``confidence``."""
        named = self.faults or tuple(self.candidates)
        return confidence(self.result, max(self.candidates[name].z for name in named))

    @property
    def evidence(self) -> float:
        """Evidence of the strongest family; 0 without any."""
        return self.strongest.evidence if self.strongest else 0.0


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
    candidates: dict[str, Candidate] = {
        family: judge.best(family, judge.spectra) for family in PLACES
    }
    strong = [
        c
        for c in candidates.values()
        if c.z >= (Z_CAGE if c.family == 'cage' else Z_FAULT)
        and c.index >= INDEX_SUSPECT
        and c.teeth >= 2
    ]
    own = [c for c in strong if not (judge.foreign(c) or judge.shafts_own(c))]
    if strong and not own:
        return _not_its_own(judge, max(strong, key=lambda c: c.evidence), candidates)
    strong, contested = _one_comb_one_family(judge, strong)
    cage = next((c for c in own if c.family == 'cage'), None)
    strong = [c for c in strong if c.family != 'cage']
    if cage is not None and cage.index >= INDEX_FAULT and _rules(cage, strong, spectra.step):
        return _judge_cage(judge, cage, candidates, revolutions)
    strong, verdict = _without_gated(judge, strong, candidates)
    if verdict is None:
        verdict = _nothing_strong(judge, candidates) if not strong else None
    if verdict is not None:
        return verdict
    # What belongs to no part of this bearing must not hide what does.
    left = [c for c in strong if c in own]
    if not left:
        return _not_its_own(judge, max(strong, key=lambda c: c.evidence), candidates)
    verdict = _name(judge, left, candidates)
    for rival in contested:
        if verdict.faults and verdict.faults[0] in (rival[0].family, rival[1].family):
            return _either(verdict, rival)
    return verdict


def _one_comb_one_family(
    judge: Judge, strong: list[Candidate]
) -> tuple[list[Candidate], list[tuple[Candidate, Candidate]]]:
    """
    Give a comb that lies in the windows of two families to one of them.

    That is the one whose sidebands it has; where they do not tell, the one of the likelier slip.
    The pairs in which the slip does not tell clearly either are returned as contested.
    """
    left, contested = list(strong), []
    for c in strong:
        for other in strong:
            apart = abs(other.order - c.order)
            if other.z < c.z or other is c or apart >= 2.0 * judge.spectra.step:
                continue
            if c not in left or other not in left:
                continue
            side = judge.sidedness(other, c)
            loser = other if side is c else c
            left.remove(loser)
            # Sidebands alone do not make up for twice the slip that costs one standard deviation.
            unlikely = abs(c.slip) - abs(other.slip) > 2.0 * SLIP_COST
            if (unlikely and side is c) or (side is None and c.z * RIVAL > other.z):
                contested.append((other, c))
    return left, contested


def _either(verdict: Verdict, pair: tuple[Candidate, Candidate]) -> Verdict:
    """Verdict on a comb that two families claim with about the same right."""
    one, other = pair
    text = (
        f'{one.family} with a slip of {one.slip:.1%} and {other.family} with {other.slip:.1%} '
        f'coincide at {one.order:.3f} orders, and sidebands do not tell them apart: an exact '
        'shaft speed may part them'
    )
    families = (one.family, other.family)
    return replace(
        verdict,
        result='ambiguous',
        faults=families,
        reasons=(str(one), str(other), text),
        strongest=one,
    )


def _without_gated(
    judge: Judge, strong: list[Candidate], candidates: dict[str, Candidate]
) -> tuple[list[Candidate], Verdict | None]:
    """Drop combs that are the inner race's, gated by the load zone; a verdict if none leads."""
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
            return strong, Verdict(
                'ambiguous', level, ('inner', gated.family),
                (str(gated), str(inner), text), candidates, gated,
            )  # fmt: skip
    return strong, None


def _nothing_strong(judge: Judge, candidates: dict[str, Candidate]) -> Verdict:
    """Healthy, or a fault that hides behind the shaft's harmonics."""
    hidden = [c for c in map(judge.hidden, PLACES[:3]) if c is not None]
    if hidden:
        text = (
            f'{hidden[0].family} order {hidden[0].order:.3f} and shaft order '
            f'{round(hidden[0].order)} coincide within the resolution of this window: the lines '
            'there belong to either; a longer window or an exact speed may part them'
        )
        return Verdict(
            'ambiguous', 'suspect', tuple(c.family for c in hidden),
            (str(hidden[0]), text), candidates,
        )  # fmt: skip
    text = f'no fault comb above z {Z_FAULT:g} with modulation index {INDEX_SUSPECT:g}'
    return Verdict('healthy', 'ok', (), (text,), candidates)


def _name(judge: Judge, strong: list[Candidate], candidates: dict[str, Candidate]) -> Verdict:
    """Name the fault that explains most, and what it leaves unexplained."""
    primary = max(strong, key=lambda c: c.evidence)
    rest = {c.family: judge.without(c) for c in strong} if len(strong) > 1 else {}

    def explains(cause: Candidate, c: Candidate) -> bool:
        return judge.best(c.family, rest[cause.family]).z < Z_FAULT

    causes = [
        c for c in strong if c is not primary and explains(c, primary) and not explains(primary, c)
    ]
    if causes:
        cause = max(causes, key=lambda c: c.z)
        if cause.z > primary.z:
            primary = cause
        elif min(cause.index, primary.index) >= INDEX_FAULT:
            return _same_lines((primary, cause), candidates)
    rivals = [
        c
        for c in strong
        if c is not primary
        and min(c.index, primary.index) >= INDEX_FAULT
        and (c.evidence * RIVAL > primary.evidence or primary.sidebands > BLURRED)
        and explains(primary, c)
        and explains(c, primary)
    ]
    if rivals:
        return _same_lines((primary, *rivals), candidates)
    verdict = _another_cause(judge, primary, candidates)
    if verdict is not None:
        return verdict
    found: list[Candidate] = [primary]
    weak: list[Candidate] = []
    for other in strong:
        if other is not primary:
            again = judge.best(other.family, rest[primary.family], judge.joint_slips(primary))
            if (
                again.z >= Z_FAULT
                and again.teeth >= 2
                and not (judge.carried(again) or judge.struck(again) or judge.turned(again))
                and not judge.foreign(again)
            ):
                certain = again.index >= INDEX_FAULT and judge.steady
                (found if certain else weak).append(again)
    sure = [c for c in found if c.index >= INDEX_FAULT]
    doubtful = [c for c in weak if c.index >= INDEX_FAULT]
    faults = tuple(c.family for c in sure)
    reasons = [str(c) for c in (*found, *weak)]
    candidates |= {c.family: c for c in (*found, *weak)}
    if faults and doubtful:
        reasons.append(
            'the shaft speed is not known well enough to name a second fault beside the first: '
            'its lines may be sidebands; give a measured speed'
        )
        if max(c.z for c in doubtful) * RIVAL > primary.z:
            either = (primary.family, *(c.family for c in doubtful))
            return Verdict('ambiguous', 'fault', either, tuple(reasons), candidates, primary)
    if not faults:
        reasons.append(f'modulation index below {INDEX_FAULT:g}: not an alarm')
        suspects = tuple(c.family for c in (*found, *weak))
        return Verdict('suspect', 'suspect', suspects, tuple(reasons), candidates, primary)
    return Verdict(faults[0], 'fault', faults, tuple(reasons), candidates, primary)


def _not_its_own(judge: Judge, primary: Candidate, candidates: dict[str, Candidate]) -> Verdict:
    """Verdict on a comb that only shares its teeth with something else."""
    verdict = _another_cause(judge, primary, candidates)
    if verdict is not None:
        return verdict
    if judge.shafts_own(primary):
        text = (
            f'it coincides with {round(primary.order)} turns of the shaft within the resolution, '
            'and the other multiples of the shaft stand as high: a knock once a turn, or the '
            'fault; a longer window or an exact speed may part them'
        )
        return _doubtful(primary, text, candidates)
    text = (
        f'it shares its teeth with a comb at {judge.foreign(primary):.3f} orders, which no part '
        'of this bearing has: check geometry and speed; a gear, a belt, another bearing or a '
        'cage that slips far?'
    )
    return _doubtful(primary, text, candidates, result='suspect')


def _another_cause(
    judge: Judge, primary: Candidate, candidates: dict[str, Candidate]
) -> Verdict | None:
    """Verdict on a comb that mains, the cage or another family may make; None if none does."""
    mains = judge.mains(primary)
    if mains:
        text = (
            f'it coincides with a multiple of {2.0 * mains:g} Hz: the pulses of rectifiers and '
            f'converters on mains of {mains:g} Hz; another shaft speed parts them'
        )
        return _doubtful(primary, text, candidates)
    cage = judge.carried(primary)
    if cage:
        text = (
            f'its sidebands are {cage:.3f} orders apart, as the cage turns, and a race does not '
            'move with the cage: a ball, or the cage'
        )
        return _doubtful(primary, text, candidates, ('ball', 'cage'))
    cage = judge.struck(primary)
    if cage:
        text = (
            f'it is one of many lines {cage:.3f} orders apart that do not fade, as a strike once '
            'a cage turn makes them: the cage, or a ball'
        )
        return _doubtful(primary, text, candidates, ('ball', 'cage'))
    if judge.turned(primary):
        text = (
            'its sidebands are one turn of the shaft apart, higher than those of the cage with '
            'which a ball moves: the inner race at a slip or a speed that was not expected, or '
            'the ball; check the shaft speed'
        )
        return _doubtful(primary, text, candidates, ('inner', 'ball'))
    return None


def _doubtful(
    primary: Candidate,
    text: str,
    candidates: dict[str, Candidate],
    families: tuple[str, ...] = (),
    *,
    result: str = 'ambiguous',
) -> Verdict:
    """Verdict without an alarm on a comb of ``families``, its own if none is given, and why."""
    return Verdict(
        result,
        'suspect',
        families or (primary.family,),
        (str(primary), text),
        candidates,
        primary,
    )


def _same_lines(claimants: Sequence[Candidate], candidates: dict[str, Candidate]) -> Verdict:
    """Verdict on faults that explain each other's lines away."""
    one, other = claimants[:2]
    text = (
        f'{one.family} at {one.order:.3f} and {other.family} at '
        f'{other.order:.3f} orders explain the same lines, one as sidebands of the other; '
        'a longer window or an exact speed may part them'
    )
    return Verdict(
        'ambiguous', 'fault', tuple(c.family for c in claimants),
        (*map(str, claimants), text), candidates, one,
    )  # fmt: skip


def _rules(cage: Candidate, others: Sequence[Candidate], step: float) -> bool:
    """
    Whether the cage is behind all that shows.

    Others are then either no faults, or weaker and on multiples of the cage's order: a strike once
    a cage turn has harmonics everywhere, the ball pass order of the outer race among them.
    """
    for other in others:
        weaker = other.z < cage.z and other.index <= cage.index
        if other.index < INDEX_FAULT:
            continue
        if not (weaker and on_comb(other.order, cage.order, step)):
            return False
    return True


def _judge_cage(
    judge: Judge, cage: Candidate, candidates: dict[str, Candidate], revolutions: float
) -> Verdict:
    """Tell a cage fault from a ball that strikes once a cage turn."""
    turns = revolutions * judge.orders.ftf
    # A strike has every harmonic, the ball pass order of the outer race exactly among them; what
    # shows the ball's order better than that is the ripple of a ball in and out of the load.
    toothless = candidates['outer'].z < max(candidates['ball'].z, Z_FAULT)
    if toothless or min(cage.index, judge.capped_index(cage)) < INDEX_STRIKE:
        text = (
            'ball and cage coincide: the envelope ripples with the cage; a ball strikes while it '
            'passes the load zone, once a cage turn, or the cage is damaged'
        )
        return _doubtful(cage, text, candidates, ('ball', 'cage'))
    if turns < CAGE_TURNS:
        text = f'{turns:.0f} cage turns: {CAGE_TURNS:g} are needed to call it a cage fault'
        return _doubtful(cage, text, candidates, result='suspect')
    return Verdict('cage', 'fault', ('cage',), (str(cage),), candidates, cage)
