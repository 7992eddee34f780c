# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
from pathlib import Path

import pytest

SCHEDULE = Path(__file__).resolve().parents[2] / 'recordings' / 'paper_schedule.mcap'


@pytest.fixture(scope='session')
def scheduled(made_once):
    """Return a maker of recordings over the paper's schedule."""
    pytest.importorskip('bearing_twin_msgs', reason='the message package is not built')
    from bearing_twin.offline.run import run_offline

    def make(**twin):
        name = f'{" ".join(map(str, twin.values()))}/{twin["defect"]}'
        return made_once(name, lambda target: run_offline(SCHEDULE, target, twin=twin))

    return make


@pytest.fixture(scope='session')
def recording(scheduled):
    """Return a recording of twin and diagnosis over the paper's schedule."""
    return scheduled(defect='inner', preset='incipient', waviness=0.0)


@pytest.fixture
def undrawn(monkeypatch):
    """Make the figures of a page without drawing them, for tests that read only its words."""
    monkeypatch.setattr(
        'bearing_twin.view.report.plots.svg_element',
        lambda _, prefix: f'<svg id="{prefix}"></svg>',
    )
