# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Well-formed recordings with absurd content, and every command on them."""

from __future__ import annotations

import contextlib
from io import StringIO
import json
import math
from pathlib import Path
import random
import re
import sys
import time
import traceback
from typing import Any

from bearing_twin.cli import main
from bearing_twin.recording.mcap.schema import store_from_text
from bearing_twin.recording.temperature import paper_schedule, write_temperature_recording
from fuzzing import at_most, clean, run_script, until
from mcap.writer import CompressionType, Writer
import numpy as np
from recording_samples import store
from rosbags.interfaces import Nodetype

LONGEST = 200.0
"""Longest processor time for one command, in loops of this machine, with loading of libraries."""
ROOM = 512 * 1024 * 1024
"""Memory that a command may take beyond what the libraries do, bytes."""

OWN = [f'bearing_twin_msgs/msg/{name}' for name in ('Vibration', 'TwinState', 'Diagnosis')]
OWN += [f'bearing_twin_msgs/msg/{name}' for name in ('Spectrum', 'Checkpoint')]
OTHERS = [f'sensor_msgs/msg/{name}' for name in ('Temperature', 'JointState', 'Imu')]
OTHERS += ['std_msgs/msg/Float32MultiArray', 'std_msgs/msg/Float64MultiArray']
OTHERS += ['std_msgs/msg/String', 'diagnostic_msgs/msg/DiagnosticArray', 'std_msgs/msg/Empty']
OTHERS += ['geometry_msgs/msg/AccelStamped', 'rcl_interfaces/msg/Log', 'rosgraph_msgs/msg/Clock']
STRANGE = {
    'bearing_twin_msgs/msg/Vibration': 'float32 x\nstring y\nfloat64[] sample_rate\n',
    'bearing_twin_msgs/msg/Diagnosis': 'float32[] level\nint8 reasons\nstring result\n',
    'bearing_twin_msgs/msg/TwinState': 'string temperature_used\nfloat32[3] shaft_hz\n',
    'bearing_twin_msgs/msg/Spectrum': 'float64 values\nstring bin_hz\nuint8[] kind\n',
    'bearing_twin_msgs/msg/Checkpoint': 'uint8 state\nfloat64 configuration\n',
    'sensor_msgs/msg/Temperature': 'string temperature\nfloat64[] header\n',
}
"""Types of known names with other fields: scalars where arrays are and the other way round."""
PLACES = {
    'Vibration': 'vibration', 'TwinState': 'twin_state', 'Diagnosis': 'diagnosis',
    'Temperature': 'temperature', 'JointState': 'joint_states', 'Spectrum': 'envelope_spectrum',
}  # fmt: skip
FLOATS = [0.0, -0.0, 1.0, -1.0, 25.4, 25600.0, 1e-9, 1e308, -1e308, 5e-324]
FLOATS += [math.nan, math.inf, -math.inf, 3.4e38, 1e20, 100.0]
TEXTS = ['', ' ', 'm/s^2', 'g', '$', r'$\frac{1}{', r'$\int_0^\infty$', '\x1b[31mred\x1b]0;t\x07']
TEXTS += ['<script>alert(1)</script>', '\u202eright', 'a' * 5000, '%s{0}', 'line\nbreak\rback']
TEXTS += ['../../etc/passwd', "'; import os", '\u00c4\u4e2d', 'x' * 100_000]
TEXTS += ['healthy', 'inner', '6307', 'twin', 'diagnosis', 'envelope', '{a: 1}', '- 1', '\x00']
SAMPLES = [0, 0, 1, 3, 64, 1024, 1024, 5000]


def value(kind: str, rng: random.Random) -> Any:
    """Return an absurd value of a base type."""
    if kind == 'string':
        return rng.choice(TEXTS)
    if kind == 'bool':
        return rng.random() < 0.5
    if kind.startswith('float'):
        chosen = rng.choice(FLOATS)
        return float(np.float32(chosen)) if kind == 'float32' else chosen
    if kind in ('byte', 'octet', 'char'):
        return rng.randrange(128)
    bits = int(kind.lstrip('uint'))
    low, high = (0, 2**bits - 1) if kind[0] == 'u' else (-(2 ** (bits - 1)), 2 ** (bits - 1) - 1)
    return rng.choice([low, high, 0, 1, min(high, 100), min(high, 1024), rng.randint(low, high)])


