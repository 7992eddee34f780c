# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""
Write the tables of ``docs/nodes.md`` from the nodes themselves.

Each node is started in this process, with no network, and asked what it has::

    python docs/tables.py docs/nodes.md
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
import importlib
import inspect
import os
from pathlib import Path
import re
import sys
import tempfile
from typing import Any, TYPE_CHECKING

from bearing_twin.bearing import FAULT_CODES, find_bearing, LEVELS, next_step, RESULTS, TITLES
from bearing_twin.bearing.vocabulary import STAGE_STEPS, STAGES
from bearing_twin.diagnosis.result import insufficient
from bearing_twin.nodes.diagnosis_topics import LEVELS as STATUS_LEVELS
from bearing_twin.nodes.diagnosis_topics import VERDICT_LEVELS, verdict_status
from bearing_twin.recording.temperature import write_temperature_recording
from bearing_twin.recording.topics import FEATURES
from bearing_twin.ros.processes.launching import ensure_log_folder
import numpy as np
import rclpy
from rclpy.qos import DurabilityPolicy, ReliabilityPolicy
import yaml

if TYPE_CHECKING:
    from bearing_twin.assets.parameters.spec import Spec
    from bearing_twin.ros.lifecycle import ManagedNode
    from rclpy.qos import QoSProfile


NODES = ('twin', 'diagnosis', 'calibration', 'recorder', 'replay', 'adapter', 'fleet')

INTRODUCTION = """\
# Nodes

Written by `python docs/tables.py docs/nodes.md` from the nodes themselves.

All nodes are lifecycle nodes. With `autostart` (the default) a node configures and activates
itself, as `ros2 run` expects; with `autostart:=false` it waits for `ros2 lifecycle set` or a
lifecycle manager. Topic names are relative, so namespaces and remaps work; `/diagnostics` is
absolute. Where the quality of service is marked with \\*, it can be overridden at start with the
parameters `qos_overrides./TOPIC.publisher.reliability`, `.history` and `.depth` (1 .. 10000; for
inputs `.subscription.`), TOPIC being the full name.

A change of parameters is accepted or refused as a whole. Parameters with "no" in the column
"running" can be changed only while the node is not configured.

A value outside the column "values", which also has the unit, is refused with the limit and the
remedy. `0 or 10 .. 50000` means 10 to 50000, or 0 with the meaning given in the last column. A
value that is given always holds against the preset, also where it equals the default. Whole
numbers are accepted for `double` and `string`, at start (`bearing:=6307`) and by `ros2 param set`.
A parameter name that the node does not have is refused; at start, where a file may be shared, a
node logs a warning with the nearest names instead. A file of assets and an offline run refuse it.
A node whose name or namespace a parameter file misses logs which section it should have. The paths
of files and folders may begin with `~`.

ROS 2 joins the sections `/**` of all parameter files and of `-p` to the first one. Where a file
begins with `/**` and sets a parameter in a section `/**/twin` behind it, `-p` loses against it
(`ros2 launch` with our launch files does not): write such a file without `/**`.

What an earlier section has is only named in a later one (*as above*, *as in*).

Names with a point are nested tables in a parameter file (`lubricant: {viscosity_40: 4.6e-05}`). A
file of assets accepts both forms. A checkpoint, and the configuration in a recording, omits the
parameters of machine, sensor, oil and thermal laws that have their default.

The nodes subscribe to `joint_states` only if the parameter `joint` names a joint, the twin to
`calibration` only with `follow_calibration`.

The stamp of `vibration` is the time of its first sample, without regard to filter delays. The
twin's decimator shows what happened 15 samples earlier (0.586 ms at 25.6 kHz), as the converter of
a real accelerometer does with its own delay.

The fleet has the topics of a twin and a diagnosis for each asset, under its name (ASSET below),
and their parameters as `ASSET.twin.NAME` and `ASSET.diagnosis.NAME`, besides those listed. A
diagnosis whose twin is not hosted listens to `ASSET/vibration` and `ASSET/temperature`.

The twins of a fleet share one running sample index. `reset` and `load_state` of an asset set its
motion and keep the index. Its noise is drawn by index and therefore differs from the first run,
and its filter against aliasing settles again for a few milliseconds. A run of a fleet is repeated
to the bit from `~/checkpoint`; `bearing-twin verify` does so.

Each node reports its parts on `/diagnostics`, named `NODE: STATUS`. The keys of their values are
stable and carry the unit. A value is always a number or always a text, so that a time-series
database takes it; a number that is not known is left out. Each part is reported once a second; a
fleet with more than 64 parts spreads them over the second, 64 a message.

At the first start, and after an update, twin and fleet compile their kernel, which takes about a
minute of one core; `bearing-twin compile` does it beforehand. Meanwhile they are visible, answer
services and stay *unconfigured*; the log and `/diagnostics` report it. A transition to *inactive*
that is asked for meanwhile waits until it is done.
"""

