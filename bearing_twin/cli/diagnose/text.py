# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Diagnosis as text: fault, place, confidence and next step."""

from __future__ import annotations

import sys
from typing import Any

from bearing_twin.bearing import FaultFrequencies, PLACES, TITLES
from bearing_twin.cli.diagnose.task import CARD
from bearing_twin.cli.terminal import by_level, fitted, lined_up
from bearing_twin.quantity import signed
from bearing_twin.view.style import FAMILIES
from bearing_twin.view.verdict import facts, measured, number, reasons

_ORDERS = {family.key: family.label for family in FAMILIES}


def card(message: Any) -> list[list[str]]:
    """Return the rows of a Diagnosis message as in the report, with the reasons."""
    *rows, step = facts(message)
    rows += measured(message)
    if (given := message.shaft_hz_given) > 0.0:
        off = message.shaft_hz / given - 1.0
        # Refined, or the mean of a speed that moves.
        used = f'; used: {100.0 * off:+.2f} %, by lines of the shaft' if abs(off) > 1e-4 else ''
        rows.append(('Speed given', f'{given:.4g} Hz{used}'))
    rows += [('' if index else 'Why', text) for index, text in enumerate(reasons(message))]
    return [list(row) for row in (*rows, step)]


def line(answer: dict[str, Any]) -> str:
    """Return a line for one of many files, with the reasons below it."""
    name = f'{answer["file"]}, {answer["channel"]}' if answer['channel'] else answer['file']
    sure = f'{answer["confidence"]:.2f} {answer["claim"]}'.strip()
    text = f'{name}: {_verdict(answer)}, confidence {sure}'
    if answer['shaft_hz'] is not None:
        text += f', shaft {answer["shaft_hz"]:.3f} Hz'
    parts = [text, *(f'    {reason}' for reason in answer['reasons'])]
    if sys.stdout.isatty():
        # A terminal would cut words at its edge.
        parts = [row for part in parts for row in fitted(part, indent=' ' * 6, width=200)]
    return '\n'.join(parts)


def page(answer: dict[str, Any]) -> str:
    """Return the full text for a single file, with the evidence at the end."""
    rows = [('Verdict', _verdict(answer)), ('Bearing', answer['bearing']), *answer[CARD]]
    lines = [by_level(answer['source'], 'bold'), *lined_up(rows), *_table(answer)]
    evidence = answer['evidence']
    if evidence['line_hz']:
        lines.append('')
    for hertz, height in zip(evidence['line_hz'], evidence['line_level'], strict=True):
        lines.append(f'line of the envelope at {hertz:.2f} Hz, {number(height)} x floor')
    return '\n'.join(lines)


def _verdict(answer: dict[str, Any]) -> str:
    places = '+'.join(answer['faults'])
    named = f' {places}' if places and answer['faults'] != [answer['result']] else ''
    text = f'{answer["result"]} [{answer["level"]}]{named}'
    title = TITLES[answer['result']] if answer['result'] in PLACES else ''
    title = f' ({title.lower()})' if title else ''
    return f'{by_level(text, answer["level"])}{title}'


def _table(answer: dict[str, Any]) -> list[str]:
    evidence, shaft_hz = answer['evidence'], answer['shaft_hz']
    if shaft_hz is None or any(value is None for value in evidence['expected_hz'].values()):
        return []
    frequencies = FaultFrequencies(**evidence['expected_hz'])
    # The rows fit 80 columns.
    rows = [
        '',
        '              expected       clearest comb         off  significance   index',
        '              Hz     order      Hz     order',
    ]
    for place in PLACES:
        found, expected = evidence['found_hz'].get(place), frequencies.impacts(place)
        text = f'{place:<6}{_ORDERS[place]:<7}{expected:7.2f}{expected / shaft_hz:7.3f}'
        if found is None:
            rows.append(f'{text}   not searched')
            continue
        off = found / expected - 1.0
        text += f'{found:9.2f}{found / shaft_hz:7.3f} {signed(100.0 * off, 2):>6}%'
        text += f'{evidence["score"][place]:14.1f}{evidence["modulation_index"][place]:8.2f}'
        named = place in answer['faults']
        rows.append(by_level(f'{text}  <-', answer['level']) if named else text)
    return rows
