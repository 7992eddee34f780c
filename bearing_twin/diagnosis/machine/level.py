# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Level of a diagnosis from combs, baseline of the machine and ISO zone; stage of a fault."""

from __future__ import annotations

from dataclasses import replace
import math
from typing import Any, TYPE_CHECKING

from bearing_twin.bearing import LEVELS
from bearing_twin.diagnosis.machine.dependence import Z90
from bearing_twin.diagnosis.signal.acceleration import acceleration_factor, GRAVITY
from bearing_twin.diagnosis.signal.severity import ZONE_C_OF_ALL, ZONE_D_OF_ALL

if TYPE_CHECKING:
    from bearing_twin.diagnosis.result import Diagnosis
    from bearing_twin.diagnosis.signal.severity import Severity


SUSPECT_DB, FAULT_DB = 6.0, 12.0
"""Vibration over the baseline from which a machine is suspect, and from which it has a fault, dB:
twice and four times the acceleration."""

FALLEN = (
    'does the machine stand still, is the sensor loose or dead? After a repair start a new '
    'baseline'
)
"""Question to the user about a vibration ``FAULT_DB`` below the baseline."""

LOUDEST = 10.0 * GRAVITY
"""Acceleration RMS from 10 Hz to 20 kHz above which a machine is suspect, m/s^2: 24 dB, twice
``FAULT_DB``, above the loudest sound records known here, those of FEMTO."""

UNRATED_CONFIDENCE = 0.5
"""Confidence of an answer from the level alone: no simulation tells how often it is right."""

_NOT_JUDGED = (
    'not judged: wear without impacts, which raises the level only; it takes a zone (unit, power '
    'group and mounting) or a baseline'
)

_DEEP = 1.0
"""Modulation index from which the envelope is fully modulated."""


def is_urgent(level: str, velocity_rms: float, stage: int = 0) -> bool:
    """
    Return whether the cause of a vibration must be found now, whichever part it is.

    A fault of stage 1 or 2 is not urgent: its cause is known, because combs of the bearing raised
    the level and neither the baseline nor a zone did.

    An unknown velocity, mm/s, is NaN; an unknown stage is 0.

    Examples
    --------
    >>> is_urgent('fault', float('nan')), is_urgent('suspect', 56.0), is_urgent('suspect', 2.0)
    (True, True, False)
    >>> is_urgent('fault', 2.0, 2), is_urgent('fault', 2.0, 4), is_urgent('fault', 56.0, 2)
    (False, True, True)

    """
    return (level == 'fault' and stage not in (1, 2)) or velocity_rms > ZONE_D_OF_ALL


def with_required_level(diagnosis: Diagnosis) -> Diagnosis:
    """
    Return a diagnosis with its level raised to the one of the vibration severity, and the reason.

    The level is at least suspect in zone C of ISO 20816-3, above :data:`LOUDEST`, at twice the
    baseline of the machine, and after a lasting rise
    (:class:`bearing_twin.diagnosis.machine.onset.Rise`). It is a fault in zone D and at four times
    the baseline; without a comb its place is unknown. *Ball or cage* is a fault from twice the
    baseline: the vibration agrees with the comb. A *healthy* answer without zone and baseline says
    what it does not cover.

    >>> from bearing_twin.bearing import find_bearing
    >>> from bearing_twin.diagnosis.result import insufficient
    >>> verdict = insufficient(['too short'], find_bearing('6307'))
    >>> worn = replace(verdict, severity=replace(verdict.severity, iso_zone='D'))
    >>> raised = with_required_level(worn)
    >>> raised.level, raised.result, raised.reasons[-1]
    ('fault', 'ambiguous', 'zone D of ISO 20816-3 is a fault; place unknown')

    """
    level, why = _asked_for(diagnosis)
    if LEVELS.index(level) <= LEVELS.index(diagnosis.level):
        severity = diagnosis.severity
        unknown = math.isnan(severity.level_over_baseline) and not severity.iso_zone
        if diagnosis.result == 'healthy' and unknown:
            return replace(diagnosis, reasons=(*diagnosis.reasons, _NOT_JUDGED))
        return diagnosis
    place = '' if diagnosis.faults else '; place unknown'
    meaning = 'a fault' if level == 'fault' else 'suspect'
    if diagnosis.result in ('healthy', 'insufficient'):
        diagnosis = unrated(diagnosis, result='suspect')
    result = diagnosis.result
    if result == 'suspect' and level == 'fault':
        result = 'ambiguous'
    reasons = *diagnosis.reasons, f'{why} is {meaning}{place}'
    return replace(diagnosis, result=result, level=level, reasons=reasons)


