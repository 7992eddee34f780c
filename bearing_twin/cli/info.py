# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""``bearing-twin info``: what is inside a recording, and how sound it is."""

from __future__ import annotations

from dataclasses import asdict
from datetime import datetime, timezone
import json
from pathlib import Path
from typing import TYPE_CHECKING

from bearing_twin.errors import shown
from bearing_twin.recording.health import examine
from bearing_twin.recording.reader import recording_info
from bearing_twin.stamps import NANO

if TYPE_CHECKING:
    import argparse

    from bearing_twin.recording.health import RecordingHealth
    from bearing_twin.recording.reader import RecordingInfo


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the arguments."""
    parser.add_argument('recording', type=Path, help='MCAP file or bag folder')
    parser.add_argument(
        '--no-health', action='store_true', help='read the summary only, not every message'
    )
    parser.add_argument('--json', action='store_true', help='print as JSON')


def run(args: argparse.Namespace) -> int:
    """Print; status 0 if the recording is sound, as far as it was looked at."""
    if args.no_health:
        info, health = recording_info(args.recording), None
    else:
        info, health = examine(args.recording)
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
    begin = datetime.fromtimestamp(info.start / NANO, tz=timezone.utc)
    rows = [
        ('recording', f'{info.path} ({info.profile or "no profile"}, {info.library})'),
        *(('file', f'{path.name} ({path.stat().st_size / 1e6:.1f} MB)') for path in info.files),
        ('finished', 'yes' if info.finished else 'no'),
        ('begin', f'{begin:%Y-%m-%d %H:%M:%S.%f} UTC'),
        ('duration', f'{info.duration:.3f} s'),
        ('messages', str(info.count)),
    ]
    for name, topic in sorted(info.topics.items()):
        text = f'{topic.count:8d}  {name}  {topic.type_name}'
        if health and (checked := health.topics.get(name)) and checked.count > 1:
            text += f'  longest pause {checked.longest_gap:.3f} s'
        rows.append(('topic', text))
    rows += [('attachment', f'{name} ({size} bytes)') for name, size in info.attachments.items()]
    rows += [('metadata', name) for name in info.metadata]
    rows += [('problem', text) for text in problems]
    if health and not problems:
        rows.append(('health', 'sound: nothing missing, time runs forwards'))
    for key, text in rows:
        print(f'{key:<11} {shown(text)}')
