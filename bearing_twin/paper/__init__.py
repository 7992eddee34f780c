# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Recompute the seed paper and judge its claims."""

from bearing_twin.paper.claims.claim import Claim, Verdict, VERDICTS
from bearing_twin.paper.recompute import recompute
from bearing_twin.paper.report import claims_table, summary_line

__all__ = ['VERDICTS', 'Claim', 'Verdict', 'claims_table', 'recompute', 'summary_line']
