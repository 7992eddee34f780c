# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""The appendix of a report: parameters off their defaults, health, actions, terms."""

from __future__ import annotations

from collections.abc import Sequence
from html import escape
from pathlib import PurePath
from typing import Any, TYPE_CHECKING

from bearing_twin.assets.parameters import diagnosis as diagnosis_parameters
from bearing_twin.assets.parameters import realtime as realtime_parameters
from bearing_twin.assets.parameters import recorder as recorder_parameters
from bearing_twin.assets.parameters import twin as twin_parameters
from bearing_twin.assets.parameters.shared import AUTOSTART
from bearing_twin.bearing.vocabulary import STAGE_STEPS, STAGES
from bearing_twin.view.report.html import table
from bearing_twin.view.verdict import number

if TYPE_CHECKING:
    from bearing_twin.recording.health import RecordingHealth
    from bearing_twin.recording.reader import RecordingInfo
    from bearing_twin.view.report.data import Machine


SPECS = {
    'twin': (*twin_parameters.SPECS, *realtime_parameters.PUBLISHING),
    'diagnosis': diagnosis_parameters.SPECS,
    'recorder': recorder_parameters.SPECS,
}
PATHS = ('output', 'rerun_file', 'state_directory', 'recording', 'assets_file', 'source')
"""Parameters that are paths."""
TERMS = (
    (
        'BPFO, BPFI',
        'ball pass frequency of the outer and inner race: how often balls roll over a defect',
    ),
    ('BSF', 'ball spin frequency; a defect of a ball strikes both races, so at 2 x BSF'),
    ('FTF', 'fundamental train frequency: the speed of the cage'),
    ('order', 'multiple of the shaft speed'),
    ('significance', 'score of a comb of harmonics in standard deviations over that of noise'),
    (
        'modulation index',
        'how strongly the envelope swings at the harmonics of a fault: m of 1 + m cos',
    ),
    ('squared envelope spectrum', 'how often a band of high frequency swells and fades'),
    ('level', 'root mean square (rms) of the acceleration'),
    ('velocity', 'root mean square of 10 to 1000 Hz, by which ISO 20816-3 judges a machine'),
    ('crest factor', 'largest magnitude over rms'),
    (
        'kurtosis',
        '3 for noise, more for impacts; falls again in late damage, so it is no measure of it',
    ),
    ('ISO 20816-3 zone', 'A new, B long operation, C limited operation, D damage is possible'),
    ('beta0', "the paper's factor of temperature on contact stiffness and defect depth"),
    ('K_b, C_d', 'Hertz contact stiffness and defect depth in use'),
    ('kappa', 'viscosity of the oil over the one needed (ISO 281)'),
    ('cage slip', 'part by which the cage lags behind pure rolling'),
)


def appendix(
    info: RecordingInfo, health: RecordingHealth, machines: Sequence[Machine]
) -> list[str]:
    """Return the appendix as HTML."""
    return [
        *_parameters(info, machines),
        *_health(info, health, machines),
        '<h2>Recommended action by stage</h2>',
        table(
            (f'{stage or "not known"} {STAGES[stage]}', step)
            for stage, step in enumerate(STAGE_STEPS)
        ),
        '<h2>Terms</h2>',
        table(TERMS),
    ]


def off_default(kind: str, values: dict[str, Any]) -> list[tuple[str, str]]:
    """Return the parameters of a node that differ from their defaults, and the defaults."""
    rows = []
    specs = {spec.name: spec for spec in (*SPECS.get(kind, ()), AUTOSTART)}
    for name, value in values.items():
        spec = specs.get(name)
        # Values in the metadata are texts.
        if spec is None or str(value) != str(spec.default):
            default = f' (default {spec.default!r})' if spec is not None else ''
            rows.append((str(name), f'{_shown(str(name), value)}{default}'))
    return rows


def _parameters(info: RecordingInfo, machines: Sequence[Machine]) -> list[str]:
    nodes, parts, known = {}, [], set()
    for machine in machines:
        for node, (kind, values) in sorted(machine.parameters.items()):
            # In a fleet the name is 'BEARING in NODE'.
            known.add(node.rpartition(' in ')[2].strip('/').replace('/', '.'))
            nodes[node] = off_default(kind, values)
    for name, values in sorted(info.metadata.items()):
        if not name.startswith('bearing_twin.'):
            continue
        kind, _, node = name.removeprefix('bearing_twin.').partition('.')
        if kind in SPECS:
            if node not in known:
                nodes[node or kind] = off_default(kind, values)
        elif node not in known:
            heading = f'{kind} of {node}' if node else kind
            parts.append(f'<h2>{escape(heading.capitalize())}</h2>')
            parts.append(
                table((key, _shown(key, value)) for key, value in values.items() if value)
            )
    off = [(f'{node}: {name}', text) for node, rows in nodes.items() for name, text in rows]
    same = ', '.join(node for node, rows in nodes.items() if not rows)
    return [
        *(['<h2>Parameters that differ from the defaults</h2>'] if nodes else []),
        *([table(off)] if off else []),
        *([f'<p>None of {escape(same)}.</p>'] if same else []),
        *parts,
    ]


def _health(
    info: RecordingInfo, health: RecordingHealth, machines: Sequence[Machine]
) -> list[str]:
    unread = [
        f'{topic}: {count} messages cannot be read ({reason})'
        for machine in machines
        for topic, (count, reason) in machine.unread.items()
    ]
    problems = list(dict.fromkeys([*info.problems, *health.problems, *unread]))
    parts = ['<h2>Health of the recording</h2>']
    if problems:
        texts = ''.join(f'<li>{escape(text)}</li>' for text in problems)
        parts.append(f'<ul class="bad">{texts}</ul>')
    else:
        parts.append('<p class="good">Sound: nothing missing, time runs forwards.</p>')
    rows = [('Finished', 'yes' if info.finished else 'no')]
    for machine in machines:
        last = machine.last_state
        if last is not None:
            text = (
                f'{last.blocks_published} blocks published, {last.blocks_late} late, '
                f'{last.blocks_dropped} dropped; worst lateness '
                f'{number(1e3 * machine.worst_lateness, "ms")}'
            )
            rows.append((f'Twin {machine.name}', text))
    parts.append(table(rows))
    cells = []
    for name, topic in sorted(health.topics.items()):
        missing = str(topic.samples_missing) if topic.blocks else '-'
        kind = info.topics[name].type_name if name in info.topics else ''
        cells.append(
            f'<tr><td>{escape(name)} <small>{escape(kind)}</small></td>'
            f'<td class="n">{topic.count}</td><td class="n">{topic.longest_gap:.2f} s</td>'
            f'<td class="n">{missing}</td></tr>'
        )
    # Printed only if there are problems.
    parts.append(
        f'<table{"" if problems else " class=screen"}><tr><th>Topic</th>'
        '<th class="n">messages</th><th class="n">longest pause</th>'
        '<th class="n">samples missing</th></tr>' + ''.join(cells) + '</table>'
    )
    return parts


def _shown(key: str, value: Any) -> str:
    """Return a value as text, a path without its folders: reports are passed on."""
    return PurePath(str(value)).name if key in PATHS else str(value)
