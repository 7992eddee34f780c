# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""What the tests share: the real recordings, and a ROS domain of one's own."""

from __future__ import annotations

import json
import os
from pathlib import Path
import socket

import pytest

HERE = Path(__file__).resolve().parent


@pytest.fixture(scope='session')
def data_dir() -> Path:
    """Folder of the real recordings: BEARING_TWIN_DATA, or ../shared/data beside the checkout."""
    folder = Path(os.environ.get('BEARING_TWIN_DATA', HERE.parents[1] / 'shared' / 'data'))
    if not (folder / 'index.json').exists():
        pytest.skip(f'the real recordings are not in {folder}; set BEARING_TWIN_DATA')
    return folder


@pytest.fixture(scope='session')
def data_index(data_dir: Path) -> dict:
    """Labels, speeds, geometry and grades of the real recordings."""
    return json.loads((data_dir / 'index.json').read_text())


@pytest.fixture(scope='session')
def domain_ids():
    """
    Return ROS domains in which nobody is, each handed out once.

    Domains up to 101 keep clear of other ports.
    """
    start = os.getpid() % 90
    return (domain for k in range(100) if _deserted(domain := 1 + (start + k) % 100))


def _deserted(domain: int) -> bool:
    """
    Tell whether no process of this machine is in a ROS domain: it would hold one of its ports.

    RTPS 2.5, section 9.6.2.3: 7400 + 250 domain for all, 10 + 2 k above it for the k-th of them.
    """
    first = 7400 + 250 * domain
    for port in (first, *range(first + 10, first + 42, 2)):
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
            try:
                probe.bind(('', port))
            except OSError:
                return False
    return True


@pytest.fixture
def ros_domain(domain_ids, monkeypatch, tmp_path) -> int:
    """Give the test a domain, a log folder and a home of its own, on this machine only."""
    domain = next(domain_ids)
    monkeypatch.setenv('ROS_DOMAIN_ID', str(domain))
    monkeypatch.setenv('ROS_AUTOMATIC_DISCOVERY_RANGE', 'LOCALHOST')
    monkeypatch.setenv('ROS_HOME', str(tmp_path / 'ros_home'))
    monkeypatch.setenv('ROS_LOG_DIR', str(tmp_path / 'ros_log'))
    # Every message that the nodes fill is checked field by field.
    monkeypatch.setenv('ROS_PYTHON_CHECK_FIELDS', '1')
    return domain
