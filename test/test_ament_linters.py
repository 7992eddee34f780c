# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""The ament linters, where they are installed; ruff holds most of their rules elsewhere."""

from __future__ import annotations

from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]
CHECKED = [
    str(ROOT / name)
    for name in (
        'bearing_twin',
        'docs',
        'launch',
        'msg_defs/build_messages.py',
        'msg_defs/setup.py',
        'setup.py',
        'test',
    )
]
REASON = 'ament_flake8 and ament_pep257 are not installed'


def test_flake8():
    linter = pytest.importorskip('ament_flake8.main', reason=REASON)
    status, errors = linter.main_with_errors(
        argv=['--config', str(ROOT / 'test' / 'flake8.ini'), *CHECKED]
    )
    assert status == 0, '\n'.join(errors)


def test_pep257():
    linter = pytest.importorskip('ament_pep257.main', reason=REASON)
    assert linter.main(argv=CHECKED) == 0
