# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""A recording as one self-contained HTML page, to be mailed and printed."""

from __future__ import annotations

from datetime import datetime, timezone
from html import escape
from pathlib import PurePath
from typing import Any, TYPE_CHECKING

from bearing_twin import __version__
from bearing_twin.recording.health import recording_health
from bearing_twin.recording.reader import recording_info
from bearing_twin.stamps import NANO
from bearing_twin.view.report.data import collect
from bearing_twin.view.report.plots import figures
from bearing_twin.view.report.svg import VERDICT_COLOURS
from bearing_twin.view.verdict import facts, next_step, number, pretty, shaft_speed, title_of

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence
    from pathlib import Path

    from bearing_twin.recording.health import RecordingHealth
    from bearing_twin.recording.reader import RecordingInfo
    from bearing_twin.view.report.data import Machine

__all__ = ['report_page']

PATHS = ('output', 'rerun_file', 'state_directory', 'recording', 'assets_file')
"""Parameters that are paths."""

CSS = """
:root { color-scheme: light; }
body { font: 15px/1.45 system-ui, 'Segoe UI', 'DejaVu Sans', sans-serif; color: #212121;
  background: #fff; max-width: 820px; margin: 0 auto; padding: 24px 16px; }
h1 { font-size: 22px; margin: 0 0 4px; overflow-wrap: anywhere; }
h2 { font-size: 17px; margin: 28px 0 8px; border-bottom: 1px solid #bdbdbd; }
p.sub { color: #616161; margin: 0 0 16px; }
.verdict { color: #fff; border-radius: 6px; padding: 14px 18px; margin: 12px 0;
  print-color-adjust: exact; -webkit-print-color-adjust: exact; }
.verdict.suspect { color: #212121; }
.verdict b { display: block; font-size: 28px; line-height: 1.2; }
figure { margin: 14px 0; break-inside: avoid; }
figure svg { width: 100%; height: auto; }
figcaption { color: #616161; font-size: 13px; }
table { border-collapse: collapse; width: 100%; font-size: 13px; margin: 8px 0; }
th, td { text-align: left; vertical-align: top; padding: 3px 8px 3px 0;
  border-bottom: 1px solid #e0e0e0; overflow-wrap: anywhere; }
th { font-weight: 600; width: 36%; }
tr { break-inside: avoid; }
td.n, th.n { text-align: right; width: auto; font-variant-numeric: tabular-nums; }
ul { margin: 6px 0; padding-left: 20px; }
.bad { color: #b71c1c; font-weight: 600; }
.good { color: #2e7d32; font-weight: 600; }
@page { size: A4; margin: 15mm; }
@media print { body { padding: 0; max-width: none; font-size: 11pt; }
  h2 { break-after: avoid; } }
"""


def report_page(path: Path) -> str:
    """
    Return the report on a recording as HTML that refers to nothing outside itself.

    Parameters
    ----------
    path
        MCAP file or bag folder; unfinished ones are read up to where they break off.

    Raises
    ------
    BearingTwinError
        If it cannot be read, or holds nothing of a bearing.

    """
    info = recording_info(path)
    machines = collect(path)
    health = recording_health(path)
    begin = datetime.fromtimestamp(info.start / NANO, tz=timezone.utc)
    # A bag folder is often just called 'bag': its parent says which.
    title = f'Bearing report: {"/".join(path.resolve().parts[-2:])}'
    body = [
        f'<h1>{escape(title)}</h1>',
        f'<p class="sub">{begin:%Y-%m-%d %H:%M:%S} UTC, {info.duration:.1f} s, '
        f'{info.count} messages. Made by bearing_twin {escape(__version__)}.</p>',
    ]
    for count, machine in enumerate(machines.values()):
        body += _machine(machine, f'm{count}-', named=len(machines) > 1 or bool(machine.namespace))
    body += _recording(info, health, machines.values())
    body += _parameters(info)
    return (
        '<!DOCTYPE html>\n<html lang="en"><head><meta charset="utf-8">'
        '<meta name="viewport" content="width=device-width, initial-scale=1">'
        f'<title>{escape(title)}</title><style>{CSS}</style></head>\n<body>\n'
        + '\n'.join(body)
        + '\n</body></html>\n'
    )


def _machine(machine: Machine, prefix: str, *, named: bool) -> list[str]:
    parts = [f'<h2>Machine {escape(machine.name)}</h2>'] if named else []
    parts.append(_banner(machine))
    pictures = [
        f'<figure>{svg}<figcaption>{escape(caption)}.</figcaption></figure>'
        for caption, svg in figures(machine, prefix)
    ]
    # The history right below the verdict, then what the verdict rests on.
    parts += pictures[:1]
    if machine.diagnoses:
        parts += ['<h2>Evidence</h2>', _evidence(machine.headline.worst.best)]
    parts += pictures[1:]
    return parts


