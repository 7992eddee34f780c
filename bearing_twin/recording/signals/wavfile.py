# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Read the channels of WAV files."""

from __future__ import annotations

from io import BytesIO
from pathlib import Path
from typing import Any
import warnings

from bearing_twin.recording.signals.reading import readable, TORN
import numpy as np


def read_wav(path: Path) -> dict[str, Any]:
    """Return the channels of a WAV file, as ``channel 0``, ``channel 1``, ...: full scale is 1."""
    # Imported when needed: the import of SciPy takes a second.
    from scipy.io import wavfile

    with readable(path, '.wav', 'is it complete, and not compressed?'):
        with warnings.catch_warnings(record=True) as told:
            warnings.simplefilter('always')
            rate, samples = wavfile.read(BytesIO(path.read_bytes()))
        scale, zero = 1.0, 128.0 if samples.dtype == np.uint8 else 0.0
        if samples.dtype.kind in 'iu':
            scale = float(2 ** (8 * samples.dtype.itemsize - 1))
        columns = samples.reshape(samples.shape[0], -1).T
    names = [f'channel {number}' for number in range(len(columns))]
    return {
        **dict(zip(names, columns, strict=True)),
        'fs': rate,
        'each': {name: {'scale': scale, 'zero': zero} for name in names},
        'remark': TORN if any('EOF' in str(warning.message) for warning in told) else '',
    }
