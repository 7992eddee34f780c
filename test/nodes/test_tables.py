# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""The documented topics, parameters and services are those that the nodes have."""

import difflib
from pathlib import Path
import subprocess
import sys

import pytest

DOCUMENT = Path(__file__).parents[2] / 'docs' / 'nodes.md'
TABLES = DOCUMENT.with_name('tables.py')


@pytest.mark.ros
def test_documented_tables_are_what_the_nodes_have(tmp_path):
    made = tmp_path / 'nodes.md'
    subprocess.run([sys.executable, str(TABLES), str(made)], check=True, timeout=600)
    difference = difflib.unified_diff(
        DOCUMENT.read_text(encoding='utf-8').splitlines(),
        made.read_text(encoding='utf-8').splitlines(),
        'docs/nodes.md',
        'the nodes',
        n=0,
        lineterm='',
    )
    assert not list(difference), "run 'python docs/tables.py docs/nodes.md'"