def unrated(diagnosis: Diagnosis, **changes: Any) -> Diagnosis:
    """
    Return another answer about the same window, with the confidence of one that no study rates.

    >>> from bearing_twin.bearing import find_bearing
    >>> from bearing_twin.diagnosis.result import insufficient
    >>> verdict = insufficient(['too short'], find_bearing('6307'))
    >>> unrated(verdict, result='suspect').confidence
    0.5

    """
    return replace(diagnosis, confidence=UNRATED_CONFIDENCE, kind='', **changes)


def with_fault_stage(diagnosis: Diagnosis) -> Diagnosis:
    """
    Return a diagnosis with the stage of its fault, 0 if its level is not *fault*.

    1: the envelope is not fully modulated; 2: it is; 3: the vibration is twice (6 dB) the baseline
    of the machine, or in zone C; 4: it is four times the baseline, or in zone D. Without baseline
    and zone the stage is at most 2.

    >>> from bearing_twin.bearing import find_bearing
    >>> from bearing_twin.diagnosis.result import insufficient
    >>> verdict = replace(insufficient(['too short'], find_bearing('6307')), level='fault')
    >>> worn = replace(verdict, severity=replace(verdict.severity, level_over_baseline=13.0))
    >>> with_fault_stage(verdict).severity.stage, with_fault_stage(worn).severity.stage
    (1, 4)

    """
    severity, stage = diagnosis.severity, 0
    over, zone = severity.level_over_baseline, severity.iso_zone
    if diagnosis.level == 'fault':
        place = diagnosis.faults[0] if diagnosis.faults else ''
        stage = 2 if diagnosis.modulation_index.get(place, 0.0) >= _DEEP else 1
        if over >= FAULT_DB or zone == 'D':
            stage = 4
        elif over >= SUSPECT_DB or zone == 'C':
            stage = 3
    if stage == severity.stage:
        return diagnosis
    return replace(diagnosis, severity=replace(severity, stage=stage))


def _asked_for(diagnosis: Diagnosis) -> tuple[str, str]:
    """Return the level that the severity requires, and the reason."""
    severity: Severity = diagnosis.severity
    # The uncertainty of the correction for temperature must not raise an alarm.
    sure = severity.level_over_baseline - Z90 * severity.correction_sd
    over = f'a level {sure:.1f} dB over the baseline'
    agrees = {'ball', 'cage'} <= set(diagnosis.faults)
    zone = by_zone(severity)
    if zone[0] == 'fault':
        return zone
    if sure >= (SUSPECT_DB if agrees else FAULT_DB):
        return 'fault', over
    loud = acceleration_factor(severity.unit) * math.hypot(*severity.band_rms)
    if loud > LOUDEST:
        return 'suspect', (
            f'an acceleration of {loud:.3g} m/s^2 RMS, above {LOUDEST / GRAVITY:g} g (are unit '
            'and scale right? if so, lubrication, worn races, a rub or gears that are so loud),'
        )
    if zone[0] == 'suspect':
        return zone
    if sure >= SUSPECT_DB:
        return 'suspect', over
    if severity.rising:
        return 'suspect', f'a level that has been rising for {severity.rising} minutes'
    return 'none', ''


def by_zone(severity: Severity) -> tuple[str, str]:
    """
    Return the level that the velocity RMS requires, and the reason; 'none' if it requires none.

    If neither power group nor mounting is known, a velocity in zone C or D of all of them is
    suspect and no alarm: the standard may not apply to the machine.

    >>> from bearing_twin.bearing import find_bearing
    >>> from bearing_twin.diagnosis.result import insufficient
    >>> severity = insufficient(['too short'], find_bearing('6307')).severity
    >>> by_zone(replace(severity, iso_zone='C'))
    ('suspect', 'zone C of ISO 20816-3')
    >>> by_zone(replace(severity, velocity_rms=8.0))[0], by_zone(severity)[0]
    ('suspect', 'none')

    """
    zone = severity.iso_zone
    if zone in ('C', 'D'):
        return ('suspect' if zone == 'C' else 'fault'), f'zone {zone} of ISO 20816-3'
    if not zone and severity.velocity_rms > ZONE_C_OF_ALL:
        worst = 'D' if severity.velocity_rms > ZONE_D_OF_ALL else 'C or D'
        return 'suspect', (
            f'a velocity of {severity.velocity_rms:.3g} mm/s, zone {worst} in each group of '
            'ISO 20816-3 (power_group and mounting tell which),'
        )
    return 'none', ''