CODES = """\
## Codes and levels

`diagnosis` and the status `bearing` carry a code that programs can rely on. In OPC UA terms each
machine is a device (OPC 10000-100) with one condition, whose type and severity (1 to 1000) follow
from the level; the code is its condition name. The next step of a place whose level is fault
follows from the stage; *ambiguous* of stage 1 or 2, which combs raised, has that step and its own.
Where something sound explains the lines as well, the step is what tells
([rules](diagnosis.md#confidence)). Where the level of a *suspect* has risen or is in zone C, the
step is to find the cause of the vibration. This package has no OPC UA server.
"""

CONDITIONS = {
    'none': ('check function', '`CheckFunctionAlarmType`, active', '100'),
    'ok': ('normal', 'none active', ''),
    'suspect': ('maintenance required', '`MaintenanceRequiredAlarmType`, active', '400'),
    'fault': ('maintenance required', '`MaintenanceRequiredAlarmType`, active', '700'),
}
"""Of each level: NAMUR NE 107, OPC UA for devices, severity."""

BLOCKS = {
    'data acquisition (DA)': '`vibration`, `temperature`, `joint_states`',
    'data manipulation (DM)': '`spectrum`, `envelope_spectrum`; of `diagnosis` `rms`, '
    '`velocity_rms`, `score`, `modulation_index`',
    'state detection (SD)': '`level_over_baseline`, `iso_zone`, `level`, `window_level`',
    'health assessment (HA)': '`result`, `fault_code`, `faults`, `confidence`, `stage`, `reasons`',
    'prognostic assessment (PA)': '`life_hours` of `twin_state` (ISO 281, by load and oil of the '
    'parameters); trend of `diagnose --series`',
    'advisory generation (AG)': 'next step, in `diagnose`, report and Rerun',
}
"""What is published, by the blocks of ISO 13374-1."""

TOPICS = {
    'temperature': 'outer ring, °C',
    'joint_states': 'shaft speed: velocity of the joint named, rad/s',
    'vibration': 'blocks of acceleration with a running sample index',
    'twin_state': 'temperature, β₀, contact, kinematics and deadlines of each block',
    'twin_checkpoint': 'complete state, from which a recording is re-run to the bit',
    'diagnosis_checkpoint': 'complete state, from which a recording is re-run to the bit',
    'diagnosis': 'verdict with evidence',
    'calibration': 'the twin fitted to the machine: quantities with intervals, and the residual',
    'spectrum': 'amplitude spectrum of the window: the largest in each step of about 1 Hz',
    'envelope_spectrum': 'squared envelope spectrum of the window with fault cursors',
    **dict.fromkeys(
        (f'features/{name}' for name in FEATURES),
        'field of the verdict of this name, in a standard type',
    ),
    'diagnostics': 'state of the node and its inputs, 1 Hz',
    'samples': 'samples of an accelerometer, 16 MiB at most (its type: `source`)',
    'imu': 'one sample a message (`source` is `imu`)',
    '~/checkpoint': 'complete state of all twins',
    'clock': 'recorded time, if `clock_rate` is not 0',
}

SERVICES = {
    'reset': 'start again: the twin at its seed, the diagnosis with a new window and baseline, '
    'the calibration with a new healthy twin',
    'save_state': 'write the complete state to a new file in the state folder',
    'load_state': 'go on from a saved state',
    'inject_defect': 'put a defect into the running twin, or remove it',
    'split': 'begin a new file',
    'snapshot': 'write the seconds before now (`snapshot` is true)',
    'pause': 'stop the recorded time',
    'resume': 'let it run on',
    'step': 'publish the next message while paused',
}

EVERY_NODE = ('/rosout', '/parameter_events')
CLOCK_IN = ('in', '/clock')
ABSOLUTE = ('diagnostics', 'clock')

PARAMETER = ('parameter', 'type', 'default', 'values', 'running', 'meaning')

Row = tuple[str, ...]


def document() -> str:
    """Return the text of ``docs/nodes.md``."""
    told: dict[Row, str] = {}
    with tempfile.TemporaryDirectory() as folder:
        sections = [_node_section(name, Path(folder), told) for name in NODES]
        return '\n'.join([INTRODUCTION, *sections, *codes()])


