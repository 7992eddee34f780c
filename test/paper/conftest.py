# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""One run of the command for all tests of the paper."""

from __future__ import annotations

import pickle
from typing import TYPE_CHECKING

from bearing_twin.paper.recompute import judge
from commands import python
import pytest

if TYPE_CHECKING:
    from pathlib import Path

    from bearing_twin.paper.study import Study

SCRIPT = """
from pathlib import Path
import pickle
import sys
from bearing_twin.cli import main
from bearing_twin.paper import recompute, study

folder = Path(sys.argv[1])

def keep(module, name):
    run = getattr(module, name)
    def kept(*given, **options):
        made = run(*given, **options)
        (folder / name).write_bytes(pickle.dumps((given, made)))
        return made
    setattr(module, name, kept)

keep(study, 'in_parallel')
keep(sys.modules[recompute.__module__], 'run_study')
sys.exit(main(['paper', '--out', str(folder / 'out'), '--processes', '2', '--json']))
"""
"""The command, which keeps what it has simulated."""


def run_command(folder: Path) -> None:
    folder.mkdir()
    ran = python('-c', SCRIPT, folder, timeout=None)
    assert ran.returncode == 0, ran.stderr
    (folder / 'stdout').write_text(ran.stdout, 'utf-8')
    (folder / 'stderr').write_text(ran.stderr, 'utf-8')


@pytest.fixture(scope='session')
def command(made_once) -> Path:
    """Return the folder of a run: what the command writes in ``out``, what it says beside it."""
    return made_once('paper', run_command)


@pytest.fixture(scope='session')
def folder(command) -> Path:
    """Return the folder that the command writes."""
    return command / 'out'


@pytest.fixture(scope='session')
def study(command) -> Study:
    """Return every simulation of the paper."""
    return pickle.loads((command / 'run_study').read_bytes())[1]


@pytest.fixture(scope='session')
def claims(study) -> dict:
    """Return the claims by id."""
    return {claim.id: claim for claim in judge(study)}
