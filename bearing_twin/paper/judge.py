# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""All claims, judged."""

from __future__ import annotations

from typing import TYPE_CHECKING

from bearing_twin.paper.claims_frequency import frequency_claims
from bearing_twin.paper.claims_general import general_claims
from bearing_twin.paper.claims_material import material_claims
from bearing_twin.paper.claims_model import model_claims
from bearing_twin.paper.claims_peaks import peak_claims
from bearing_twin.paper.claims_shift import shift_claims
from bearing_twin.paper.claims_trend import trend_claims

if TYPE_CHECKING:
    from bearing_twin.paper.claims import Claim
    from bearing_twin.paper.study import Study


def judge(study: Study) -> list[Claim]:
    """Return every claim with its verdict, in the order of the report."""
    return [
        *frequency_claims(study),
        *shift_claims(study),
        *peak_claims(study),
        *trend_claims(study),
        *general_claims(study),
        *material_claims(),
        *model_claims(study),
    ]