def array(kind: str, length: int, rng: random.Random) -> Any:
    """Return an array of a base type."""
    if kind in ('string', 'bool'):
        values = [value(kind, rng) for _ in range(min(length, 20))]
        return values if kind == 'string' else np.array(values, dtype=np.bool_)
    dtype = np.uint8 if kind in ('byte', 'octet', 'char') else np.dtype(kind)
    some = np.array([value(kind, rng) for _ in range(min(length, 8))], dtype=dtype)
    if rng.random() < 0.5 and kind.startswith('float'):
        return np.sin(np.arange(length)).astype(dtype)
    return np.resize(some, length) if length else np.zeros(0, dtype)


def field(types: Any, described: Any, rng: random.Random) -> Any:
    """Return an absurd value of a field."""
    with np.errstate(all='ignore'):
        node, about = described
        if node == Nodetype.BASE:
            return value(about[0], rng)
        if node == Nodetype.NAME:
            return message(types, about, rng)
        element, length = about
        if node == Nodetype.SEQUENCE:
            length = rng.choice(SAMPLES)
        if element[0] == Nodetype.BASE:
            if element[1][0] == 'string' and node == Nodetype.ARRAY:
                return [value('string', rng) for _ in range(length)]
            return array(element[1][0], length, rng)
        return [field(types, element, rng) for _ in range(min(length, 5))]


def message(types: Any, type_name: str, rng: random.Random) -> Any:
    """Return a valid message of a type with absurd content."""
    fields = {name: field(types, about, rng) for name, about in types.fielddefs[type_name][1]}
    if type_name == 'builtin_interfaces/msg/Time' and rng.random() < 0.7:
        fields |= {'sec': rng.randrange(100), 'nanosec': rng.randrange(10**9)}
    if 'sample_rate' in fields and rng.random() < 0.5 and isinstance(fields['sample_rate'], float):
        fields['sample_rate'] = 25600.0
    if type_name.endswith('Checkpoint') and isinstance(fields.get('configuration'), str):
        fields['configuration'] = rng.choice(
            ['{}', 'bearing: 6307', '{bearing: 6307, window: -1.0}', '[1, 2]', 'a: *b']
        )
    return types.types[type_name](**fields)


def write_absurd(path: Path, rng: random.Random) -> None:
    """Write one recording."""
    compression = rng.choice(list(CompressionType))
    with path.open('wb') as file:
        writer = Writer(
            file,
            compression=compression,
            chunk_size=rng.choice([1, 10_000, 1024 * 1024]),
            use_chunking=rng.random() < 0.9,
            use_statistics=rng.random() < 0.9,
        )
        writer.start(profile=rng.choice(['ros2', '', 'ros1', rng.choice(TEXTS)]), library='x')
        start = rng.choice([0, 1, 1_700_000_000 * 10**9, 2**62, 2**63 - 1, 2**64 - 10**12])
        step = rng.choice([0, 1, 40_000_000, -1, 10**9])
        for _ in range(rng.randint(1, 6)):
            add_topic(writer, rng, start, step)
        writer.add_metadata(rng.choice(TEXTS), {rng.choice(TEXTS): rng.choice(TEXTS)})
        writer.add_attachment(1, 1, rng.choice(TEXTS), rng.choice(TEXTS), b'data')
        writer.finish()


