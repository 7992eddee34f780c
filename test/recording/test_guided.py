# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Coverage-guided fuzzing of everything that reads input from outside; run by make fuzz."""

from __future__ import annotations

from typing import TYPE_CHECKING

from fuzzing import SECONDS
from guided import guided, KINDS
import pytest

if TYPE_CHECKING:
    from pathlib import Path


@pytest.mark.fuzz
@pytest.mark.parametrize('kind', KINDS)
def test_guided_by_coverage(kind: str, tmp_path: Path) -> None:
    pytest.importorskip('atheris', reason='atheris cannot be installed here: see make fuzz')
    found = guided(kind, int(SECONDS), tmp_path)
    print(f'{kind}: {found}')
    # It has run at all, and has been guided: it knows more ways through the code than the seeds.
    assert found.runs > 100
    assert found.edges >= found.edges_at_start > 50
