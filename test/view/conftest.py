# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
from pathlib import Path

import pytest

SCHEDULE = Path(__file__).resolve().parents[2] / 'recordings' / 'paper_schedule.mcap'


@pytest.fixture(scope='session')
def recording(tmp_path_factory):
    """Return a recording of twin and diagnosis over the paper's schedule."""
    pytest.importorskip('bearing_twin_msgs', reason='the message package is not built')
    from bearing_twin.offline.run import run_offline

    target = tmp_path_factory.mktemp('view') / 'inner'
    run_offline(SCHEDULE, target, twin={'defect': 'inner', 'preset': 'incipient', 'waviness': 0.0})
    return target
