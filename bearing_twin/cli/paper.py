# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""``bearing-twin paper``: recompute the seed paper and judge it claim by claim."""

from __future__ import annotations

import json
import os
from pathlib import Path
from typing import TYPE_CHECKING

from bearing_twin.errors import UsageError
from bearing_twin.paper import claims_table, recompute, summary_line

if TYPE_CHECKING:
    import argparse


def configure(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        '--out',
        type=Path,
        default=Path('runs/paper'),
        help='folder for report.md, claims.json and the figures (default runs/paper); it has to '
        'be new, empty, or written by this command',
    )
    parser.add_argument(
        '--processes',
        type=int,
        default=os.cpu_count() or 1,
        help='processes for the simulations (default: number of cores)',
    )
    form = parser.add_mutually_exclusive_group()
    form.add_argument('--json', action='store_true', help='print the claims as JSON')
    form.add_argument(
        '--table', action='store_true', help='print the claims as the table in docs/paper.md'
    )


def run(args: argparse.Namespace) -> int:
    """Recompute; return 0 when everything was written."""
    if not 1 <= args.processes <= 256:
        msg = f'--processes {args.processes} is outside 1..256; leave it out to use every core'
        raise UsageError(msg)
    claims = recompute(args.out, processes=args.processes)
    if args.json:
        entries = [claim.to_dict() for claim in claims]
        print(json.dumps(entries, indent=2, ensure_ascii=False, allow_nan=False))
    elif args.table:
        print(f'{summary_line(claims)}.\n\n{claims_table(claims, with_reason=False)}')
    else:
        for claim in claims:
            print(f'{claim.verdict.replace("_", " "):40} {claim.id}')
        print(f'\n{summary_line(claims)}\nreport: {args.out / "report.md"}')
    return 0
