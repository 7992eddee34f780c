# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""The docs become pages without a warning."""

import importlib.util
from pathlib import Path

from commands import python
import pytest

DOCS = Path(__file__).resolve().parents[1] / 'docs'

pytestmark = pytest.mark.skipif(
    not (importlib.util.find_spec('sphinx') and importlib.util.find_spec('myst_parser')),
    reason="Sphinx is not installed ('make release' does)",
)


def test_every_page_and_the_api_are_built_without_a_warning(tmp_path):
    words = [
        '-m',
        'sphinx',
        '-W',
        '--keep-going',
        '-q',
        '-b',
        'html',
        '-d',
        str(tmp_path / 'work'),
    ]
    built = python(*words, DOCS, tmp_path / 'pages')
    assert built.returncode == 0, built.stderr
    pages = {page.stem for page in (tmp_path / 'pages').glob('*.html')}
    assert pages >= {page.stem for page in DOCS.glob('*.md')} | {'api'}
    api = (tmp_path / 'pages' / 'api.html').read_text(encoding='utf-8')
    for name in ('bearing.fault_frequencies', 'dynamics.Simulator', 'diagnosis.diagnose_record'):
        assert f'id="bearing_twin.{name}"' in api
