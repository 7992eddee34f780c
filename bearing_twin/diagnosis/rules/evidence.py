# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""
Evidence: the named quantities that the rules of the diagnosis use.

Lists of combs, each from the previous one. A rule about the leading comb uses `leading` and the
combs beside it. A rule about weak combs uses `all_combs` or `faint`.

==================  ==============================================================================
`candidates`        best comb of each place, however weak
`significant`       combs that are not chance, not too weak to report, and not of healthy parts
`unexplained`       those of `significant` that neither shaft nor extraneous series explain
`claims.kept`       those of `significant`, with one comb for orders that two places share
`load_zone.kept`    races and balls of these that are no shaft sidebands of the inner race
`remaining`         the same; `significant` if `unexplained` is empty
`nameable`          those of `remaining` that are in `unexplained`
`leading`           the comb that explains most; `same_lines` explain as much
`others`            those of `nameable` that remain combs without the lines of `leading`
==================  ==============================================================================
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import cached_property, wraps
import math
from typing import Any, TYPE_CHECKING, TypeVar

from bearing_twin.bearing import find_bearing, PLACES
from bearing_twin.diagnosis.combs.candidate import Candidate, Claims, LoadZone, RACES
from bearing_twin.diagnosis.combs.harmonics import CombHarmonics
from bearing_twin.diagnosis.combs.sidebands import CombSidebands
from bearing_twin.diagnosis.signal.gate import fastest_impacts_hz, LOWEST_RINGING_HZ
from bearing_twin.diagnosis.thresholds import (
    BLURRED,
    IMPACTS,
    INDEX_FAULT,
    INDEX_NOISE,
    INDEX_NOISE_TURNS,
    INDEX_SMOOTH,
    INDEX_SOUND,
    LOAD_ZONE,
    RIPPLE,
    RIVAL,
    SLIP_COST,
    SWAY,
    Z_ELSEWHERE,
    Z_FAULT,
    Z_SECOND_LOOK,
)
import numpy as np

if TYPE_CHECKING:
    from bearing_twin.bearing import Bearing
    from bearing_twin.diagnosis.combs.comb import OrderSpectra
    from bearing_twin.diagnosis.combs.search import CombSearch


_T = TypeVar('_T')

_UNDISTURBED: dict[str, Any] = {}
"""Values of the quantities if nothing disturbs the combs, by name."""


def _measured(*, undisturbed: Any) -> Callable[[Callable[[Evidence], _T]], cached_property[_T]]:
    """Mark a quantity as computed once, with its value if nothing disturbs the combs."""

    def mark(compute: Callable[[Evidence], _T]) -> cached_property[_T]:
        _UNDISTURBED[compute.__name__] = undisturbed
        return cached_property(compute)

    return mark


def _of_leading(
    part: str, measure: Callable[[Any, Candidate], _T], *, undisturbed: Any
) -> cached_property[_T]:
    """Return a quantity of the leading comb that one part of the search measures."""

    @wraps(measure)
    def quantity(e: Evidence) -> _T:
        return measure(getattr(e, part), e.leading)

    return _measured(undisturbed=undisturbed)(quantity)


