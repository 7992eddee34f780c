# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""``bearing-twin paper``: recompute the seed paper and judge it claim by claim."""

from __future__ import annotations

import argparse
import json
from pathlib import Path
from textwrap import fill

from bearing_twin.cli.arguments import processes
from bearing_twin.errors import UsageError
from bearing_twin.paper import claims_table, recompute, summary_line

MOST_PROCESSES = 256


def configure(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        '--out',
        type=Path,
        default=Path('runs/paper'),
        help='folder for report.md, claims.json and the figures (default runs/paper); it has to '
        'be new, empty, or written by this command',
    )
    parser.add_argument('--jobs', type=int, help='processes (default: one a core)')
    form = parser.add_mutually_exclusive_group()
    form.add_argument('--json', action='store_true', help='print the claims as JSON')
    form.add_argument(
        '--table', action='store_true', help='print the claims as the table in docs/paper.md'
    )


def run(args: argparse.Namespace) -> int:
    """Recompute; return 0 when everything was written."""
    if (args.jobs or 0) > MOST_PROCESSES:
        msg = f'--jobs {args.jobs}: at most {MOST_PROCESSES} processes; one a core is the fastest'
        raise UsageError(msg)
    claims = recompute(args.out, processes=processes(args.jobs, MOST_PROCESSES))
    if args.json:
        entries = [claim.to_dict() for claim in claims]
        print(json.dumps(entries, indent=2, ensure_ascii=False, allow_nan=False))
    elif args.table:
        print(f'{summary_line(claims)}.\n\n{claims_table(claims, with_reason=False)}')
    else:
        for claim in claims:
            print(f'{claim.verdict.replace("_", " "):40} {claim.id}')
        print(f'\n{fill(summary_line(claims), 80)}\nreport: {args.out / "report.md"}')
    return 0
