# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""A recording as one self-contained HTML page, to be mailed and printed: two sheets of A4."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from datetime import datetime, UTC
from html import escape
import math
from pathlib import Path
import re
from typing import Any, TYPE_CHECKING

from bearing_twin import __version__
from bearing_twin.bearing.vocabulary import PLACES, TITLES
from bearing_twin.diagnosis.thresholds import INDEX_FAULT, Z_CAGE, Z_FAULT
from bearing_twin.recording.temperature import is_undated
from bearing_twin.stamps import NANO, time_unit
from bearing_twin.view.report.appendix import appendix
from bearing_twin.view.report.data import collect
from bearing_twin.view.report.html import CSS, table
from bearing_twin.view.report.plots import (
    appended_figures,
    figures,
    pauses,
    verdicts_over_time,
)
from bearing_twin.view.report.svg import hex_colour
from bearing_twin.view.source import bearing_in_words
from bearing_twin.view.style import FAMILIES, ink, verdict_state
from bearing_twin.view.trends import element
from bearing_twin.view.verdict import (
    facts,
    impacts,
    measured,
    next_step,
    reasons,
    title_of,
    urgency,
)
import numpy as np

if TYPE_CHECKING:
    from bearing_twin.view.report.data import Machine

PRINTED = 2
"""Largest number of machines printed in detail: the most urgent ones, two sheets each."""
OVERVIEW = ('Found', 'Stage', 'Level', 'Velocity', 'Next step')
"""Columns of the table of several machines, after machine and verdict."""
BANNER_FACTS = ('Found', 'Next step')
"""Facts on the banner, which are not repeated below it."""


def report_page(path: Path, source: Path | None = None) -> str:
    """
    Return the report on a recording as self-contained HTML.

    Parameters
    ----------
    path
        MCAP file or bag folder; unfinished ones are read up to where they break off.
    source
        Vibration file from which the recording was made, if any.

    """
    info, health, found = collect(path)
    machines = sorted(found.values(), key=_urgency, reverse=True)
    begin = datetime.fromtimestamp(info.start / NANO, tz=UTC)
    # A bag folder is often just called 'bag': its parent names the run.
    title = f'Bearing report: {"/".join((source or path).resolve().parts[-2:])}'
    when = '' if is_undated(info.start) else f'{begin:%Y-%m-%d %H:%M:%S} UTC, '
    unit, length = time_unit(info.duration)
    body = [
        f'<h1>{escape(title)}</h1>',
        f'<p class="sub">{when}{info.duration / length:.1f} {unit}. '
        f'Made by bearing_twin {escape(__version__)}.</p>',
    ]
    named = any(machine.namespace for machine in machines)
    if len(machines) > 1:
        body += _overview(machines)
    for count, machine in enumerate(machines):
        body += [
            _section(count),
            *(_heading(machine, f'm{count}') if named else []),
            *_machine(machine, f'm{count}-'),
            '</section>',
        ]
    body.append('<section class="appendix"><h1>Appendix</h1>')
    for count, machine in enumerate(machines):
        pictures = _pictures(appended_figures(machine, f'a{count}-'))
        heading = _heading(machine, f'a{count}') if named and pictures else []
        # Printed only for a single machine.
        part = _section(0 if len(machines) == 1 else PRINTED)
        body += [part, *heading, *pictures, '</section>']
    body += appendix(info, health, machines)
    body.append('</section>')
    return (
        '<!DOCTYPE html>\n<html lang="en"><head><meta charset="utf-8">'
        '<meta name="viewport" content="width=device-width, initial-scale=1">'
        f'<title>{escape(title)}</title><style>{CSS}</style></head>\n<body>\n'
        + '\n'.join(body)
        + '\n</body></html>\n'
    )


def _section(count: int) -> str:
    """Open the section of a machine; only those of the most urgent machines are printed."""
    return f'<section class="{"machine" if count < PRINTED else "machine screen"}">'


def _heading(machine: Machine, name: str) -> list[str]:
    return [f'<h2 id="{name}">Machine {_breaking(machine.name)}</h2>']


def _breaking(name: str) -> str:
    """Return a name that breaks between its parts, where it has any."""
    return re.sub('(?<=[_-])', '<wbr>', escape(name))


def _machine(machine: Machine, prefix: str) -> list[str]:
    pictures = _pictures(figures(machine, prefix))
    if not machine.diagnoses:
        return [_no_verdict(machine), *pictures]
    worst = machine.headline.worst.best
    # The evidence follows right below the verdict, then the history.
    return [
        _banner(machine, worst),
        '<div class="columns">',
        table(row for row in facts(worst) if row[0] not in BANNER_FACTS),
        table(_measurement(machine, worst)),
        '</div>',
        _families(worst),
        _reasons(worst),
        *pictures,
    ]


def _overview(machines: Sequence[Machine]) -> list[str]:
    """Return a table of several machines with links to their sections."""
    heads = ''.join(f'<th>{name}</th>' for name in ('Machine', 'Verdict', *OVERVIEW))
    rows = [f'<tr>{heads}</tr>']
    for count, machine in enumerate(machines):
        title, known = 'No diagnosis recorded', dict[str, str]()
        if machine.diagnoses:
            worst = machine.headline.worst.best
            title, known = title_of(worst), dict(facts(worst))
        cells = ''.join(f'<td>{escape(known.get(name, ""))}</td>' for name in OVERVIEW)
        link = f'<a href="#m{count}">{_breaking(machine.name)}</a>'
        rows.append(f'<tr><th>{link}</th><td{_colour(machine)}>{escape(title)}</td>{cells}</tr>')
    text = f'<div class="wide"><table>{"".join(rows)}</table></div>'
    parts = ['<section class="overview">', text, *_pictures(verdicts_over_time(machines))]
    if len(machines) > PRINTED:
        parts.append(
            f'<p class="print">On paper the {PRINTED} most urgent of {len(machines)} machines '
            'follow in detail; the page on a screen has all of them.</p>'
        )
    return [*parts, '</section>']


