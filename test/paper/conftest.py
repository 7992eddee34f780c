# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""One run of the study for all tests of the paper."""

from __future__ import annotations

import pickle
from typing import TYPE_CHECKING

from bearing_twin.paper.recompute import judge
from bearing_twin.paper.study import run_study, Study
from commands import python
import pytest

if TYPE_CHECKING:
    from pathlib import Path
    from subprocess import CompletedProcess


@pytest.fixture(scope='session')
def study(made_once) -> Study:
    """Return every simulation of the paper."""
    kept = made_once('study', lambda it: it.write_bytes(pickle.dumps(run_study(processes=2))))
    return pickle.loads(kept.read_bytes())


@pytest.fixture(scope='session')
def command(tmp_path_factory) -> tuple[Path, CompletedProcess[str]]:
    """Return the folder that the command writes with one process, and what it says."""
    out = tmp_path_factory.mktemp('paper') / 'out'
    words = '--out', str(out), '--processes', '1', '--json'
    ran = python('-m', 'bearing_twin', 'paper', *words, timeout=None)
    assert ran.returncode == 0, ran.stderr
    return out, ran


@pytest.fixture(scope='session')
def folder(command) -> Path:
    """Return the folder that the command writes."""
    return command[0]


@pytest.fixture(scope='session')
def claims(study) -> dict:
    """Return the claims by id."""
    return {claim.id: claim for claim in judge(study)}
