# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Mutated files: a clear error, never a traceback, a hang, a crash or memory without bound.

BEARING_TWIN_FUZZ sets the number of files of each kind (``make fuzz``: 10000).
"""

from __future__ import annotations

import os
from typing import TYPE_CHECKING

import pytest
from fuzzing import KINDS, fuzz

if TYPE_CHECKING:
    from pathlib import Path

COUNT = int(os.environ.get('BEARING_TWIN_FUZZ', '150'))
SEED = int(os.environ.get('BEARING_TWIN_FUZZ_SEED', '1'))
MOST_MEMORY = 512 * 1024 * 1024
"""Memory that reading a damaged file of a few kB may take beyond that of a sound one, bytes."""


@pytest.mark.parametrize('kind', KINDS)
def test_mutated_files(kind: str, tmp_path: Path) -> None:
    result = fuzz(kind, COUNT, SEED, tmp_path)
    assert not result['failures'], '\n'.join(result['failures'])
    assert result['memory'] < MOST_MEMORY
    print(f'{kind}: {COUNT} files, longest {result["longest"]:.2f} s, {result["memory"]} bytes')
    # Nothing was written but the seeds, the file itself and what recover was told to write.
    allowed = {f'a.{kind}', 'out', 'zstd.mcap', 'lz4.mcap', 'none.mcap'}
    assert set(result['files']) <= allowed | {'openTrue.mcap', 'openFalse.mcap'}
