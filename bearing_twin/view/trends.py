# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Quantities over time: what the viewer and the report plot of a message. One line a quantity."""

from __future__ import annotations

from dataclasses import dataclass
import math
from typing import Any, NamedTuple, TYPE_CHECKING

from bearing_twin.diagnosis.thresholds import INDEX_FAULT, Z_FAULT
from bearing_twin.view.style import Colour, FAMILIES, LINE

if TYPE_CHECKING:
    from collections.abc import Callable

__all__ = ['DIAGNOSIS', 'TWIN_STATE', 'Limit', 'Panel', 'Trend']


class Trend(NamedTuple):
    """One quantity as it is plotted."""

    key: str
    """Name of its entity."""
    label: str
    """Name and unit."""
    colour: Colour
    value: Callable[[Any], float]
    """From a message; NaN where the quantity does not exist."""


class Limit(NamedTuple):
    """A level that decides."""

    label: str
    value: float


@dataclass(frozen=True)
class Panel:
    """Quantities that share an axis."""

    key: str
    title: str
    """With the unit, where all quantities share one."""
    trends: tuple[Trend, ...]
    limit: Limit | None = None
    from_zero: bool = False


def _per_family(field: str) -> tuple[Trend, ...]:
    """Return the elements of a field with one element a fault family."""

    def element(k: int) -> Callable[[Any], float]:
        def value(diagnosis: Any) -> float:
            values = getattr(diagnosis, field)
            return float(values[k]) if k < len(values) else math.nan

        return value

    return tuple(
        Trend(family.key, family.label, family.colour, element(k))
        for k, family in enumerate(FAMILIES)
    )


TWIN_STATE = (
    Panel(
        'temperature',
        'Temperature [°C]',
        (
            Trend('used', 'used by the twin', LINE['used'], lambda s: s.temperature_used),
            Trend('inner_ring', 'inner ring', LINE['fourth'], lambda s: s.inner_ring_temperature),
        ),
    ),
    Panel(
        'beta0',
        'beta0, on stiffness and defect depth [1]',
        (Trend('beta0', 'beta0', LINE['first'], lambda s: s.beta0),),
    ),
    Panel(
        'stiffness',
        'Contact stiffness K_b [1e9 N/m^1.5]',
        (Trend('k_b', 'K_b', LINE['second'], lambda s: 1e-9 * s.k_b),),
    ),
    Panel(
        'depth',
        'Defect depth C_d [µm]',
        (Trend('c_d', 'C_d', LINE['third'], lambda s: 1e6 * s.c_d),),
    ),
    Panel(
        'kappa',
        'Viscosity ratio kappa [1]',
        (Trend('kappa', 'kappa', LINE['fourth'], lambda s: s.kappa),),
    ),
    Panel(
        'real_time',
        'Real time [ms], blocks',
        (
            Trend('lateness', 'late [ms]', LINE['third'], lambda s: 1e3 * s.lateness),
            Trend('execution', 'computing [ms]', LINE['first'], lambda s: 1e3 * s.execution_time),
            Trend('late', 'late blocks', LINE['fourth'], lambda s: s.blocks_late),
            Trend('dropped', 'dropped blocks', LINE['measured'], lambda s: s.blocks_dropped),
        ),
    ),
)
"""Of a TwinState."""

DIAGNOSIS = (
    Panel(
        'significance',
        'Significance [standard deviations over noise]',
        _per_family('score'),
        Limit(f'fault above {Z_FAULT:g}', Z_FAULT),
    ),
    Panel(
        'modulation',
        'Modulation index [1]',
        _per_family('modulation_index'),
        Limit(f'fault above {INDEX_FAULT:g}', INDEX_FAULT),
        from_zero=True,
    ),
    Panel(
        'level',
        'Vibration level, rms',
        (Trend('rms', 'rms [unit]', LINE['first'], lambda d: d.rms),),
        from_zero=True,
    ),
    Panel(
        'velocity',
        'Velocity 10 to 1000 Hz [mm/s rms]',
        (Trend('velocity_rms', 'velocity', LINE['second'], lambda d: d.velocity_rms),),
        from_zero=True,
    ),
    Panel(
        'baseline',
        'Level over its own baseline [dB]',
        (Trend('baseline', 'over baseline', LINE['third'], lambda d: d.level_over_baseline),),
    ),
    Panel(
        'shape',
        'Kurtosis, crest factor [1]',
        (
            Trend('kurtosis', 'kurtosis', LINE['fourth'], lambda d: d.kurtosis),
            Trend('crest_factor', 'crest factor', LINE['second'], lambda d: d.crest_factor),
        ),
    ),
)
"""Of a Diagnosis."""
