# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Cases of a test that only ``make proofs`` runs; some that stand beside them are always run."""

import pytest


def in_proofs(*cases):
    """Return cases for ``pytest.mark.parametrize``, a tuple where it names several arguments."""
    each = (case if isinstance(case, tuple) else (case,) for case in cases)
    return [pytest.param(*values, marks=pytest.mark.proof) for values in each]
