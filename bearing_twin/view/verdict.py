# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Verdicts in words, and the headline verdict of a recording."""

from __future__ import annotations

from dataclasses import dataclass, field
import math
from typing import Any

from bearing_twin.bearing.geometry import FaultFrequencies
from bearing_twin.bearing.vocabulary import next_step as next_step_of
from bearing_twin.bearing.vocabulary import PLACES, RESULTS, STAGES, TITLES
from bearing_twin.diagnosis.machine.dependence import Z90
from bearing_twin.diagnosis.machine.level import is_urgent, SUSPECT_DB, UNRATED_CONFIDENCE
from bearing_twin.diagnosis.rules.confidence import CLAIMS, kind_of
from bearing_twin.diagnosis.rules.table import HEALTHY, TELLS
from bearing_twin.diagnosis.signal.acceleration import acceleration_factor
from bearing_twin.diagnosis.signal.severity import SLOW_HZ
from bearing_twin.diagnosis.thresholds import INDEX_FAULT, INDEX_SUSPECT, RIVAL, Z_CAGE, Z_FAULT
from bearing_twin.quantity import signed
from bearing_twin.recording.topics import LEVEL_FAULT, LEVEL_NONE, LEVEL_OK, LEVEL_SUSPECT
from bearing_twin.stamps import stamp_ns, time_unit
from bearing_twin.view.trends import element

LOUDER = (
    'find the cause of the high vibration: balance, alignment, looseness, lubrication, bearing; '
    'measure more often'
)
"""Next step where the level has risen, or is in zone C, and the answer is *suspect*."""
SUSTAINED = 3
"""Number of consecutive windows after which a verdict is sustained."""
RANKS = {LEVEL_NONE: 0, LEVEL_OK: 1, LEVEL_SUSPECT: 2, LEVEL_FAULT: 3}
CLOSE = 0.02
"""Relative distance within which a line may be a sideband: the range of slip."""


def title_of(diagnosis: Any) -> str:
    """Return the heading of a verdict: its result and the places that it names."""
    result = str(diagnosis.result_name)
    title = TITLES.get(result, result)
    places = [name_of(place) for place in diagnosis.faults if place in PLACES]
    if result in PLACES and len(places) > 1:
        return f'{" and ".join(places)} fault'.capitalize()
    if result in ('suspect', 'ambiguous') and places:
        return f'{title}: {" or ".join(places)}'
    if result == 'ambiguous' and diagnosis.level == LEVEL_FAULT:
        # Only the vibration level shows the fault, as with a worn-out bearing.
        return f'{title}: fault, place unknown'
    return title


def name_of(place: str) -> str:
    """Return the name of a place within a sentence."""
    return TITLES[place].removesuffix(' fault').lower()


def pretty(unit: str) -> str:
    """Return a unit as it is printed; 'unit unknown' for an empty one."""
    return str(unit).replace('^2', '²') or 'unit unknown'


def number(value: float, unit: str = '') -> str:
    """Return a value with its unit; never 'nan'."""
    if not math.isfinite(value):
        return 'not known'
    digits = '.3g' if abs(value) < 100.0 else '.0f' if abs(value) < 1e6 else '.4g'
    return f'{value:{digits}} {unit}'.strip()


def impacts(message: Any, place: str) -> float:
    """Return the impact frequency of a defect, Hz, from a message with the four frequencies."""
    frequencies = FaultFrequencies(message.bpfo, message.bpfi, message.bsf, message.ftf)
    return float(frequencies.impacts(place))


def shaft_speed(diagnosis: Any) -> str:
    """Return the shaft speed in words: a shaft at 0 Hz is standing."""
    for hertz in (diagnosis.shaft_hz, diagnosis.shaft_hz_given):
        if hertz == 0.0:
            return 'standing'
        if math.isfinite(hertz):
            return f'{hertz:.2f} Hz ({60.0 * hertz:.0f} rpm)'
    return 'not known'


def judged_by_velocity(diagnosis: Any) -> bool:
    """Whether a verdict depends on its velocity: by a zone, or urgently by zone D of all."""
    return bool(diagnosis.iso_zone) or is_urgent('', diagnosis.velocity_rms)


def next_step(diagnosis: Any) -> str:
    """Return the recommended action for a verdict."""
    result = str(diagnosis.result_name)
    # If a place is named, its combs alone may have raised the level; the stage has the rest.
    level = 'fault' if diagnosis.level == LEVEL_FAULT and result not in PLACES else ''
    rule = str(diagnosis.rule)
    # A lasting rise raises a healthy answer too.
    by_level = _is_louder(diagnosis) or (rule in HEALTHY and result != 'healthy')
    step = next_step_of(
        result,
        _stage(diagnosis),
        urgent=is_urgent(level, diagnosis.velocity_rms, _stage(diagnosis)),
        standing=shaft_speed(diagnosis) == 'standing',
        tells=(LOUDER if result == 'suspect' else '') if by_level else TELLS.get(rule, ''),
    )
    return f'{step[0].upper()}{step[1:]}.'


