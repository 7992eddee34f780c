# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""``bearing-twin verify``: re-run a recording and compare it byte by byte."""

from __future__ import annotations

import argparse
from dataclasses import asdict
import json
from pathlib import Path
from typing import TYPE_CHECKING

from bearing_twin.errors import shown
from bearing_twin.offline.verify import reproduce
from bearing_twin.recording.finding import find_recording

if TYPE_CHECKING:
    from bearing_twin.offline.agreement import Reproduction


def configure(parser: argparse.ArgumentParser) -> None:
    parser.add_argument('recording', type=Path, help='recording of twin and diagnosis')
    parser.add_argument('--json', action='store_true', help='print the result as JSON')


def run(args: argparse.Namespace) -> int:
    """Compare; return 0 if messages of each topic were compared and all were identical."""
    result = reproduce(find_recording(args.recording))
    if args.json:
        about = {'uncompared': result.uncompared, 'identical': result.identical}
        print(json.dumps({**asdict(result), **about}, default=str))
        return 0 if result.identical else 1
    for topic, agreement in sorted(result.topics.items()):
        name = shown(topic)
        print(
            f'{name:<16} {agreement.identical} identical, {agreement.different} different, '
            f'{agreement.missing} missing, {agreement.skipped} not re-run'
        )
        if agreement.first_difference:
            print(f'{"":<16} first difference: {shown(agreement.first_difference)}')
    for note in result.notes:
        print(f'note             {shown(note)}')
    print(shown(_summary(result)))
    return 0 if result.identical else 1


def _summary(result: Reproduction) -> str:
    """Return a line on what was compared, what was not, and the result."""
    agreements = result.topics.values()
    if not result.topics:
        return 'NOTHING compared: no twin and no diagnosis was recorded'
    if any(agreement.different for agreement in agreements):
        return 'NOT identical'
    if result.uncompared:
        return (
            f'NOT compared: {", ".join(result.uncompared)}; the checkpoint to begin from, '
            'or the inputs after it, were not recorded under the names of the nodes'
        )
    skipped = sum(agreement.skipped for agreement in agreements)
    missing = sum(agreement.missing for agreement in agreements)
    rest = f'; {missing} missing in the recording' if missing else ''
    rest += f'; {skipped} messages were not re-run' if skipped else ''
    return f'identical to the byte: {", ".join(sorted(result.topics))}{rest}'
