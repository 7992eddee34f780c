# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Mutated files: a clear error, never a traceback, a hang, a crash or memory without bound."""

from __future__ import annotations

import random
from typing import TYPE_CHECKING

from fuzzing import fuzz, KINDS
import pytest

if TYPE_CHECKING:
    from pathlib import Path

MOST_MEMORY = 512 * 1024 * 1024
"""Memory that reading a damaged file of a few kB may take beyond that of a sound one, bytes."""


def check(kind: str, count: int, seed: int, folder: Path) -> None:
    result = fuzz(kind, count, seed, folder)
    assert not result['failures'], '\n'.join(result['failures'])
    assert result['memory'] < MOST_MEMORY
    print(
        f'{kind}: {count} files of seed {seed}, longest {result["longest"]:.2f} s, '
        f'{result["memory"]} bytes more than sound ones'
    )
    # Nothing was written but the seeds, the file itself and what recover was told to write.
    allowed = {f'a.{kind}', 'out', 'zstd.mcap', 'lz4.mcap', 'none.mcap'}
    assert set(result['files']) <= allowed | {'openTrue.mcap', 'openFalse.mcap'}


@pytest.mark.parametrize('kind', KINDS)
def test_mutated_files(kind: str, tmp_path: Path) -> None:
    check(kind, 150, 1, tmp_path)


@pytest.mark.fuzz
@pytest.mark.parametrize('kind', KINDS)
def test_ten_thousand_mutated_files(kind: str, tmp_path: Path) -> None:
    check(kind, 10_000, random.SystemRandom().randrange(2**32), tmp_path)
