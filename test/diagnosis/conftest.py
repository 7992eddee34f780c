# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
from bearing_twin.bench.diagnosis import fault_signal, RATE, SHAFT_HZ
import numpy as np
import pytest


@pytest.fixture(scope='session')
def good(tmp_path_factory):
    """Return an npz file of an inner race fault of a 6307."""
    path = tmp_path_factory.mktemp('good') / 'inner.npz'
    np.savez(path, x=fault_signal(4.0), fs=RATE, rpm=60.0 * SHAFT_HZ)
    return path


@pytest.fixture
def rng(request):
    """Return random numbers from the seed of a file of tests, or from 3."""
    return np.random.default_rng(getattr(request.module, 'SEED', 3))
