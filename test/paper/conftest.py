# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""One run of the study for all tests of the paper."""

from __future__ import annotations

import pickle
from typing import TYPE_CHECKING

from bearing_twin.paper.recompute import judge, prepare_folder, write_results
from bearing_twin.paper.study import run_study, Study
import pytest

if TYPE_CHECKING:
    from pathlib import Path


@pytest.fixture(scope='session')
def study(made_once) -> Study:
    """Return every simulation of the paper."""
    kept = made_once('study', lambda it: it.write_bytes(pickle.dumps(run_study(processes=2))))
    return pickle.loads(kept.read_bytes())


@pytest.fixture(scope='session')
def folder(study, tmp_path_factory) -> Path:
    """Return the folder that the command writes."""
    path = tmp_path_factory.mktemp('paper') / 'out'
    prepare_folder(path)
    write_results(path, study)
    return path


@pytest.fixture(scope='session')
def claims(study) -> dict:
    """Return the claims by id."""
    return {claim.id: claim for claim in judge(study)}
