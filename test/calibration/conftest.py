# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
import pickle

from bearing_twin.calibration import fit
from impact_trains import BEARING
import numpy as np
import pytest


@pytest.fixture(scope='session')
def slot(data_dir):
    """Return a real record of a slot in an inner race, and its sample rate."""
    with np.load(data_dir / 'hitsm' / 'hitsm_sq_IR8_900.npz') as file:
        return file['x'].astype(float), float(file['fs'])


@pytest.fixture(scope='session')
def slot_fit(slot, made_once):
    """Return the fit of that record, once for all tests."""

    def make(file):
        file.write_bytes(pickle.dumps(fit(*slot, BEARING, 15.0, candidates=192)))

    return pickle.loads(made_once('slot_fit', make).read_bytes())
