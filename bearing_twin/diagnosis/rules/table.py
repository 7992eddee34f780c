# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""
Table of rules: the first rule that applies to the evidence gives the verdict.

A rule is a function of the evidence that returns a verdict, or None if it does not apply. The
rules are, by subject, in ``cage.py``, ``elsewhere.py``, ``no_comb.py`` and ``places.py``. A new
rule changes:

- one of these files: the function, and the other fields of its `Rule`;
- this file: its place in the order;
- ``evidence.py``: a property for each new quantity, with its value if nothing disturbs the
  combs, and ``harmonics.py`` or ``sidebands.py`` of ``combs`` if the quantity has to be
  measured in the spectra;
- ``thresholds.py`` and the table of thresholds in ``docs/diagnosis_why.md``;
- ``CASES`` in ``test/diagnosis/rules/test_rules.py``: evidence that reaches the rule;
- the table of rules: ``python docs/rules.py docs/diagnosis.md``;
- the share of right answers, if it changes many: ``studies.reliability``. Without it the rule has
  no weight of its own: its answers get the confidence of others of their kind.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from bearing_twin.bearing import PLACES
from bearing_twin.diagnosis.rules import cage, elsewhere, no_comb, places
from bearing_twin.diagnosis.rules.confidence import Trust
from bearing_twin.diagnosis.rules.rule import where_no_comb_remains
from bearing_twin.diagnosis.rules.verdict import highest_comb
from bearing_twin.diagnosis.thresholds import UNLIKELY_SLIP, Z_FAULT

if TYPE_CHECKING:
    from bearing_twin.diagnosis.rules.evidence import Evidence
    from bearing_twin.diagnosis.rules.rule import Rule
    from bearing_twin.diagnosis.rules.verdict import Verdict


RULES: tuple[Rule, ...] = (
    # Impacts, or a ripple, once a turn of the cage.
    cage.ball_ripple,
    cage.ball_passages,
    cage.cage_ripple,
    cage.few_cage_turns,
    cage.cage_impacts,
    cage.weak_cage,
    # The strongest comb may have been removed as a sideband.
    places.load_zone_modulated,
    *where_no_comb_remains(
        elsewhere.masked_candidate,
        elsewhere.low_bands,
        elsewhere.impacts_elsewhere,
        elsewhere.strikes_each_turn,
        no_comb.few_steps,
        no_comb.bursts,
        no_comb.mostly_damaged,
        no_comb.two_faint_places,
        no_comb.fast_impacts,
        no_comb.uncertain_health,
        no_comb.few_shaft_turns,
        no_comb.run_together,
        no_comb.low_lines,
        elsewhere.masked_faintly,
        no_comb.faint_comb,
        no_comb.no_comb,
    ),
    # One comb leads.
    places.same_lines,
    elsewhere.mains_pulses,
    places.cage_sideband_dominated,
    elsewhere.masked_by_shaft,
    places.shaft_sideband_dominated,
    elsewhere.elsewhere_explains,
    places.ball_without_cage_sidebands,
    places.slipping_race,
    elsewhere.extraneous,
    places.contested_comb,
    places.uncertain_second,
    places.both_races,
    places.weak_modulation,
    elsewhere.smooth,
    elsewhere.whole_turns,
    elsewhere.another_cage,
    places.another_shaft,
    places.fault,
)
"""All rules in their order; the last one always applies."""

DOUBTED = 35.0 / 37.0
"""Highest confidence of an answer at an unlikely slip: 34 of 35 such answers on simulated machines
were right, and this is the share that Laplace's rule of succession expects of further ones."""

TELLS = {rule.name: rule.tells for rule in RULES if rule.tells}
HEALTHY = frozenset(rule.name for rule in RULES if rule.answer == 'healthy')
FAINT = frozenset(rule.name for rule in RULES if rule.faint)
NOTHING_SHOWS = frozenset(rule.name for rule in RULES if rule.nothing_shows)


def decide(evidence: Evidence) -> Verdict:
    """
    Return the verdict of the first rule that applies, with the basis of its confidence.

    >>> from bearing_twin.diagnosis.rules.evidence import Evidence
    >>> from bearing_twin.diagnosis.combs.candidate import Candidate
    >>> outer = Candidate('outer', order=3.07, slip=0.01, z=9.0, index=0.8)
    >>> decide(Evidence.of(outer)).rule
    'fault'
    >>> decide(Evidence.of(outer, mains_hz=50.0)).rule
    'mains_pulses'

    """
    return with_confidence_basis(evidence, answer(evidence))


def answer(evidence: Evidence) -> Verdict:
    """
    Return the verdict of the first rule that applies, without the basis of its confidence.

    >>> from bearing_twin.diagnosis.rules.evidence import Evidence
    >>> from bearing_twin.diagnosis.combs.candidate import Candidate
    >>> slipped = answer(Evidence.of(Candidate('inner', 4.9, slip=0.03, z=9.0, index=0.8)))
    >>> slipped.result, slipped.level
    ('inner', 'suspect')

    """
    for rule in RULES:
        verdict = rule.apply(evidence)
        if verdict is not None:
            result = verdict.faults[0] if rule.answer == 'its place' else rule.answer
            verdict = verdict._replace(result=result, rule=rule.name)
            slip = _unlikely_slip(verdict)
            if not slip:
                return verdict
            text = (
                f'it needs a slip of {100.0 * slip:.1f} %: no alarm, as a bearing under load '
                'slips by less; check bearing and speed'
            )
            return verdict._replace(level='suspect', reasons=(*verdict.reasons, text))
    raise AssertionError('the last rule applies to any evidence')


def with_confidence_basis(evidence: Evidence, verdict: Verdict) -> Verdict:
    """
    Return a verdict with the basis of its confidence, which is limited at an unlikely slip.

    >>> from bearing_twin.diagnosis.rules.evidence import Evidence
    >>> from bearing_twin.diagnosis.combs.candidate import Candidate
    >>> slipped = Evidence.of(Candidate('inner', 4.9, slip=0.03, z=9.0, index=0.8))
    >>> with_confidence_basis(slipped, answer(slipped)).trust.at_most == DOUBTED
    True

    """
    rule = next(rule for rule in RULES if rule.name == verdict.rule)
    named = (verdict.candidates[place] for place in verdict.faults)
    # If two faults are named, both must be there; of several possible places, one.
    least_or_most = min if verdict.result in verdict.faults else max
    comb = least_or_most(named, key=lambda c: c.z, default=highest_comb(evidence.all_combs))
    at_most = min(rule.at_most, DOUBTED) if _unlikely_slip(verdict) else rule.at_most
    known = {'rule': rule.name, 'at_most': at_most}
    return verdict._replace(trust=Trust.on(evidence, comb, verdict.candidates, **known))


def _unlikely_slip(verdict: Verdict) -> float:
    """
    Return the slip that an answer needs if it is unlikely, else 0.

    An answer with several faults needs the largest slip of them. An answer with several possible
    places needs the smallest, except for places that explain each other's lines: they are equally
    clear, so one unlikely slip makes bearing or speed doubtful.
    """
    if verdict.result not in (*PLACES, 'ambiguous'):
        return 0.0
    # The slip of a comb that may be chance is arbitrary and does not count.
    slips = [c.slip for c in map(verdict.candidates.__getitem__, verdict.faults) if c.z >= Z_FAULT]
    one_is_enough = verdict.result == 'ambiguous' and verdict.rule != 'same_lines'
    slip = (min if one_is_enough else max)(slips, default=0.0)
    return slip if slip > UNLIKELY_SLIP else 0.0