def _is_louder(diagnosis: Any) -> bool:
    """Whether the level has doubled or is in zone C or D: then more is asked than the cause."""
    return diagnosis.level_over_baseline >= SUSPECT_DB or diagnosis.iso_zone in ('C', 'D')


def _stage(diagnosis: Any) -> int:
    """Return the stage of a verdict; 0 if it has none or an invalid one."""
    return int(diagnosis.stage) if diagnosis.stage in range(len(STAGES)) else 0


def confidence(diagnosis: Any) -> tuple[str, str]:
    """Return the confidence of a verdict and its claim; both '' if it makes no statement."""
    sure, faults = float(diagnosis.confidence), tuple(diagnosis.faults)
    level = 'suspect' if diagnosis.level == LEVEL_SUSPECT else ''
    rule = str(diagnosis.rule)
    kind = kind_of(str(diagnosis.result_name), level, faults, rule)
    if not sure > 0.0 or kind not in CLAIMS:
        return '', ''
    # 100 % is never printed: nothing is certain.
    share = '> 99 %' if sure > 0.99 else f'{100.0 * sure:.0f} %'
    if sure == UNRATED_CONFIDENCE and not faults and kind != 'healthy':
        return share, '(not checked by simulation)'
    return share, CLAIMS[kind]


def facts(diagnosis: Any) -> list[tuple[str, str]]:
    """Return names and texts of the facts of a verdict, without those that are not known."""
    unit = pretty(diagnosis.unit)
    rows = []
    if math.isfinite(diagnosis.fault_hz) and diagnosis.fault_hz_expected > 0.0:
        off = diagnosis.fault_hz / diagnosis.fault_hz_expected - 1.0
        rows.append(
            (
                'Found',
                f'{diagnosis.fault_hz:.2f} Hz, expected {diagnosis.fault_hz_expected:.2f} Hz '
                f'({signed(100.0 * off, 2)} %)',
            )
        )
    rows.append(('Shaft', shaft_speed(diagnosis)))
    stage, (share, claim) = _stage(diagnosis), confidence(diagnosis)
    # The claim is not repeated if the heading names a place.
    named = stage and claim == CLAIMS['fault']
    if stage:
        text = f'{stage} of 4, {STAGES[stage]}'
        rows.append(('Stage', f'{text}; confidence {share}' if named else text))
    if share and not named:
        rows.append(('Confidence', f'{share} {claim}'))
    if math.isfinite(diagnosis.rms):
        level = number(diagnosis.rms, f'{unit} rms' if diagnosis.unit else f'rms ({unit})')
        if math.isfinite(diagnosis.level_over_baseline):
            level += f', {signed(diagnosis.level_over_baseline)} dB over its baseline'
        rows.append(('Level', level))
    if diagnosis.level_correction_sd > 0.0:
        taken = signed(-diagnosis.level_correction)
        sure = Z90 * diagnosis.level_correction_sd
        rows.append(
            ('Corrected', f'by {taken} ± {sure:.1f} dB for temperature and speed: '
             f'{_basis(diagnosis)}')
        )  # fmt: skip
    if math.isfinite(diagnosis.velocity_rms):
        zone = f', ISO 20816-3 zone {diagnosis.iso_zone}' if diagnosis.iso_zone else ''
        rows.append(('Velocity', number(diagnosis.velocity_rms, 'mm/s rms') + zone))
    if math.isfinite(diagnosis.temperature):
        rows.append(('Temperature', f'{diagnosis.temperature:.1f} °C'))
    if diagnosis.band_high > diagnosis.band_low:
        band = f'{diagnosis.band_low / 1e3:.1f} to {diagnosis.band_high / 1e3:.1f} kHz demodulated'
        rows.append(('Band', band))
    rows.append(('Next step', next_step(diagnosis)))
    return rows


def _basis(diagnosis: Any) -> str:
    """Return the basis of a correction, or why there is none, as it is printed."""
    return str(diagnosis.correction_basis).replace('+-', '±').replace('degC', '°C')


