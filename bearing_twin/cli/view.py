# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""``bearing-twin view``: recordings and running twins in Rerun."""

from __future__ import annotations

import argparse
import functools
from pathlib import Path
import re
import shutil
import socket
import sys
import tempfile
from urllib.parse import urlsplit

from bearing_twin.cli.arguments import refuse_given
from bearing_twin.cli.signal_arguments import add_signal_arguments, as_recordings, SIGNAL_OPTIONS
from bearing_twin.cli.terminal import percent
from bearing_twin.errors import BearingTwinError, shown, UsageError
from bearing_twin.view.rerun.viewer import HeadlessViewer, live_url, show, show_in_browser
from bearing_twin.view.style import PAGES
from bearing_twin.wholefile import output_file

LARGEST = 4096
"""Largest side of a picture that Rerun draws without a display, pixels."""


def configure(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        'recordings',
        nargs='*',
        type=Path,
        metavar='RECORDING',
        help='MCAP file, bag folder, folder of a demo, .rrd, or a vibration file or Parquet '
        'set as diagnose reads; several stand side by side',
    )
    parser.add_argument(
        '--live',
        nargs='?',
        const='9876',
        metavar='SERVER',
        help='show what a recorder draws now: PORT, ADDRESS:PORT or URL (default 9876)',
    )
    add_signal_arguments(parser)
    parser.add_argument('--web', action='store_true', help='in the browser, without a window')
    parser.add_argument(
        '--web-port', type=int, default=9090, help='port of the page (default 9090; 0: any)'
    )
    parser.add_argument(
        '--address',
        default='127.0.0.1',
        help='address the page is served at (default 127.0.0.1: this machine only)',
    )
    parser.add_argument('--save', type=Path, metavar='RRD', help='keep the Rerun file')
    parser.add_argument(
        '--screenshot', type=Path, metavar='PNG', help='write a picture instead of showing it'
    )
    parser.add_argument(
        '--at', type=float, metavar='SECONDS', help='moment of the picture (default: the end)'
    )
    parser.add_argument(
        '--page', metavar='NAME', default='', choices=PAGES,
        help=f'page in front: {", ".join(PAGES)}',
    )  # fmt: skip
    parser.add_argument(
        '--size', default='1800x1100', help='of the picture, WIDTHxHEIGHT (default 1800x1100)'
    )


def run(args: argparse.Namespace) -> int:
    """Show; return 0 once it is shown. Topics that cannot be drawn are named on stderr."""
    if bool(args.live) == bool(args.recordings):
        raise UsageError('name a recording, or --live for what is running')
    if args.live and args.save:
        msg = '--save keeps recordings only; a recorder keeps what is live with -p rerun_file:=RRD'
        raise UsageError(msg)
    if args.live:
        why = 'not with --live, where the recorder decides'
        refuse_given(args, ('page', *SIGNAL_OPTIONS), why)
    if args.screenshot:
        refuse_given(args, ('web',), 'not with --screenshot, which shows nothing')
    else:
        refuse_given(args, ('at', 'size'), 'only with --screenshot')
    if not args.web:
        refuse_given(args, ('web_port', 'address'), 'only with --web')
    with tempfile.TemporaryDirectory(prefix='bearing_twin_view_') as folder:
        sources = [_server(args.live)] if args.live else _sources(args, Path(folder))
        if args.screenshot:
            return _screenshot(args, sources, Path(folder))
        if args.web:
            return show_in_browser(
                sources,
                address=args.address,
                web_port=args.web_port,
                announce=lambda url: print(f'{url}\nend with Ctrl-C', flush=True),
            )
        if args.save:
            return 0
        return show(sources)


def _server(text: str) -> str:
    """Return the URL of the requested server; raise if nothing listens there."""
    url = live_url(text)
    address = urlsplit(url)
    host, port = address.hostname or '127.0.0.1', address.port or 9876
    try:
        socket.create_connection((host, port), timeout=2.0).close()
    except (OSError, UnicodeError) as error:
        # A name with an empty part, or one that is too long, is a UnicodeError.
        why = getattr(error, 'strerror', None) or error
        raise BearingTwinError(
            f'no Rerun server at {host}:{port} ({why}); start a recorder with '
            f"'-p rerun_port:={port}', or name the address of one: --live ADDRESS:PORT"
        ) from None
    return url


def _sources(args: argparse.Namespace, folder: Path) -> list[str]:
    # Imported here: it takes seconds to load, and a missing server is reported before.
    from bearing_twin.view.rerun.opening import draw_recordings

    paths = as_recordings(args.recordings, args, folder)
    pictures = [path for path in paths if path.suffix == '.rrd']
    if pictures and len(paths) > 1:
        msg = f'{pictures[0]} is a picture; only MCAP recordings can be shown side by side'
        raise UsageError(msg)
    if args.save and args.save.exists():
        raise BearingTwinError(f'{args.save} exists and is not overwritten; name another file')
    if pictures:
        refuse_given(args, ('page',), 'not for .rrd, whose pages are in order already')
        if args.save:
            _copy(pictures[0], args.save)
        return [str(pictures[0])]
    # A fixed name: the viewer shows it while it loads, and may lack letters of the recording's.
    rrd = folder / 'recording.rrd'
    progress = functools.partial(percent, what='drawing ') if sys.stderr.isatty() else None
    try:
        problems = draw_recordings(paths, rrd, page=args.page, progress=progress)
    except RuntimeError as error:
        # Rerun's writer has failed: the disk of the temporary folder may be full.
        msg = f'the picture cannot be drawn to {folder}: {error}; is that disk full?'
        raise BearingTwinError(msg) from None
    for topic, reason in problems.items():
        print(f'{shown(topic)} is not drawn: {shown(reason)}', file=sys.stderr)
    if args.save:
        _copy(rrd, args.save)
    return [str(rrd)]


def _copy(source: Path, target: Path) -> None:
    with source.open('rb') as drawn, output_file(target) as file:
        shutil.copyfileobj(drawn, file)


def _screenshot(args: argparse.Namespace, sources: list[str], folder: Path) -> int:
    size = re.fullmatch(r'([0-9]{2,4})x([0-9]{2,4})', args.size)
    width, height = map(int, size.groups()) if size else (0, 0)
    if not (10 <= width <= LARGEST and 10 <= height <= LARGEST):
        msg = f'--size {args.size!r}: give WIDTHxHEIGHT, each 10 to {LARGEST}, e.g. 1800x1100'
        raise UsageError(msg)
    with HeadlessViewer(sources, size=(width, height)) as viewer:
        viewer.wait(args.at)
        viewer.screenshot(folder / 'picture.png')
    _copy(folder / 'picture.png', args.screenshot)
    return 0
