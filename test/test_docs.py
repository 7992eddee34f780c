# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""The docs become pages without a warning, none of them wider than the screen of a laptop."""

import importlib.util
from pathlib import Path
import re
import shutil

from bearing_twin.view.report.pdf import browse, BROWSERS
from commands import python
import pytest

DOCS = Path(__file__).resolve().parents[1] / 'docs'

pytestmark = pytest.mark.skipif(
    not (importlib.util.find_spec('sphinx') and importlib.util.find_spec('myst_parser')),
    reason="Sphinx is not installed ('make release' does)",
)


@pytest.fixture(scope='module')
def pages(tmp_path_factory):
    """Return the folder of the pages."""
    folder = tmp_path_factory.mktemp('docs')
    words = [
        '-m',
        'sphinx',
        '-W',
        '--keep-going',
        '-q',
        '-b',
        'html',
        '-d',
        str(folder / 'work'),
    ]
    built = python(*words, DOCS, folder / 'pages')
    assert built.returncode == 0, built.stderr
    return folder / 'pages'


def test_every_page_and_the_api_are_built_without_a_warning(pages):
    built = {page.stem for page in pages.glob('*.html')}
    assert built >= {page.stem for page in DOCS.glob('*.md')} | {'api'}
    api = (pages / 'api.html').read_text(encoding='utf-8')
    for name in ('bearing.fault_frequencies', 'dynamics.Simulator', 'diagnosis.diagnose_record'):
        assert f'id="bearing_twin.{name}"' in api


@pytest.mark.skipif(not any(map(shutil.which, BROWSERS)), reason='there is no Chromium')
@pytest.mark.parametrize('name', sorted(page.stem for page in DOCS.glob('*.md')))
def test_no_page_scrolls_sideways_on_a_laptop(pages, name):
    page = (pages / f'{name}.html').read_text(encoding='utf-8')
    page = page.replace('<head>', f'<head><base href="{pages.as_uri()}/">')
    page += """<script>onload = () => {
      const boxes = [document.documentElement, ...document.querySelectorAll('pre')];
      document.title = boxes.map((box) => box.scrollWidth - box.clientWidth);
    }</script>"""
    shown = browse(page, '--window-size=1366,768', '--dump-dom')
    excess = re.search(r'<title>([-\d,]+)</title>', shown)[1].split(',')
    assert {int(width) for width in excess} <= {0, 1}
