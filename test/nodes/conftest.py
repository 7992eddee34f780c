# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Real nodes as processes, and a probe that talks to them."""

from __future__ import annotations

import os

from forked import ForkedNodes
from probe import Probe
import pytest


@pytest.fixture
def probe(ros_domain):
    """Return a probe in the test's own ROS domain."""
    with Probe() as made:
        yield made


@pytest.fixture
def nodes(ros_domain, tmp_path):
    """Return a starter of nodes in the test's own ROS domain."""
    with ForkedNodes(tmp_path / 'logs', os.environ) as processes:
        yield processes