def add_topic(writer: Writer, rng: random.Random, start: int, step: int) -> None:
    """Write a topic with some messages."""
    type_name = rng.choice(OWN + OWN + OTHERS)
    if type_name in STRANGE and rng.random() < 0.25:
        text = STRANGE[type_name]
        types = store_from_text(type_name, text)
    else:
        types = store(type_name)
        text, _ = types.generate_msgdef(type_name, ros_version=2)
    name = PLACES.get(type_name.split('/')[-1], rng.choice(['vibration', 'twin_checkpoint', 'x']))
    if type_name.endswith('Checkpoint'):
        name = rng.choice(['twin_checkpoint', 'diagnosis_checkpoint', 'fleet_checkpoint'])
    topic = rng.choice(['/', '/', '/a/', ' a b/', r'/$\frac{$/', '/\x1b[2J/']) + name
    schema = writer.register_schema(type_name, 'ros2msg', text.encode())
    qos = {'offered_qos_profiles': rng.choice(['', '- depth: -1', '{', rng.choice(TEXTS)])}
    channel = writer.register_channel(topic, 'cdr', schema, qos)
    for index in range(rng.choice([1, 3, 30])):
        made = message(types, type_name, rng)
        if hasattr(made, 'first_sample') and rng.random() < 0.9:
            made.first_sample = index * 1024
        cdr = bytes(types.serialize_cdr(made, type_name))
        at = min(max(0, start + index * step), 2**64 - 1)
        writer.add_message(channel, at, cdr, rng.choice([at, 0, 2**63]), index)


def commands(path: Path, out: Path) -> list[list[str]]:
    """Every command that reads recordings."""
    return [
        ['info', str(path)],
        ['info', '--no-health', '--json', str(path)],
        ['verify', str(path)],
        ['recover', str(path), '-o', str(out / 'saved')],
        ['report', str(path), '-o', str(out / 'page.html')],
        ['diagnose', str(path), '--bearing', '6307'],
        ['diagnose', str(path), '--bearing', '6307', '--series', '--json'],
        ['fit', str(path), '--bearing', '6307', '--shaft-hz', '25'],
        ['view', str(path), '--save', str(out / 'picture.rrd')],
        ['replay', '--offline', str(path), '-o', str(out / 'again')],
    ]


def run_worker(count: int, seed: int, folder: Path, seconds: float) -> dict[str, Any]:
    """Make and read recordings for a time; runs in the worker process."""
    found: list[str] = []
    longest: dict[str, float] = {}
    path, out = folder / 'absurd.mcap', folder / 'out'
    out.mkdir()
    # The twin is compiled at its first block, which may take a minute.
    write_temperature_recording(folder / 'warm.mcap', *paper_schedule(1.0), source='test')
    with contextlib.redirect_stdout(StringIO()):
        main(['replay', '--offline', str(folder / 'warm.mcap'), '-o', str(folder / 'warm')])
    most = 0
    for index in until(time.monotonic() + seconds, count):
        write_absurd(path, random.Random(seed * 1_000_003 + index))
        for words in commands(path, out):
            before = _memory(peak=False)
            began = time.process_time()
            said = StringIO()
            try:
                redirected = contextlib.redirect_stdout(said), contextlib.redirect_stderr(said)
                with at_most(LONGEST), redirected[0], redirected[1]:
                    main(words)
                obeyed = re.search('.{0,80}[\x1b\u202e].{0,80}', said.getvalue())
                if obeyed:
                    found.append(f'{index} {words[0]}: {obeyed[0]!r} reaches the terminal')
            except BaseException:
                found.append(f'{index} {words[0]}: {traceback.format_exc(limit=-6)}')
            took = time.process_time() - began
            if index > 1:
                longest[words[0]] = max(longest.get(words[0], 0.0), took)
                most = max(most, _memory(peak=True) - before)
        clean(out)
        if len(found) >= 10:
            break
    return {'count': index + 1, 'failures': found, 'longest': longest, 'memory': most}


def _memory(*, peak: bool) -> int:
    """Return the memory of this process, bytes, or its peak since it was last asked for."""
    name = 'VmHWM' if peak else 'VmRSS'
    if not peak:
        # Each command is a process of its own, to which the pictures before it are nothing.
        Path('/proc/self/clear_refs').write_text('5')
    found = re.search(rf'{name}:\s+(\d+) kB', Path('/proc/self/status').read_text())
    assert found
    return 1024 * int(found[1])


def absurd(count: int, seed: int, folder: Path, seconds: float) -> dict[str, Any]:
    """Run a worker."""
    return run_script(__file__, count, seed, folder, seconds)


if __name__ == '__main__':
    _, count_, seed_, folder_, seconds_ = sys.argv
    print(json.dumps(run_worker(int(count_), int(seed_), Path(folder_), float(seconds_))))
