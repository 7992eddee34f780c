# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
import fcntl
import os
from pathlib import Path

import pytest

SCHEDULE = Path(__file__).resolve().parents[2] / 'recordings' / 'paper_schedule.mcap'


@pytest.fixture(scope='session')
def scheduled(tmp_path_factory):
    """Return a maker of recordings over the paper's schedule, each made once for all processes."""
    pytest.importorskip('bearing_twin_msgs', reason='the message package is not built')
    from bearing_twin.offline.run import run_offline

    folder = tmp_path_factory.getbasetemp()
    if 'PYTEST_XDIST_WORKER' in os.environ:
        folder = folder.parent

    def make(**twin):
        target = folder / ' '.join(map(str, twin.values())) / twin['defect']
        target.parent.mkdir(exist_ok=True)
        with target.with_suffix('.lock').open('w') as lock:
            fcntl.flock(lock, fcntl.LOCK_EX)
            if not target.exists():
                run_offline(SCHEDULE, target, twin=twin)
        return target

    return make


@pytest.fixture(scope='session')
def recording(scheduled):
    """Return a recording of twin and diagnosis over the paper's schedule."""
    return scheduled(defect='inner', preset='incipient', waviness=0.0)
