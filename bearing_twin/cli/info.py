# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""``bearing-twin info``: contents and health of a recording."""

from __future__ import annotations

import argparse
from dataclasses import asdict
from datetime import datetime, UTC
import json
from pathlib import Path
from typing import TYPE_CHECKING

from bearing_twin.cli.terminal import wrapped
from bearing_twin.errors import shown
from bearing_twin.recording.finding import find_recording
from bearing_twin.recording.health import examine
from bearing_twin.recording.reader import recording_info
from bearing_twin.recording.temperature import is_undated
from bearing_twin.stamps import NANO

if TYPE_CHECKING:
    from bearing_twin.recording.health import RecordingHealth
    from bearing_twin.recording.reader import RecordingInfo


def configure(parser: argparse.ArgumentParser) -> None:
    parser.add_argument('recording', type=Path, help='MCAP file, bag folder or folder of a demo')
    parser.add_argument(
        '--no-health', action='store_true', help='read the summary only, not every message'
    )
    parser.add_argument('--json', action='store_true', help='print as JSON')


def run(args: argparse.Namespace) -> int:
    """Print contents and health; return 0 if no problem was found."""
    path = find_recording(args.recording)
    info, health = (recording_info(path), None) if args.no_health else examine(path)
    problems = list(dict.fromkeys([*info.problems, *(health.problems if health else ())]))
    if args.json:
        answer = {
            **asdict(info),
            'topics': {
                name: {k: v for k, v in asdict(topic).items() if k != 'schemas'}
                for name, topic in info.topics.items()
            },
            'duration': info.duration,
            'health': asdict(health) if health else None,
            'problems': problems,
        }
        print(json.dumps(answer, default=str))
    else:
        _print(info, health, problems)
    return 1 if problems else 0


def _print(info: RecordingInfo, health: RecordingHealth | None, problems: list[str]) -> None:
    at = datetime.fromtimestamp(info.start / NANO, tz=UTC)
    begin = f'{at:%Y-%m-%d %H:%M:%S.%f} UTC'
    if is_undated(info.start):
        begin = 'not dated: times count from the begin'
    before = [
        ('recording', f'{info.path} ({info.profile or "no profile"}, {info.library})'),
        *(('file', f'{path.name} ({path.stat().st_size / 1e6:.3g} MB)') for path in info.files),
        ('finished', 'yes' if info.finished else 'no'),
        *([('begin', begin)] if info.count else []),
        ('duration', f'{info.duration:.3f} s'),
        ('messages', str(info.count)),
    ]
    topics = [(f'{"messages":>8}  {"longest pause":>13}', 'topic  type')]
    for name, topic in sorted(info.topics.items()):
        checked = health.topics.get(name) if health else None
        pause = f'{checked.longest_gap:.3f} s' if checked and checked.count > 1 else ''
        topics.append((f'{topic.count:8d}  {pause:>13}', f'{name}  {topic.type_name}'))
    after = [('attachment', f'{name} ({size} bytes)') for name, size in info.attachments.items()]
    after += [('metadata', name) for name in info.metadata]
    after += [('problem', text) for text in problems]
    if health and not problems:
        after.append(('health', 'sound: nothing missing, time runs forwards'))
    for key, text in [*before, *(topics if info.topics else ()), *after]:
        print(*wrapped(f'{key:<10}', shown(text)), sep='\n')
