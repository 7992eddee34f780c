# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Runs of the command for all tests of the paper: a part of the study, and the whole of it."""

from __future__ import annotations

from functools import partial
from pathlib import Path
import pickle
from typing import TYPE_CHECKING

from bearing_twin.paper.recompute import judge
from cases import in_proofs
from commands import python
import pytest

if TYPE_CHECKING:
    from bearing_twin.paper.study import Study

SCRIPT = """
from pathlib import Path
import pickle
import sys
from bearing_twin.cli import main
from bearing_twin.paper import recompute, study
from bearing_twin.paper.space import Space

folder, size = Path(sys.argv[1]), {}
if sys.argv[2] == 'part':
    size['space'] = Space(
        speeds=(25.4,), widths=(0.8e-3, 1.6e-3, 2.8e-3), depths=(15e-6, 80e-6), clearances=(10e-6,)
    )
    size['temperatures'] = (20.0, 100.0, 110.0)

def keep(module, name, **more):
    run = getattr(module, name)
    def kept(*given, **options):
        made = run(*given, **options, **more)
        (folder / name).write_bytes(pickle.dumps((given, made)))
        return made
    setattr(module, name, kept)

keep(study, 'in_parallel')
keep(sys.modules[recompute.__module__], 'run_study', **size)
sys.exit(main(['paper', '--out', str(folder / 'out'), '--jobs', '2', '--json']))
"""
"""
The command, which keeps what it has simulated.

The part has 36 of the 864 settings of the space, and 3 of the 10 temperatures of the frequency
shift, those that claims and figures are about.
"""


def run_command(size: str, folder: Path) -> None:
    folder.mkdir()
    ran = python('-c', SCRIPT, folder, size, timeout=None)
    assert ran.returncode == 0, ran.stderr
    (folder / 'stdout').write_text(ran.stdout, 'utf-8')
    (folder / 'stderr').write_text(ran.stderr, 'utf-8')


@pytest.fixture(scope='session', params=['part', *in_proofs('whole')])
def command(made_once, request) -> Path:
    """Return the folder of a run: what the command writes in ``out``, what it says beside it."""
    return made_once(f'paper-{request.param}', partial(run_command, request.param))


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