def _node_section(name: str, folder: Path, told: dict[Row, str]) -> str:
    """Return the section of a node; what ``told`` has of other nodes is only named in it."""
    node_class: type[ManagedNode] = importlib.import_module(f'bearing_twin.nodes.{name}').NODE
    topics: set[Row] = set()
    statuses: set[Row] = set()
    for parameters in _needed(name, folder):
        arguments = ['--ros-args', '--log-level', 'error', '--disable-rosout-logs']
        for key, value in parameters.items():
            arguments += ['-p', f'{key}:={value}']
        ensure_log_folder()
        rclpy.init(args=arguments)
        try:
            node = node_class()  # type: ignore[call-arg]
            try:
                node.bring_up()
                topics |= _topics(node)
                services = _services(node)
                statuses |= _statuses(node)
            finally:
                node.shut_down()
                node.destroy_node()
        finally:
            rclpy.try_shutdown()
    head = ('topic', '', 'type', 'quality of service', 'meaning')
    return '\n'.join(
        [
            f'## {name}',
            '',
            f'`ros2 run bearing_twin {name}`: {_first_line(node_class)}',
            '',
            *_table(head, _topics_once(name, topics, told)),
            *_once(name, ('service', 'type', 'meaning'), services, told),
            *_table(('status', 'numbers', 'texts'), sorted(statuses)),
            *_once(name, PARAMETER, _parameters(node.parameters.specs), told),
        ]
    )


def _first_line(node_class: type[ManagedNode]) -> str:
    text = (inspect.getdoc(node_class) or '').split('\n\n')[0].replace('\n', ' ')
    return text[0].lower() + text[1:]


def _needed(name: str, folder: Path) -> list[dict[str, str]]:
    """Parameters with which a node shows everything it has, in one or several starts."""
    if name == 'replay':
        recording = folder / 'temperature.mcap'
        write_temperature_recording(
            recording, np.arange(3.0), np.full(3, 20.0), source='tables', topic='/temperature'
        )
        return [{'recording': str(recording), 'clock_rate': '10.0', 'start_paused': 'true'}]
    if name == 'recorder':
        # Only what it knows beforehand: what else it finds depends on who is there.
        return [
            {'output': str(folder / 'bag'), 'exclude': '/diagnostics|/rosout|/parameter_events'}
        ]
    if name == 'adapter':
        return [{'sample_rate': '25600.0'}, {'source': 'imu'}]
    if name == 'fleet':
        return [{'names': '[ASSET]'}]
    return [{'joint': 'shaft', **({'follow_calibration': 'true'} if name == 'twin' else {})}]


def _of_any_node(row: Row) -> Row:
    """Return a row without the asset or the node to which its name belongs."""
    return (re.sub(r'ASSET/(twin/|diagnosis/|)|~/', '', row[0]), *row[1:])


def _once(node: str, head: Row, rows: Sequence[Row], told: dict[Row, str]) -> list[str]:
    """Return a table of the rows that were not told before, and the others by their node."""
    new, again = list[Row](), dict[str, list[str]]()
    for row in rows:
        if (of := told.setdefault(_of_any_node(row), node)) == node:
            new.append(row)
        else:
            again.setdefault(of, []).append(row[0])
    lines = _table(head, new) if new else []
    known = '; '.join(f'as in [{of}](#{of}): {", ".join(names)}' for of, names in again.items())
    return [*lines, *([f'A{known[1:]}.', ''] if again else [])]


def _topics_once(node: str, rows: Iterable[Row], told: dict[Row, str]) -> list[Row]:
    """Return rows of new topics, alike ones joined, and of known ones by quality of service."""
    new, again = dict[Row, list[str]](), dict[Row, list[str]]()
    for row in sorted(rows, key=lambda row: (row[1], row[0])):
        name, direction, kind, qos, meaning = row
        about = _of_any_node((name, kind))
        if about in told:
            again.setdefault((direction, 'as above', qos, 'as above'), []).append(name)
        else:
            new.setdefault((direction, kind, qos, meaning), []).append(name)
            told[about] = node
    return [(', '.join(names), *rest) for rest, names in (*new.items(), *again.items())]


def _table(head: Row, rows: Iterable[Row]) -> list[str]:
    lines = [head, ('---',) * len(head), *rows]
    return [*('| ' + ' | '.join(line) + ' |' for line in lines), '']


def _topics(node: ManagedNode) -> set[Row]:
    own = f'/{node.get_name()}/'
    overrides = node.get_parameters_by_prefix('qos_overrides')
    rows: set[Row] = set()
    for direction, ends in (('in', node.subscriptions), ('out', node.publishers)):
        for end in ends:
            topic = end.topic_name
            if topic in (*EVERY_NODE, f'{own}transition_event') or (direction, topic) == CLOCK_IN:
                continue
            name = topic.replace(own, '~/').lstrip('/')
            meaning = TOPICS[name.removeprefix('ASSET/')]
            mark = ' \\*' if any(key.startswith(f'{topic}.') for key in overrides) else ''
            rows.add(
                (
                    f'`{topic if name in ABSOLUTE else name}`',
                    direction,
                    f'`{_type_name(end.msg_type)}`',
                    _qos(end.qos_profile) + mark,
                    meaning,
                )
            )
    return rows


