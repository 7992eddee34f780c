# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""What the tests share: the real recordings, and a ROS domain of one's own."""

from __future__ import annotations

import contextlib
import fcntl
import gc
import itertools
import json
import os
from pathlib import Path
import signal
from tempfile import TemporaryDirectory

from hypothesis import HealthCheck, settings
import psutil
import pytest

HERE = Path(__file__).resolve().parent
FOREIGN = (
    'FASTDDS_BUILTIN_TRANSPORTS',
    'FASTDDS_DEFAULT_PROFILES_FILE',
    'FASTRTPS_DEFAULT_PROFILES_FILE',
    'ROS_DISCOVERY_SERVER',
    'ROS_LOCALHOST_ONLY',
    'ROS_STATIC_PEERS',
)
"""What a user may have set that reaches beyond this machine, or ties ROS to parts of it."""

# What a script runs in the background ignores Ctrl-C, and so would all that the tests start.
if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:
    signal.signal(signal.SIGINT, signal.default_int_handler)


def _end_all(*_: object) -> None:
    """End what the tests have started, the nodes of a demo among them: it outlives them else."""
    for process in psutil.Process().children(recursive=True):
        with contextlib.suppress(psutil.NoSuchProcess):
            process.terminate()
    raise KeyboardInterrupt


signal.signal(signal.SIGTERM, _end_all)
# A forked process ends itself only.
os.register_at_fork(after_in_child=lambda: signal.signal(signal.SIGTERM, signal.SIG_DFL))

# Libraries make hundreds of thousands of objects that stay. To look for garbage among them while
# they are loaded takes a third of that time, and does so again in the tests.
gc.disable()

# How long an example takes says how busy the machine is.
settings.register_profile('untimed', deadline=None, suppress_health_check=[HealthCheck.too_slow])
settings.load_profile('untimed')


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """
    Put the files with real nodes evenly among the others: those wait while these compute.

    The processes of ``pytest -n`` take file after file in this order. That of the viewer takes
    longest and is the first, so that no process is left with it in the end.
    """
    files: dict[Path, list[pytest.Item]] = {}
    for item in items:
        files.setdefault(item.path, []).append(item)
    kinds: dict[bool, list[Path]] = {True: [], False: []}
    for path, tests in files.items():
        kinds[any(test.get_closest_marker('ros') for test in tests)].append(path)
    places = {p: (k + 0.5) / len(some) for some in kinds.values() for k, p in enumerate(some)}
    items.sort(key=lambda i: (i.get_closest_marker('vulkan') is None, places[i.path]))


@pytest.hookimpl(tryfirst=True)
def pytest_runtestloop() -> None:
    """Look for garbage from now on, and not among what the tests have loaded."""
    from bearing_twin.process import begin_collection

    begin_collection()


@pytest.fixture(scope='session')
def data_dir() -> Path:
    """Folder of the real recordings: BEARING_TWIN_DATA, or ../shared/data beside the checkout."""
    folder = Path(os.environ.get('BEARING_TWIN_DATA', HERE.parents[1] / 'shared' / 'data'))
    if not (folder / 'index.json').exists():
        pytest.skip(f'the real recordings are not in {folder}; set BEARING_TWIN_DATA')
    return folder


@pytest.fixture(scope='session')
def made_once(tmp_path_factory):
    """Return a function that gives what the first of the processes of ``pytest -n`` has made."""
    folder = tmp_path_factory.getbasetemp()
    if 'PYTEST_XDIST_WORKER' in os.environ:
        folder = folder.parent

    def give(name, make):
        target = folder / name
        target.parent.mkdir(exist_ok=True)
        with target.with_suffix('.lock').open('w') as lock:
            fcntl.flock(lock, fcntl.LOCK_EX)
            if not target.exists():
                # What is cut off half made, or fails, is not taken for made.
                with TemporaryDirectory(dir=target.parent) as beside:
                    half = Path(beside) / target.name
                    make(half)
                    half.rename(target)
        return target

    return give


@pytest.fixture(scope='session')
def turns():
    """Count the tests that ask for a ROS domain: each begins to look for one a step further."""
    return itertools.count(os.getpid())


@pytest.fixture(scope='session')
def compiled():
    """Have the kernels of twin and fleet in the cache: a node's first start compiles for long."""
    from bearing_twin.dynamics import preset, Simulator
    from bearing_twin.dynamics.fleet.fleet import Fleet

    Simulator(preset('incipient')).advance(1024, 20.0, 25.0)
    fleet = Fleet([preset('incipient')])
    fleet.advance(1024, 20.0, 25.0)
    fleet.condition(0)


@pytest.fixture(scope='session')
def reference(made_once):
    """Have the reference solver in the cache, compiled by one of the processes."""
    from bearing_twin.dynamics import preset
    from bearing_twin.dynamics.reference import solve

    def make(file):
        solve(preset('paper'), 1)
        file.touch()

    made_once('reference', make)


@pytest.fixture
def ros_domain(compiled, turns, monkeypatch, tmp_path):
    """Give the test a domain, a log folder and a home of its own, on this machine only."""
    from bearing_twin.ros.processes.domain import own_domain

    monkeypatch.setenv('ROS_AUTOMATIC_DISCOVERY_RANGE', 'LOCALHOST')
    for name in FOREIGN:
        monkeypatch.delenv(name, raising=False)
    monkeypatch.setenv('ROS_HOME', str(tmp_path / 'ros_home'))
    monkeypatch.setenv('ROS_LOG_DIR', str(tmp_path / 'ros_log'))
    # Every message that the nodes fill is checked field by field.
    monkeypatch.setenv('ROS_PYTHON_CHECK_FIELDS', '1')
    with own_domain(next(turns), listen=0.0) as domain:
        monkeypatch.setenv('ROS_DOMAIN_ID', str(domain))
        yield domain


@pytest.fixture
def here(ros_domain):
    """
    Return a maker of nodes in this process, which end with the test.

    The parameters are those of the first node, which all have.
    """
    import rclpy

    made = []

    def make(node_class, **parameters):
        if not rclpy.ok():
            given = (f'{name}:={json.dumps(value)}' for name, value in parameters.items())
            rclpy.init(args=['--ros-args', *(word for each in given for word in ('-p', each))])
        made.append(node_class())
        return made[-1]

    yield make
    for node in made:
        node.shut_down()
    rclpy.try_shutdown()
