# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""One file to diagnose, as it is sent to another process."""

from __future__ import annotations

from dataclasses import dataclass, field
import math
from typing import TYPE_CHECKING

from bearing_twin.diagnosis.settings import DiagnosisSettings

if TYPE_CHECKING:
    from bearing_twin.bearing import Bearing


CARD = 'card'
"""Key of an answer's rows for people, which are not in its JSON."""
DRAWN = 'drawn'
"""Key that tells whether the picture was drawn that was asked for; not in the JSON either."""


@dataclass(frozen=True, kw_only=True)
class Task:
    """One file and how to read it; small and picklable, so that it can be sent anywhere."""

    path: str
    bearing: Bearing | None = None
    shaft_hz: float = math.nan
    speed_tolerance: float | None = None
    sample_rate: float | None = None
    channel: str | None = None
    unit: str = ''
    settings: DiagnosisSettings = field(default_factory=DiagnosisSettings)
    plot: str = ''
    """File for the picture; empty for none."""
