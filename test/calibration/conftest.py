# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
import numpy as np
import pytest


@pytest.fixture(scope='module')
def slot(data_dir):
    """Return a real record of a slot in an inner race, and its sample rate."""
    with np.load(data_dir / 'hitsm' / 'hitsm_sq_IR8_900.npz') as file:
        return file['x'].astype(float), float(file['fs'])
