# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""A diagnosis as a person reads it: what was found, where, how sure, and what to do next."""

from __future__ import annotations

import math
from typing import Any

from bearing_twin.bearing import FaultFrequencies, PLACES, TITLES
from bearing_twin.cli.terminal import by_level
from bearing_twin.diagnosis.severity import SLOW_HZ
from bearing_twin.view.style import FAMILIES

_ORDERS = {family.key: family.label for family in FAMILIES}


def line(answer: dict[str, Any]) -> str:
    """One of many files: a line, and why below it."""
    text = f'{answer["file"]}: {_verdict(answer)}'
    if answer['shaft_hz'] is not None:
        text += f', shaft {answer["shaft_hz"]:.3f} Hz'
    return '\n    '.join([text, *answer['reasons']])


def page(answer: dict[str, Any]) -> str:
    """Return everything that a person asks of one file."""
    evidence = answer['evidence']
    rows = [
        ('', by_level(answer['source'], 'bold')),
        ('verdict', _verdict(answer)),
        ('bearing', answer['bearing']),
        ('shaft', _shaft(answer)),
    ]
    rows += zip(('level', 'velocity'), _level(answer).split('; velocity '), strict=False)
    rows += [('found' if not index else '', text) for index, text in enumerate(_table(answer))]
    lines = [
        f'{hertz:.2f} Hz ({height:.3g} x floor)'
        for hertz, height in zip(evidence['line_hz'], evidence['line_level'], strict=True)
    ]
    if lines:
        low, high = evidence['band_hz']
        # Two in a row of 80 columns.
        rows += [
            ('' if k else 'lines', ', '.join(lines[k : k + 2])) for k in range(0, len(lines), 2)
        ]
        rows.append(('', f'of the envelope from {low:.0f} to {high:.0f} Hz'))
    rows += [('why' if not index else '', text) for index, text in enumerate(answer['reasons'])]
    rows.append(('next', answer['next_step']))
    return '\n'.join(f'{name:<9} {text}'.rstrip() if index else text
                     for index, (name, text) in enumerate(rows))  # fmt: skip


def _verdict(answer: dict[str, Any]) -> str:
    places = '+'.join(answer['faults'])
    named = f' {places}' if places and answer['faults'] != [answer['result']] else ''
    text = f'{answer["result"]} [{answer["level"]}]{named}'
    title = TITLES[answer['result']] if answer['result'] in PLACES else ''
    title = f' ({title.lower()})' if title else ''
    return f'{by_level(text, answer["level"])}{title}, confidence {answer["confidence"]:.2f}'


def _shaft(answer: dict[str, Any]) -> str:
    hertz, given = answer['shaft_hz'], answer['evidence']['shaft_hz_given']
    if given == 0.0:
        return 'standing'
    if hertz is None and given is None:
        return 'speed unknown: give --rpm or --shaft-hz'
    if hertz is None:
        return f'{given:.4g} Hz, {60.0 * given:.5g} 1/min given, not refined'
    text = f'{hertz:.4g} Hz, {60.0 * hertz:.5g} 1/min'
    if given is not None and abs(given / hertz - 1.0) > 1e-4:
        text += f' (given: {given:.4g} Hz, {given / hertz - 1.0:+.2%})'
    return text


def _level(answer: dict[str, Any]) -> str:
    severity = answer['evidence']['severity']
    unit = severity['unit'] or '(unit unknown)'
    if severity['rms'] is None:
        return 'not measured'
    text = f'RMS {severity["rms"]:.3g} {unit}, crest factor {severity["crest_factor"]:.3g}'
    if severity['velocity_rms'] is None:
        text += '; no ISO 20816-3 zone: give --unit'
    else:
        zone = f'zone {severity["iso_zone"]}'
        if not severity['iso_zone']:
            slow = (answer['shaft_hz'] or math.inf) < SLOW_HZ
            zone = 'no zone below 600 1/min' if slow else 'zone needs --power-group, --mounting'
        text += f'; velocity {severity["velocity_rms"]:.3g} mm/s, ISO 20816-3: {zone}'
    return text


def _table(answer: dict[str, Any]) -> list[str]:
    evidence, shaft_hz = answer['evidence'], answer['shaft_hz']
    if shaft_hz is None or any(value is None for value in evidence['expected_hz'].values()):
        return []
    frequencies = FaultFrequencies(**evidence['expected_hz'])
    # In a row of 80 columns.
    rows = [
        '              expected       clearest comb         off  signifi- index',
        '              Hz     order      Hz     order           cance',
    ]
    for place in PLACES:
        found, expected = evidence['found_hz'].get(place), frequencies.impacts(place)
        text = f'{place:<6}{_ORDERS[place]:<7}{expected:7.2f}{expected / shaft_hz:7.3f}'
        if found is None:
            rows.append(f'{text}   none looked for')
            continue
        off = found / expected - 1.0
        text += f'{found:9.2f}{found / shaft_hz:7.3f} {off:+7.2%}'
        text += f'{evidence["score"][place]:7.1f}{evidence["modulation_index"][place]:8.2f}'
        named = place in answer['faults']
        rows.append(by_level(f'{text}  <-', answer['level']) if named else text)
    return rows
