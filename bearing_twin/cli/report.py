# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""``bearing-twin report``: a recording as one page, HTML or PDF."""

from __future__ import annotations

import argparse
import json
import os
from pathlib import Path
import tempfile

from bearing_twin.cli.signal_arguments import add_signal_arguments, as_recordings
from bearing_twin.errors import UsageError
from bearing_twin.wholefile import output_file


def configure(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        'recording',
        type=Path,
        help='MCAP file, bag folder, folder of a demo, or a vibration file or Parquet set as '
        'diagnose reads',
    )
    parser.add_argument(
        '-o', '--output', type=Path, help='page to write, .html or .pdf (default: NAME.html here)'
    )
    add_signal_arguments(parser)
    parser.add_argument('--json', action='store_true', help='print what was written as JSON')


def run(args: argparse.Namespace) -> int:
    """Write the page; return 0."""
    output: Path = args.output or Path(f'{_name(args.recording)}.html')
    if output.suffix.lower() not in ('.html', '.htm', '.pdf'):
        msg = f'{output} is not called .html or .pdf; a report never overwrites a recording'
        raise UsageError(msg)
    # Matplotlib takes a second to load; a wrong name is reported before.
    from bearing_twin.view.report.page import report_page
    from bearing_twin.view.report.pdf import pdf_of

    with tempfile.TemporaryDirectory(prefix='bearing_twin_report_') as folder:
        (recording,) = as_recordings([args.recording], args, Path(folder))
        made = Path(folder) in recording.parents
        text = report_page(recording, args.recording if made else None)
    # The name of a recording may be other bytes than UTF-8.
    content = text.encode(errors='backslashreplace')
    page = pdf_of(content.decode()) if output.suffix.lower() == '.pdf' else content
    with output_file(output) as file:
        file.write(page)
    if args.json:
        print(json.dumps({'report': str(output), 'bytes': len(page)}))
    else:
        print(f'{output} ({len(page) / 1e6:.1f} MB)')
    return 0


def _name(recording: Path) -> str:
    """Return the name of a recording; a folder called 'bag' has its parent's."""
    # Unlike Path.resolve, this raises nothing for a loop of links.
    recording = Path(os.path.realpath(recording))
    if not recording.is_dir():
        return recording.stem
    return recording.parent.name if recording.name == 'bag' else recording.name