class Evidence:
    """
    Named quantities of a window, or of the mean of several windows, each computed once.

    A quantity is computed when a rule first asks for it.

    Parameters
    ----------
    combs
        Search in the envelope spectra.
    turns
        Number of shaft turns in all windows together.
    steps
        RMS of the samples of the newest window, in steps of the converter.
    kurtosis
        Returns the kurtosis of its samples without single shocks and lines.
    low_lines
        Returns the share of the power at low multiples of the outer race that is in its lines.
    ball_passages
        Returns the significance of ball impacts in groups.
    other_shafts
        Returns speeds at which a comb is of another place and lines of a shaft show, Hz, by place.

    """

    def __init__(
        self,
        combs: CombSearch,
        turns: float,
        steps: float = math.inf,
        kurtosis: Callable[[], float] = float,
        low_lines: Callable[[], float] = float,
        ball_passages: Callable[[], float] = float,
        other_shafts: Callable[[Candidate], Mapping[str, float]] = lambda comb: {},
    ) -> None:
        self._combs = combs
        self._harmonics, self._sidebands = combs.harmonics, combs.sidebands
        self._low_lines, self._kurtosis = low_lines, kurtosis
        self._ball_passages, self._other_shafts = ball_passages, other_shafts
        self.turns = turns
        self.steps = steps

    @classmethod
    def of(cls, *candidates: Candidate, turns: float = 200.0, **quantities: Any) -> Evidence:
        """
        Return evidence with given quantities, to apply rules without a signal.

        Parameters
        ----------
        candidates
            Best combs of some places; other places have none.
        turns
            Shaft turns.
        quantities
            Other quantities, by name. Each one that is not given and does not follow from others
            has its value for undisturbed combs.

        >>> inner = Candidate('inner', order=4.93, slip=0.01, z=9.0, index=0.8)
        >>> Evidence.of(inner).leading.place
        'inner'

        """
        evidence = cls.__new__(cls)
        undisturbed = _UNDISTURBED | {
            'turns': turns,
            'steps': math.inf,
            'bearing': find_bearing('6205'),
            'cage_turns': 0.4 / quantities.get('step', _UNDISTURBED['step']),
            'claims': Claims(candidates),
        }
        unknown = quantities.keys() - undisturbed.keys()
        if unknown:
            raise TypeError(f'no such quantity: {", ".join(sorted(unknown))}')
        given = {c.place: c for c in candidates}
        nothing = {place: Candidate(place, 1.0, 0.0, 0.0, 0.0) for place in PLACES}
        vars(evidence).update(undisturbed, **quantities, candidates=nothing | given)
        return evidence

    @cached_property
    def candidates(self) -> dict[str, Candidate]:
        """Best comb of each place."""
        return {place: self._combs.best(place) for place in PLACES}

    @_measured(undisturbed=25.0)
    def shaft_hz(self) -> float:
        """Shaft speed, Hz."""
        return self._combs.shaft_hz

    @_measured(undisturbed=math.inf)
    def sample_rate(self) -> float:
        """Hz."""
        return 2.0 * self._combs.spectra.highest * self.shaft_hz

    @cached_property
    def bearing(self) -> Bearing:
        """Geometry."""
        return self._combs.expected.bearing

    @cached_property
    def cage_turns(self) -> float:
        """Cage turns in one window: averaging windows does not improve the resolution."""
        return self._combs.expected.without_slip.ftf / self.step

    @_measured(undisturbed=True)
    def speed_known(self) -> bool:
        """Whether the shaft speed is known well enough to compare slips and place sidebands."""
        return self._combs.expected.speed_known

    @_measured(undisturbed=0.005)
    def step(self) -> float:
        """Resolution, orders."""
        return self._combs.spectra.step

    @cached_property
    def significant(self) -> tuple[Candidate, ...]:
        """Combs that are neither chance, nor too weak to report, nor of healthy parts."""
        found = (c for c in self.candidates.values() if c.significant)
        combs = tuple(c for c in found if c.place not in self.healthy_modulations)
        return combs or self.on_second_look

    @_measured(undisturbed=frozenset())
    def healthy_modulations(self) -> frozenset[str]:
        """Places whose comb is a smooth modulation by healthy parts and noise."""
        most = math.hypot(INDEX_SOUND, INDEX_NOISE * math.sqrt(INDEX_NOISE_TURNS / self.turns))
        shown = (c for c in self.candidates.values() if c.significant)
        return frozenset(c.place for c in shown if self._harmonics.is_healthy_modulation(c, most))

    @_measured(undisturbed=())
    def on_second_look(self) -> tuple[Candidate, ...]:
        """
        Combs of races and balls that are significant against a null without their own lines.

        They are used only if nothing else is significant: to rank combs they are unreliable.
        """
        strong = (
            c
            for c in self.candidates.values()
            if c.place != 'cage' and c.z >= Z_SECOND_LOOK and c.index >= INDEX_FAULT
        )
        return tuple(c for c in map(self._combs.second_look, strong) if c.significant)

    @_measured(undisturbed=0.0)
    def outer_index(self) -> float:
        """Modulation index of the outer race's comb in all bands, also low ones."""
        return self._combs.index_in_all_bands(self.candidates['outer'])

    @cached_property
    def all_combs(self) -> tuple[Candidate, ...]:
        """
        Combs of all places, each with its highest index over all bands.

        In bands below ``CARRIER`` the outer race's comb is no evidence of a fault, because the
        variable compliance of healthy bearings shows there. It is no evidence of health either,
        because a fault may ring there.
        """
        outer = self.candidates['outer']
        outer = replace(outer, index=max(outer.index, self.outer_index))
        return tuple((self.candidates | {'outer': outer}).values())

    @cached_property
    def faint(self) -> tuple[Candidate, ...]:
        """
        Combs of races and balls that are not chance and have a larger index than noise.

        The index of noise falls with the root of the time. The comb of an outer race may be in low
        bands: beside another place it is not the variable compliance alone.
        """
        noise = INDEX_NOISE * math.sqrt(min(INDEX_NOISE_TURNS / self.turns, 1.0))
        return tuple(
            c for c in self.all_combs if c.place != 'cage' and c.z >= Z_FAULT and c.index >= noise
        )

    @property
    def fast(self) -> Candidate | None:
        """
        Highest faint comb whose impacts come faster than the ringing of a housing dies away.

        Its index is small whatever the size of the impacts.
        """
        shown = fastest_impacts_hz(self.sample_rate, LOWEST_RINGING_HZ)
        combs = (c for c in self.faint if c.order * self.shaft_hz > shown)
        return max(combs, key=lambda c: c.z, default=None)

    @_measured(undisturbed=(0.0, 0.0))
    def fast_harmonics(self) -> tuple[float, float]:
        """Height of the second, and of the third and fourth harmonic of `fast`, as `impacts`."""
        if self.fast is None:
            return 0.0, 0.0
        heights = self._harmonics.impacts
        return heights(self.fast, 2, 2), heights(self.fast, 3)

    @_measured(undisturbed={})
    def extraneous_orders(self) -> Mapping[str, float]:
        """Order of the extraneous series that shares lines with the comb of a place."""
        orders = {c.place: self._harmonics.extraneous_order(c) for c in self.significant}
        return {place: order for place, order in orders.items() if order}

    @_measured(undisturbed=frozenset())
    def masked_by_shaft(self) -> frozenset[str]:
        """Places whose comb may be a multiple of the shaft, no higher than other multiples."""
        return frozenset(c.place for c in self.significant if self._harmonics.masked_by_shaft(c))

    @cached_property
    def unexplained(self) -> tuple[Candidate, ...]:
        """Significant combs that nothing else of the machine explains."""
        return tuple(
            c
            for c in self.significant
            if c.place not in self.extraneous_orders and c.place not in self.masked_by_shaft
        )

    @cached_property
    def claims(self) -> Claims:
        """
        Combs, after each comb in the ranges of two places has been assigned to one of them.

        It is the place that the sidebands fit; if they fit neither, the place of the likelier
        slip.
        """
        left, contested = list(self.significant), []
        for c in self.significant:
            for other in self.significant:
                apart = abs(other.order - c.order)
                if other.z < c.z or other is c or apart >= 2.0 * self.step:
                    continue
                if c not in left or other not in left:
                    continue
                owner = self._sidebands.sideband_owner(other, c)
                left.remove(other if owner is c else c)
                # Sidebands alone do not outweigh twice the slip that costs one standard deviation.
                unlikely = abs(c.slip) - abs(other.slip) > 2.0 * SLIP_COST
                if (unlikely and owner is c) or (owner is None and c.z * RIVAL > other.z):
                    contested.append((other, c))
        return Claims(tuple(left), tuple(contested))

    @cached_property
    def _races_and_balls(self) -> tuple[Candidate, ...]:
        return tuple(c for c in self.claims.kept if c.place != 'cage')

    @cached_property
    def cage_leads(self) -> bool:
        """
        Whether the cage explains all combs.

        Every other comb is then weak, or weaker than the cage's comb and on its harmonics. An
        impact once a cage turn has all harmonics; one is at the outer race's order.
        """
        cage = self.candidates['cage']
        return (
            cage in self.unexplained
            and cage.index >= INDEX_FAULT
            and all(
                other.index < INDEX_FAULT
                or (
                    other.z < cage.z
                    and other.index <= cage.index
                    and _on_harmonics(other.order, cage.order, self.step)
                )
                for other in self._races_and_balls
            )
        )

    @cached_property
    def ball_or_cage(self) -> tuple[str, str]:
        """
        Ball and cage, the likelier place first, for an envelope that follows the cage.

        A ball in and out of the load makes a ripple as wide as the load zone. A cage strikes more
        briefly.
        """
        return ('ball', 'cage') if self.cage_high_harmonics < RIPPLE else ('cage', 'ball')

    @_measured(undisturbed=0.0)
    def cage_high_harmonics(self) -> float:
        """Power of the fifth to eighth harmonic of the cage's comb over that of the first four."""
        return self._harmonics.high_harmonics_ratio(self.candidates['cage'])

    @_measured(undisturbed={})
    def shaft_sideband_ratios(self) -> Mapping[str, float]:
        """Mean amplitude of the shaft sidebands of each comb over that of its harmonics."""
        return {c.place: self._sidebands.shaft_sideband_ratio(c) for c in self._races_and_balls}

    @_measured(undisturbed={})
    def inner_race_ratios(self) -> Mapping[str, float]:
        """Amplitude of the inner race's comb over that of each comb that may be its sideband."""
        return {
            c.place: ratio
            for c in self._races_and_balls
            if c.place != 'inner'
            and self.shaft_sideband_ratios[c.place] > LOAD_ZONE
            and (ratio := self._sidebands.inner_race_ratio(c)) * RIVAL > 1.0
        }

    @cached_property
    def load_zone(self) -> LoadZone:
        """Combs without those that are shaft sidebands of the inner race."""
        left = list(self._races_and_balls)
        for c in self._races_and_balls:
            ratio = self.inner_race_ratios.get(c.place)
            if ratio is None:
                continue
            leads = all(other.weight <= c.weight for other in left)
            left.remove(c)
            if leads and (ratio < BLURRED or all(other.place != 'inner' for other in left)):
                return LoadZone(tuple(left), c)
        return LoadZone(tuple(left))

    @cached_property
    def remaining(self) -> tuple[Candidate, ...]:
        """Combs of races and balls that are left; `significant` if `unexplained` is empty."""
        return self.load_zone.kept if self.unexplained else self.significant

    @cached_property
    def nameable(self) -> tuple[Candidate, ...]:
        """Remaining combs that nothing else of the machine explains."""
        return tuple(c for c in self.remaining if c in self.unexplained)

    @_measured(undisturbed=())
    def masked_candidates(self) -> tuple[Candidate, ...]:
        """
        Significant combs of races and balls that coincide with harmonics of the shaft.

        The highest one is first. Clearly lower ones are left out: multiples of the shaft have
        common multiples, so they share lines of the highest.
        """
        found = (c for c in self.masked_combs if c.index >= INDEX_FAULT)
        highest, *others = sorted(found, key=lambda c: -c.z) or (None,)
        if highest is None:
            return ()
        return (highest, *(c for c in others if c.z * RIVAL > highest.z))

    @_measured(undisturbed=())
    def masked_combs(self) -> tuple[Candidate, ...]:
        """Combs as `masked_candidates`, also those that modulate too little for an alarm."""
        return tuple(filter(None, map(self._combs.masked_candidate, PLACES[:3])))

    @cached_property
    def leading(self) -> Candidate:
        """Comb that explains most; if none can be named, the strongest."""
        return self._leading_and_rivals[0]

    @cached_property
    def same_lines(self) -> tuple[Candidate, ...]:
        """Combs that explain the lines of the leading comb as well as it explains theirs."""
        return self._leading_and_rivals[1]

    @cached_property
    def _leading_and_rivals(self) -> tuple[Candidate, tuple[Candidate, ...]]:
        leading = max(self.nameable or self.remaining, key=lambda c: c.weight)
        if not self.nameable:
            return leading, ()
        causes = [
            c
            for c in self.nameable
            if c is not leading and self.explains(c, leading) and not self.explains(leading, c)
        ]
        if causes:
            cause = max(causes, key=lambda c: c.z)
            if cause.z > leading.z:
                leading = cause
            elif min(cause.index, leading.index) >= INDEX_FAULT:
                return leading, (cause,)
        rivals = (
            c
            for c in self.nameable
            if c is not leading
            and min(c.index, leading.index) >= INDEX_FAULT
            and (c.weight * RIVAL > leading.weight or leading.shaft_sideband_ratio > BLURRED)
            and self.explains(leading, c)
            and self.explains(c, leading)
        )
        return leading, tuple(rivals)

    def explains(self, cause: Candidate, other: Candidate) -> bool:
        """Return whether a comb is not significant without the lines of another fault."""
        return (cause.place, other.place) in self.explained

    @_measured(undisturbed=frozenset())
    def explained(self) -> frozenset[tuple[str, str]]:
        """Pairs of places (cause, other): the lines of the cause explain the other comb."""
        return frozenset(
            (place, other.place)
            for place, rest in self._rests.items()
            for other in self.nameable
            if other.place != place and self._combs.best(other.place, rest).z < Z_FAULT
        )

    @cached_property
    def _rests(self) -> dict[str, OrderSpectra]:
        """Spectra without the lines that each place explains, if several places can be named."""
        if len(self.nameable) < 2:
            return {}
        return {cause.place: self._combs.without(cause) for cause in self.nameable}

    mains_hz = _of_leading('_harmonics', CombHarmonics.mains_hz, undisturbed=0.0)
    cage_sideband_order = _of_leading(
        '_sidebands', CombSidebands.cage_sideband_order, undisturbed=0.0
    )
    passing_balls_ratio = _of_leading(
        '_sidebands', CombSidebands.passing_balls_ratio, undisturbed=0.0
    )
    another_cage_order = _of_leading(
        '_sidebands', CombSidebands.another_cage_order, undisturbed=0.0
    )
    shaft_sidebands_dominate = _of_leading(
        '_sidebands', CombSidebands.shaft_sidebands_dominate, undisturbed=False
    )

    @_measured(undisturbed=0.4)
    def cage_sideband_ratio(self) -> float:
        """Ratio of the cage sidebands to the harmonics of the leading comb, if it is a ball's."""
        return self._sidebands.cage_sideband(self.leading)[1]

    @_measured(undisturbed=0.3)
    def turning_sideband_ratio(self) -> float:
        """
        Ratio of the sidebands near the shaft order to the harmonics of the leading comb.

        The range allows for a wrong given speed.
        """
        return self._sidebands.turning_sideband(self.leading)[1]

    @_measured(undisturbed=Candidate('elsewhere', 1.5, 0.0, 0.0, 0.0))
    def elsewhere(self) -> Candidate:
        """Best comb at any order off the multiples of the shaft."""
        return self._combs.strongest_anywhere(beyond=not self.remaining)

    @_measured(undisturbed=None)
    def impacts_each_turn(self) -> Candidate | None:
        """Comb of impacts in time with the shaft, with an index above any load's, or None."""
        comb = self._combs.deepest_whole()
        if comb is None or comb.index <= INDEX_SMOOTH:
            return None
        return None if self._harmonics.smooth(comb, masked=True) else comb

    @_measured(undisturbed=False)
    def elsewhere_has_shaft_sidebands(self) -> bool:
        """Whether the comb `elsewhere` has shaft sidebands, as a rotating part has."""
        return self._sidebands.shaft_sideband_ratio(self.elsewhere) >= SWAY

    @_measured(undisturbed={'elsewhere': 2.0})
    def impacts(self) -> Mapping[str, float]:
        """
        Height over noise of the second to fourth harmonic of each comb, as mean log score.

        Healthy parts modulate the noise smoothly, by 1 + a cos: the second harmonic has a/4 of the
        height of the first, and there are no others. Impacts have all harmonics, however faint.
        """
        combs = (*self.candidates.values(), self.elsewhere)
        return {c.place: self._harmonics.impacts(c) for c in combs}

    @property
    def strikes_elsewhere(self) -> bool:
        """Whether the comb `elsewhere` is of strong impacts."""
        comb = self.elsewhere
        strong = comb.z >= Z_ELSEWHERE and comb.index >= INDEX_FAULT
        return strong and self.impacts['elsewhere'] >= IMPACTS

    @_measured(undisturbed=3.0)
    def kurtosis(self) -> float:
        """Kurtosis of the samples without single shocks and lines."""
        return self._kurtosis()

    @_measured(undisturbed=0.0)
    def ball_passages(self) -> float:
        """Significance of ball impacts in groups in the newest window."""
        return self._ball_passages()

    @_measured(undisturbed=0.0)
    def low_lines(self) -> float:
        """Share of the power at low multiples of the outer race that is in its lines."""
        return self._low_lines()

    @_measured(undisturbed={})
    def other_shafts(self) -> Mapping[str, float]:
        """Speeds at which the leading comb is of another place and a shaft shows, Hz."""
        return self._other_shafts(self.leading)

    @_measured(undisturbed=frozenset())
    def fits_shaft(self) -> frozenset[str]:
        """
        Places whose comb strikes of the shaft explain at least as well.

        Its shaft sidebands are as high, as of strikes once a turn, or it smears over a whole
        order, as of several strikes a turn, or lies as near to it with lines at all multiples of
        the shaft, as of several that are not equal.
        """
        high, smears = self._sidebands.has_high_shaft_sidebands, self._harmonics.smears_over_whole
        unequal = self._harmonics.unequal_strikes
        found = (c for c in self._races_and_balls if high(c) or smears(c) or unequal(c))
        return frozenset(c.place for c in found if self._harmonics.whole_turns(c))

    smooth = _of_leading('_harmonics', CombHarmonics.smooth, undisturbed=False)
    half_turn = _of_leading('_harmonics', CombHarmonics.half_turn, undisturbed=False)
    whole_turns = _of_leading('_harmonics', CombHarmonics.whole_turns, undisturbed=0)

    @_measured(undisturbed=False)
    def elsewhere_explains(self) -> bool:
        """Whether a more significant comb at another order explains the leading one."""
        comb, leading = self.elsewhere, self.leading
        # The outer race's comb in bands of the variable compliance belongs to the bearing.
        if abs(comb.order - self.candidates['outer'].order) <= 2.0 * self.step:
            return False
        ratio = leading.order / comb.order
        multiple = max(round(ratio), 1)
        shares_lines = abs(ratio / multiple - 1.0) <= SLIP_COST
        # A ball that strikes one race only has its highest lines at the spin.
        if shares_lines and (multiple == 1 or (multiple, leading.place) == (2, 'ball')):
            return False
        if comb.index < INDEX_FAULT or comb.z <= leading.z:
            return False
        # A lower comb one order beside the leading one may consist of its shaft sidebands.
        sideband = (
            comb.index < leading.index and self._combs.score_without(leading, comb.order) < Z_FAULT
        )
        if (shares_lines or sideband) and comb.z <= RIVAL * leading.z:
            return False
        return self._combs.left_without(comb, leading) < Z_FAULT

    @_measured(undisturbed=None)
    def other_race(self) -> Candidate | None:
        """
        Comb of the other race, if the leading comb is a race's and one cage fits both.

        With n balls and f cage turns per shaft turn, n f balls pass a point of the outer race and
        n (1 - f) a point of the inner race: the two orders add up to n at any slip and contact
        angle.
        """
        if self.leading.place not in RACES:
            return None
        [other] = (self.candidates[place] for place in RACES if place != self.leading.place)
        order = self.bearing.n_balls - self.leading.order
        # The ratio of both orders is nearly 2 to 3: a race has lines at multiples of the other's.
        near = order + self.step * np.linspace(-1.0, 1.0, 5)
        score = self._combs.score_without(self.leading, *near)
        return replace(other, order=order) if score >= Z_SECOND_LOOK else None

    @_measured(undisturbed=())
    def others(self) -> tuple[Candidate, ...]:
        """Combs of other faults in the spectra without the lines of the leading comb."""
        combs, leading = self._combs, self.leading
        rest, slips = self._rests.get(leading.place), combs.expected.joint_slips(leading)
        again = (combs.best(c.place, rest, slips) for c in self.nameable if c is not leading)
        return tuple(
            c
            for c in again
            if c.z >= Z_FAULT
            and c.harmonics >= 2
            and not self._sidebands.cage_sideband_order(c)
            and not self._sidebands.another_cage_order(c)
            and not self._sidebands.shaft_sidebands_dominate(c)
            and not self._harmonics.extraneous_order(c)
        )

    @cached_property
    def certain_faults(self) -> tuple[Candidate, ...]:
        """Other combs that are separate faults."""
        return tuple(c for c in self.others if c.index >= INDEX_FAULT and self.speed_known)

    @cached_property
    def uncertain_faults(self) -> tuple[Candidate, ...]:
        """Other combs that would be faults if the speed were known exactly."""
        return tuple(c for c in self.others if c.index >= INDEX_FAULT and not self.speed_known)

    @property
    def alarms(self) -> tuple[Candidate, ...]:
        """Return the leading comb and other faults, where they are strong enough for an alarm."""
        return tuple(c for c in (self.leading, *self.certain_faults) if c.index >= INDEX_FAULT)

    @cached_property
    def leading_first(self) -> tuple[Candidate, ...]:
        """Return the leading comb, then the certain other faults, then the uncertain ones."""
        unsure = (c for c in self.others if c not in self.certain_faults)
        return (self.leading, *self.certain_faults, *unsure)

    @property
    def separated(self) -> dict[str, Candidate]:
        """Candidates; other faults are measured without the lines of the leading comb."""
        return self.candidates | {c.place: c for c in self.leading_first}


def _on_harmonics(order: float, cage_order: float, step: float) -> bool:
    """Return whether every second harmonic of a comb, or all, lie on multiples of the cage."""
    multiple = round(2.0 * order / cage_order)
    away = abs(2.0 * order - multiple * cage_order)
    return away <= (4.0 + 0.25 * multiple) * step
