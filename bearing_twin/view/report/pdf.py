# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Report page as PDF, printed by Chromium or Chrome; no small library draws it as well."""

from __future__ import annotations

from pathlib import Path
import shutil
import subprocess
import tempfile

from bearing_twin.errors import BearingTwinError

BROWSERS = ('chromium', 'chromium-browser', 'google-chrome', 'google-chrome-stable')
TIMEOUT = 120.0
"""Time limit for drawing a page, s."""


def browse(page: str, *arguments: str) -> str:
    """
    Open an HTML page in a browser without a window; return what the browser prints.

    Raises
    ------
    BearingTwinError
        If there is no browser, or it fails.

    """
    browser = next(filter(None, map(shutil.which, BROWSERS)), None)
    if browser is None:
        raise BearingTwinError(
            f'none of {", ".join(BROWSERS)} is installed; on Debian: apt-get install chromium. '
            'Or write .html and print it from any browser'
        )
    with tempfile.TemporaryDirectory(prefix='bearing_twin_page_') as folder:
        source = Path(folder) / 'page.html'
        # The byte order mark tells the browser the encoding if the page does not.
        source.write_text(page, encoding='utf-8-sig')
        command = [browser, '--headless', '--no-sandbox', '--disable-gpu', '--hide-scrollbars']
        command += ['--disable-dev-shm-usage', '--disable-background-networking']
        command += [f'--user-data-dir={folder}/profile', *arguments, source.as_uri()]
        try:
            done = subprocess.run(command, capture_output=True, timeout=TIMEOUT, check=True)
        except (OSError, subprocess.SubprocessError) as error:
            raise BearingTwinError(f'{browser} cannot draw the page: {error}') from None
    return done.stdout.decode(errors='replace')


def pdf_of(page: str) -> bytes:
    """Return an HTML page as PDF; errors as `browse`."""
    with tempfile.TemporaryDirectory(prefix='bearing_twin_pdf_') as folder:
        target = Path(folder) / 'page.pdf'
        browse(page, '--no-pdf-header-footer', f'--print-to-pdf={target}')
        try:
            return target.read_bytes()
        except OSError:
            raise BearingTwinError(
                f'the browser wrote no {target}: one from snap does not see it; set TMPDIR '
                'to a folder in your home, or write .html and print it'
            ) from None