def _statuses(node: ManagedNode) -> set[Row]:
    """Return the parts of a node on /diagnostics, and the keys of their values."""
    rows: set[Row] = set()
    for part, (task, _) in node.health.tasks.items():
        status = task()
        values = dict(status.values)
        if 'bearing' in part:
            # Complete from the first verdict on.
            nothing = insufficient([], find_bearing('6307'))
            values = dict(verdict_status(nothing, '6307', 0.0).values)
        texts = [f'`{key}`' for key, value in values.items() if not isinstance(value, int | float)]
        numbers = [f'`{key}`' for key in values if f'`{key}`' not in texts]
        rows.add((f'`{part}`', ', '.join(numbers), ', '.join(texts)))
    return rows


def codes() -> list[str]:
    """Return the tables of answers and levels, from the vocabulary."""
    answers = [
        (f'`{code}`', str(RESULTS.index(result)), TITLES[result], next_step(result))
        for result, code in FAULT_CODES.items()
    ]
    levels = [
        (f'`{level}`', str(VERDICT_LEVELS[level]), STATUS_LEVELS[level].name, *CONDITIONS[level])
        for level in LEVELS
    ]
    stages = [(str(stage), STAGES[stage], step) for stage, step in enumerate(STAGE_STEPS) if stage]
    return [
        CODES,
        *_table(('fault_code', 'result', 'meaning', 'next step'), answers),
        *_table(('stage of a fault', 'name', 'next step'), stages),
        *_table(
            (
                'level',
                'verdict_level',
                '/diagnostics',
                'NAMUR NE 107',
                'OPC UA condition',
                'severity',
            ),
            levels,
        ),
        'What is published, by the blocks of ISO 13374-1:',
        '',
        *_table(('block', 'fields and topics'), BLOCKS.items()),
    ]


def _services(node: ManagedNode) -> list[Row]:
    own = f'/{node.get_name()}/'
    rows: list[Row] = []
    for service in node.services:
        name = service.service_name.replace(own, '~/').lstrip('/')
        verb = name.rpartition('/')[2]
        if verb in SERVICES:
            rows.append((f'`{name}`', f'`{_type_name(service.srv_type)}`', SERVICES[verb]))
    return sorted(rows)


def _type_name(kind: Any) -> str:
    package, part, *_ = kind.__module__.split('.')
    return f'{package}/{part}/{kind.__name__}'


def _qos(profile: QoSProfile) -> str:
    words = ['reliable' if profile.reliability == ReliabilityPolicy.RELIABLE else 'best effort']
    words.append(f'depth {profile.depth}')
    if profile.durability == DurabilityPolicy.TRANSIENT_LOCAL:
        words.append('transient local')
    return ', '.join(words)


def _parameters(specs: Iterable[Spec]) -> list[Row]:
    rows: list[Row] = []
    for spec in specs:
        if spec.choices:
            limits = ', '.join(f'`{choice}`' if choice else "`''`" for choice in spec.choices)
        elif spec.low is not None and spec.high is not None:
            limits = f'{_number(spec.low)} .. {_number(spec.high)}'
            if spec.special is not None and not spec.low <= spec.special[0] <= spec.high:
                limits = f'{_number(spec.special[0])} or {limits}'
            limits = f'{limits} {spec.unit}'.rstrip()
        else:
            limits = spec.unit
        kind = 'string[]' if isinstance(spec.default, list) else type(spec.default).__name__
        rows.append(
            (
                f'`{spec.name}`',
                {'str': 'string', 'float': 'double'}.get(kind, kind),
                f'`{_default(spec.default)}`',
                limits,
                'yes' if spec.running else 'at start only' if spec.read_only else 'no',
                spec.description.replace('|', '\\|'),
            )
        )
    return rows


def _number(value: float) -> str:
    """Return a number in six digits; a whole one that has more in all of them."""
    short = f'{value:.6g}'
    return str(int(value)) if value == int(value) != float(short) else short


def _default(value: object) -> str:
    value = float(f'{value:.6g}') if isinstance(value, float) else value
    return str(yaml.safe_dump(value, default_flow_style=True)).split('\n')[0]


def main(arguments: Sequence[str] | None = None) -> int:
    """Write the document to the file named."""
    words = list(sys.argv[1:] if arguments is None else arguments)
    if len(words) != 1:
        print('usage: python docs/tables.py FILE', file=sys.stderr)
        return 2
    # Nodes of others on this network must not get into what ours are found to have.
    os.environ['ROS_AUTOMATIC_DISCOVERY_RANGE'] = 'OFF'
    Path(words[0]).write_text(document(), encoding='utf-8')
    return 0


if __name__ == '__main__':
    sys.exit(main())