def _colour(machine: Machine) -> str:
    """Return the HTML attributes that colour the verdict of a machine."""
    result = str(machine.headline.worst.best.result_name) if machine.diagnoses else ''
    colour = verdict_state(result).colour
    colours = f'background:{hex_colour(colour)};color:{ink(colour)}'
    return f' class="verdict" style="{colours}"'


def _urgency(machine: Machine) -> tuple[int, int]:
    return urgency(machine.headline.worst.best) if machine.diagnoses else (0, 0)


def _pictures(figures: Iterable[tuple[str, str]]) -> list[str]:
    return [
        f'<figure><div>{svg}</div><figcaption>{escape(caption)}.</figcaption></figure>'
        for caption, svg in figures
    ]


def _no_verdict(machine: Machine) -> str:
    remedy = "play it to the diagnosis node with 'bearing-twin replay'"
    if machine.unread:
        remedy = f'messages of {", ".join(machine.unread)} cannot be read: see the appendix'
    return (
        f'<div{_colour(machine)}>'
        f'<b>No diagnosis recorded</b>Vibration {escape(machine.source.whole)}. There is no '
        f'verdict; {escape(remedy)}.</div>'
    )


def _unjudged(machine: Machine) -> str:
    """Return in words how long there was no more verdict; '' if there was until the end."""
    times = np.array([*(time for time, _ in machine.diagnoses), machine.end])
    if times.size - 2 not in pauses(times):
        return ''
    seconds = float(times[-1] - times[-2])
    unit, length = time_unit(seconds)
    return f' No verdict on the last {seconds / length:.{0 if unit == "s" else 1}f} {unit}.'


def _banner(machine: Machine, worst: Any) -> str:
    found = dict(facts(worst)).get('Found', '')
    lines = [
        *([f'Found {escape(found)}.'] if found else []),
        f'In {escape(machine.headline.span)}.{_unjudged(machine)}',
        f'Vibration {escape(machine.source.whole or "not recorded")}.',
        *([f'Beyond the bearing: {escape(machine.unexplained)}.'] if machine.unexplained else []),
        f'Next step: {escape(next_step(worst))}',
    ]
    head = f'<b>{escape(title_of(worst))}</b>'
    return f'<div{_colour(machine)}>{head}{"<br>".join(lines)}</div>'


def _measurement(machine: Machine, worst: Any) -> list[tuple[str, str]]:
    """Return rows of asset, sensor, bearing, window and measured levels."""
    rows = [
        ('Asset', machine.hardware or machine.namespace or 'not named'),
        ('Sensor', machine.source.frame or 'not named'),
        *(
            [('Vibration topics', ', '.join(sorted(machine.sensors)))]
            if len(machine.sensors) > 1
            else []
        ),
        ('Bearing', bearing_in_words(str(worst.bearing))),
        (
            'Window',
            f'{worst.sample_count / (worst.sample_rate or math.nan):.1f} s '
            f'at {worst.sample_rate:g} Hz',
        ),
        *measured(worst),
    ]
    if not math.isfinite(worst.level_over_baseline):
        rows.append(
            ('Level over its own baseline', 'not known: no baseline yet, or one of another speed')
        )
    if math.isfinite(worst.smallest_detectable):
        rows.append(('Smallest fault that would show', f'{worst.smallest_detectable:.2f} mm'))
    return rows


def _families(worst: Any) -> str:
    """Return expected frequency and evidence of each family against the limits."""
    if not (worst.bpfo > 0.0 and worst.shaft_hz > 0.0):
        return ''
    cells = []
    for k, (place, family) in enumerate(zip(PLACES, FAMILIES, strict=True)):
        hertz = impacts(worst, place)
        score, index = element(worst.score, k), element(worst.modulation_index, k)
        limit = Z_CAGE if place == 'cage' else Z_FAULT
        name = TITLES[place].removesuffix(' fault')
        values = (
            f'{hertz / worst.shaft_hz:.3f}',
            f'{hertz:.2f} Hz',
            _against(score, limit, 1),
            _against(index, INDEX_FAULT, 2),
        )
        row = ''.join(f'<td class="n">{value}</td>' for value in values)
        found = ' class="found"' if place in worst.faults else ''
        cells.append(f'<tr{found}><th>{name} ({family.label})</th>{row}</tr>')
    head = ('Fault', 'order', 'expected', 'significance / limit', 'modulation index / limit')
    heads = ''.join(
        f'<th class="n">{h}</th>' if k else f'<th>{h}</th>' for k, h in enumerate(head)
    )
    return f'<table><tr>{heads}</tr>{"".join(cells)}</table>'


def _against(value: float, limit: float, digits: int) -> str:
    # Adding zero turns -0.0 into 0.0.
    text = f'{round(value, digits) + 0.0:.{digits}f} / {limit:g}' if math.isfinite(value) else '-'
    return f'<b>{text}</b>' if value > limit else text


def _reasons(worst: Any) -> str:
    items = ''.join(f'<li>{escape(reason)}</li>' for reason in reasons(worst))
    return f'<ul>{items}</ul>' if items else ''