def measured(diagnosis: Any) -> list[tuple[str, str]]:
    """Return measured values beyond those of `facts`, and why there is no zone."""
    if not math.isfinite(diagnosis.peak):
        return [('Level', 'not measured')]
    peak = number(diagnosis.peak, diagnosis.unit and pretty(diagnosis.unit))
    crest, kurtosis = number(diagnosis.crest_factor), number(diagnosis.kurtosis)
    rows = [('Peak', f'{peak}, crest factor {crest}, kurtosis {kurtosis}')]
    if not diagnosis.iso_zone:
        why = ': needs machine group and mounting'
        if not math.isfinite(acceleration_factor(diagnosis.unit)):
            why = ': needs a unit of acceleration, g or m/s^2'
        elif not math.isfinite(diagnosis.velocity_rms):
            why = ': needs at least 1 s'
        elif diagnosis.shaft_hz < SLOW_HZ:
            why = ' below 600 1/min'
        elif math.isnan(diagnosis.shaft_hz):
            why = ': needs machine group, mounting and speed'
        rows.append(('Zone', f'none of ISO 20816-3{why}'))
    basis = _basis(diagnosis)
    if basis and not diagnosis.level_correction_sd > 0.0:
        rows.append(('Correction', basis))
    return rows


def reasons(diagnosis: Any) -> list[str]:
    """Return the deciding reason, why no other place is named, and the other reasons."""
    said = [str(reason) for reason in diagnosis.reasons]
    other = rival(diagnosis)
    return [*said[:1], *([other] if other else []), *said[1:]]


def rival(diagnosis: Any) -> str:
    """
    Return why another significant family is not named; '' if there is none.

    For example, in many bearings the lines of the outer race lie within some tenths of a per cent
    of shaft sidebands of the inner race, since BPFO + BPFI is a multiple of the shaft speed.
    """
    result = str(diagnosis.result_name)
    measured: list[dict[str, float]] = [
        {place: element(values, k) for k, place in enumerate(PLACES)}
        for values in (diagnosis.score, diagnosis.modulation_index)
    ]
    scores, index = measured
    own = scores.pop(result, 0.0)
    for place in diagnosis.faults:
        # Found as well: the title names it.
        scores.pop(str(place), None)
    limits = {place: Z_CAGE if place == 'cage' else Z_FAULT for place in scores}
    rivals = [
        place
        for place, score in scores.items()
        if score >= max(limits[place], own / RIVAL)
        or (score > limits[place] and index[place] > INDEX_FAULT)
    ]
    if not rivals:
        return ''
    other = max(rivals, key=lambda place: scores[place] / limits[place])
    name = name_of(other)
    if result == 'healthy' and index[other] < INDEX_SUSPECT:
        return (
            f'The {name} is significant ({scores[other]:.1f}), but its modulation index of '
            f'{index[other]:.2f} is below the {INDEX_SUSPECT:g} from which it would be suspect: '
            'balls pass a healthy race under load too.'
        )
    if result not in PLACES:
        return ''
    text = f'The {name} is significant too ({scores[other]:.1f} against {own:.1f})'
    fundamental, shaft = impacts(diagnosis, other), float(diagnosis.shaft_hz)
    sidebands = [
        k * diagnosis.fault_hz + n * shaft for k in range(1, 5) for n in range(-2, 3) if n
    ]
    close = min(abs(line - fundamental) for line in sidebands)
    if close < CLOSE * fundamental:
        return (
            f'{text}: its line is within {100.0 * close / fundamental:.1f} % of a shaft sideband '
            f'of the {name_of(result)}.'
        )
    return f'{text}: modulation index {index[other]:.2f} against {index[result]:.2f}.'


@dataclass
class Tally:
    """Number and times of the verdicts with one result."""

    first: float
    """Time of its first verdict, s."""
    last: float
    windows: int
    row: int
    """Consecutive windows up to now."""
    longest: int
    """Largest number of consecutive windows."""
    best: Any
    """Diagnosis message of the most urgent window; of equally urgent ones the clearest."""
    at: float
    """Time of that message, s."""
    spectra: dict[str, Any] = field(default_factory=dict)
    """Spectrum messages of that window by kind."""