def _banner(machine: Machine) -> str:
    if not machine.diagnoses:
        return (
            f'<div class="verdict" style="background:{VERDICT_COLOURS["insufficient"]}">'
            '<b>No diagnosis recorded</b>The recording holds vibration but no verdict; '
            "play it to the diagnosis node with 'bearing-twin replay'.</div>"
        )
    worst = machine.headline.worst.best
    result = str(worst.result_name)
    rows = [(name, text) for name, text in facts(worst) if name != 'Next step']
    lines = [f'Bearing {escape(str(worst.bearing))}: {escape(machine.headline.span)}.']
    lines += [', '.join(f'{escape(name.lower())} {escape(text)}' for name, text in rows) + '.']
    lines += [f'Next step: {escape(next_step(worst))}']
    colour = VERDICT_COLOURS.get(result, VERDICT_COLOURS['insufficient'])
    style = 'verdict suspect' if result == 'suspect' else 'verdict'
    return (
        f'<div class="{style}" style="background:{colour}"><b>{escape(title_of(worst))}</b>'
        + '<br>'.join(lines)
        + '</div>'
    )


def _evidence(message: Any) -> str:
    unit = pretty(message.unit)
    rows = [
        ('Code', str(message.fault_code)),
        ('Faults found', ', '.join(map(str, message.faults)) or 'none'),
        ('Window', f'{message.sample_count} samples at {message.sample_rate:g} Hz'),
        ('Shaft speed', shaft_speed(message)),
        ('Cage slip', number(100.0 * message.slip, '%')),
        ('BPFO, BPFI, BSF, FTF without slip', _frequencies(message)),
        ('rms, peak', f'{number(message.rms, unit)}, {number(message.peak, unit)}'),
        ('Crest factor, kurtosis', f'{number(message.crest_factor)}, {number(message.kurtosis)}'),
        ('Velocity 10 to 1000 Hz', number(message.velocity_rms, 'mm/s rms')),
        ('ISO 20816-3 zone', str(message.iso_zone) or 'not given: needs group and mounting'),
        ('Level over its own baseline', number(message.level_over_baseline, 'dB')),
        ('Bearing temperature', number(message.temperature, '°C')),
    ]
    if message.band_high > message.band_low:
        band = f'{message.band_low:.0f} to {message.band_high:.0f} Hz'
        rows.append(('Demodulated band', band))
    reasons = ''.join(f'<li>{escape(str(reason))}</li>' for reason in message.reasons)
    return _table(rows) + (f'<ul>{reasons}</ul>' if reasons else '')


def _recording(
    info: RecordingInfo, health: RecordingHealth, machines: Iterable[Machine]
) -> list[str]:
    problems = list(dict.fromkeys([*info.problems, *health.problems]))
    parts = ['<h2>Health of the recording</h2>']
    if problems:
        texts = ''.join(f'<li>{escape(text)}</li>' for text in problems)
        parts.append(f'<ul class="bad">{texts}</ul>')
    else:
        parts.append('<p class="good">Sound: nothing missing, time runs forwards.</p>')
    rows = [('Finished', 'yes' if info.finished else 'no')]
    for machine in machines:
        last = machine.last_state
        if last is None:
            continue
        rows.append(
            (
                f'Twin {machine.name}',
                f'{getattr(last, "blocks_published", "?")} blocks published, '
                f'{getattr(last, "blocks_late", "?")} late, '
                f'{getattr(last, "blocks_dropped", "?")} dropped; worst lateness '
                f'{number(1e3 * machine.worst_lateness, "ms")}',
            )
        )
    parts.append(_table(rows))
    cells = []
    for name, topic in sorted(health.topics.items()):
        missing = str(topic.samples_missing) if topic.blocks else '-'
        kind = info.topics[name].type_name if name in info.topics else ''
        cells.append(
            f'<tr><td>{escape(name)}<br><small>{escape(kind)}</small></td>'
            f'<td class="n">{topic.count}</td><td class="n">{topic.longest_gap:.2f} s</td>'
            f'<td class="n">{missing}</td></tr>'
        )
    parts.append(
        '<table><tr><th>Topic</th><th class="n">messages</th><th class="n">longest pause</th>'
        '<th class="n">samples missing</th></tr>' + ''.join(cells) + '</table>'
    )
    return parts


def _parameters(info: RecordingInfo) -> list[str]:
    parts = []
    for name, values in sorted(info.metadata.items()):
        if not name.startswith('bearing_twin.'):
            continue
        kind, _, node = name.removeprefix('bearing_twin.').partition('.')
        heading = f'{kind} of {node}' if node else kind
        parts.append(f'<h2>{escape(heading.capitalize())}</h2>')
        parts.append(_table([(key, _shown(key, value)) for key, value in values.items() if value]))
    return parts


def _shown(key: str, value: str) -> str:
    """Leave out the folders of a path: whoever is sent the page need not know them."""
    return PurePath(value).name if key in PATHS else value


def _frequencies(message: Any) -> str:
    hertz = [getattr(message, name) for name in ('bpfo', 'bpfi', 'bsf', 'ftf')]
    return ', '.join(f'{h:.2f}' for h in hertz) + ' Hz' if all(h > 0.0 for h in hertz) else 'none'


def _table(rows: Sequence[tuple[str, str]]) -> str:
    return (
        '<table>'
        + ''.join(f'<tr><th>{escape(k)}</th><td>{escape(v)}</td></tr>' for k, v in rows)
        + '</table>'
    )