class Headline:
    """
    Find the worst sustained verdict of a recording.

    A fault outranks suspect, suspect healthy, and healthy an insufficient window; of two faults
    the one of the later stage counts. A verdict is sustained after three consecutive windows. If
    none is, the most frequent one counts. Windows without a statement count only if no window
    makes one.

    Before the first full window there is no level. Verdicts on such windows count if they are a
    sustained suspect or fault, or if no window is full.
    """

    def __init__(self) -> None:
        self.tallies: dict[str, Tally] = {}
        """Tallies by result."""
        self.count = 0
        self.last: Any = None
        """Latest Diagnosis message."""
        self._before = ''
        self._recent: dict[str, Any] = {}

    def take(self, time: float, diagnosis: Any) -> None:
        """Take a verdict given at ``time`` in s."""
        result = str(diagnosis.result_name)
        tally = self.tallies.get(result)
        if tally is None:
            tally = self.tallies[result] = Tally(time, time, 0, 0, 0, diagnosis, time)
        tally.row = tally.row + 1 if result == self._before else 1
        tally.longest = max(tally.longest, tally.row)
        tally.windows += 1
        tally.last = time
        if _clarity(diagnosis) >= _clarity(tally.best):
            tally.best, tally.at = diagnosis, time
            tally.spectra = {k: m for k, m in self._recent.items() if same_window(m, diagnosis)}
        self.last, self._before = diagnosis, result
        self.count += 1

    def spectrum(self, message: Any) -> None:
        """Take a Spectrum message, which comes before or after the verdict on its window."""
        kind = str(message.kind)
        self._recent[kind] = message
        for tally in self.tallies.values():
            if same_window(message, tally.best):
                tally.spectra[kind] = message

    @property
    def spectra(self) -> dict[str, Any]:
        """Spectra by kind: of the window of the worst verdict, or the latest without a verdict."""
        return self.worst.spectra if self.count else self._recent

    @property
    def worst(self) -> Tally:
        """Return the worst sustained verdict. At least one verdict must have been taken."""
        tallies = [*self.tallies.values()]
        sustained = [t for t in tallies if t.longest >= SUSTAINED and urgency(t.best)[0]]
        if sustained:
            return max(sustained, key=lambda t: (urgency(t.best), t.windows))
        told = [t for t in tallies if _held(t.best)] or tallies
        return max(told, key=lambda t: (t.windows, urgency(t.best)))

    @property
    def ending(self) -> str:
        """State at the end in words, if it is not the worst verdict or is only held; else ''."""
        if not self.count:
            return ''
        end, shaft = '', ', shaft standing' if shaft_speed(self.last) == 'standing' else ''
        held = only_held(self.last)
        if self.worst.best.result_name != self.last.result_name:
            end = f'{title_of(self.last).lower()}{", held" if held else ""}'
        elif held:
            end = 'held' if shaft else held
        return f'{end}{shaft}' if end else ''

    @property
    def span(self) -> str:
        """Windows and times of the worst verdict, and the state in the last window."""
        worst = self.worst
        unit, length = time_unit(worst.last)
        digits = 0 if unit == 's' else 1
        first, last = (f'{at / length:.{digits}f} {unit}' for at in (worst.first, worst.last))
        text = f'{worst.windows} of {self.count} windows, from {first} to {last}'
        end = self.ending
        return f'{text}; in the last: {end}' if end else f'{text}; the same in the last'


def urgency(diagnosis: Any) -> tuple[int, int]:
    """
    Return the urgency of a verdict: rank of its level, 0 without a statement, and its stage.

    Before the first full window there is no level, and the level of the window alone counts.
    """
    rank = _held(diagnosis)
    if not rank and diagnosis.window_result == diagnosis.result:
        alone = RANKS.get(diagnosis.window_level, 0)
        # Part of a window can show a fault, but only a full one can show that there is none.
        rank = alone if alone > RANKS[LEVEL_OK] else 0
    return rank, _stage(diagnosis)


def _held(diagnosis: Any) -> int:
    """Return the rank of the level; 0 before the first full window and without a statement."""
    return RANKS.get(diagnosis.level, 0)


def only_held(diagnosis: Any) -> str:
    """
    Return the answer of a window if the one that is shown is only held; '' if it is not.

    A level is held for up to an hour after the last window that asked for it.
    """
    held, alone = _held(diagnosis), diagnosis.window_result
    # *Insufficient* is held over windows that tell something; short first windows change nothing.
    other = not held and alone != diagnosis.result
    if RANKS.get(diagnosis.window_level, 3) >= held and not other:
        return ''
    known = alone in range(len(RESULTS))
    return f'held, newest window {RESULTS[alone] if known else "unknown"}'


def same_window(one: Any, other: Any) -> bool:
    """
    Whether two messages are about the same window.

    The sample index alone is not enough: it restarts with the sensor.
    """
    begins = [(m.first_sample, stamp_ns(m.header.stamp)) for m in (one, other)]
    return begins[0] == begins[1]


def _clarity(diagnosis: Any) -> tuple[int, int, float, float]:
    """Return a sort key of windows with the same result; full windows come first."""
    evidence = [float(score) for score in diagnosis.score]
    if not diagnosis.faults:
        # If no place is named the highest score is chance, and the velocity counts.
        evidence = [float(diagnosis.velocity_rms)]
    clearest = max((value for value in evidence if math.isfinite(value)), default=0.0)
    return _held(diagnosis), _stage(diagnosis), float(diagnosis.confidence), clearest
