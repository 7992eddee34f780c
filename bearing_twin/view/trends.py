# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Quantities over time that the viewer and the report plot, one line per quantity."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
import math
from typing import Any, NamedTuple

from bearing_twin.diagnosis.machine.level import FAULT_DB, SUSPECT_DB
from bearing_twin.diagnosis.signal.severity import ISO_LIMITS, least_limits
from bearing_twin.diagnosis.thresholds import INDEX_FAULT, INDEX_SUSPECT, Z_CAGE, Z_FAULT
from bearing_twin.view.style import Colour, FAMILIES, LINE
import numpy as np


def element(values: Sequence[float], index: int) -> float:
    """
    Return an element of a list of numbers of a message; NaN if the list is shorter.

    Examples
    --------
    >>> element([7.0], 0), element([], 0)
    (7.0, nan)

    """
    return float(values[index]) if index < len(values) else math.nan


class Trend(NamedTuple):
    """One plotted quantity."""

    key: str
    """Name of its entity."""
    label: str
    """Name and unit."""
    colour: Colour
    field: str
    """Field of the message."""
    scale: float = 1.0
    """Factor from the unit of the message to that of the label."""
    element: int | None = None
    """Element of a field that is a list."""
    other: tuple[str, float] = ('', 1.0)
    """Another field with its scale: the lower of the two is plotted."""

    @property
    def named(self) -> str:
        """Label and name of the colour."""
        return f'{self.label} {next(name for name in LINE if LINE[name] == self.colour)}'

    def value(self, message: Any) -> float:
        """Return the plotted value of a message; NaN if the quantity does not exist."""
        value = self.scale * self._number(message, self.field)
        field, scale = self.other
        if not field:
            return value
        # min() of a number and NaN may be the number, but the lower one is then not known.
        return float(np.minimum(value, scale * self._number(message, field)))

    def _number(self, message: Any, field: str) -> float:
        value = getattr(message, field)
        return float(value) if self.element is None else element(value, self.element)


class Limit(NamedTuple):
    """A limit in a panel."""

    label: str
    value: float
    mark: str = ''
    """Text at its right end in the report."""
    look: str = 'limit'
    """Name of its colour."""


ZERO = Limit('zero', 0.0, look='ground')


def zone_limits(power_group: object = 0, mounting: object = '') -> tuple[Limit, ...]:
    """
    Return the velocities in mm/s above which a machine is at least in a zone of ISO 20816-3.

    If group or mounting is not known: only the limits of zones C and D.

    Examples
    --------
    >>> [(limit.mark, limit.value) for limit in zone_limits(2, 'rigid')]
    [('B', 1.4), ('C', 2.8), ('D', 4.5)]
    >>> [limit.label for limit in zone_limits()]
    ['zone C of every machine above 7.1', 'zone D of every machine above 11']

    """
    # Compared, not looked up: values in a recording may be unhashable.
    if not any(power_group in (0, group) and mounting in ('', m) for group, m in ISO_LIMITS):
        power_group, mounting = 0, ''
    of = '' if power_group or mounting else ' of every machine'
    limits = zip('BCD', least_limits(power_group, mounting), strict=True)
    return tuple(
        Limit(f'zone {zone}{of} above {value:g}', value, zone)
        for zone, value in limits
        if zone != 'B' or (power_group and mounting)
    )


@dataclass(frozen=True)
class Panel:
    """Quantities that share an axis."""

    key: str
    title: str
    """Title with the unit if all quantities share it; ``[unit]`` is that of the message."""
    trends: tuple[Trend, ...]
    """If the first has no values there is no panel: the others only supplement it."""
    limits: tuple[Limit, ...] = ()
    from_zero: bool = False
    band: tuple[str, ...] = ()
    """Keys of the two quantities between which the report fills the area."""

    @property
    def other_trends(self) -> tuple[Trend, ...]:
        """Quantities that a title has to name, since it is that of the first."""
        others = () if self.band else self.trends[1:]
        return tuple(trend for trend in others if trend.field not in PER_FAMILY)

    @property
    def named(self) -> str:
        """Title with name and colour of these quantities: a legend would cover lines."""
        return ', '.join([self.title, *(trend.named for trend in self.other_trends)])


PER_FAMILY = ('score', 'modulation_index')
"""Fields with one element per fault family, whose colours are the same everywhere."""


def _per_family(field: str) -> tuple[Trend, ...]:
    """Return the trends of a field with one element per fault family."""
    return tuple(
        Trend(family.key, family.label, family.colour, field, element=k)
        for k, family in enumerate(FAMILIES)
    )


def _one(
    key: str, title: str, colour: str, field: str, scale: float = 1.0, *, from_zero: bool = False
) -> Panel:
    """Return a panel of one quantity."""
    trend = Trend(field, title.partition(' [')[0], LINE[colour], field, scale)
    return Panel(key, title, (trend,), from_zero=from_zero)


TWIN_STATE = (
    Panel(
        'temperature',
        'Temperature [°C]',
        (
            Trend('used', 'used by the twin', LINE['orange'], 'temperature_used'),
            Trend('inner_ring', 'inner ring', LINE['violet'], 'inner_ring_temperature'),
        ),
    ),
    _one('beta0', 'beta0, on stiffness and defect depth [1]', 'blue', 'beta0'),
    _one('stiffness', 'Contact stiffness K_b [1e9 N/m^1.5]', 'green', 'k_b', 1e-9),
    _one('depth', 'Defect depth C_d [µm]', 'orange', 'c_d', 1e6),
    _one('kappa', 'Viscosity ratio kappa [1]', 'violet', 'kappa'),
    Panel(
        'real_time',
        'Late [ms]',
        (
            Trend('lateness', 'late', LINE['orange'], 'lateness', 1e3),
            Trend('execution', 'computing', LINE['blue'], 'execution_time', 1e3),
            Trend('late', 'late blocks', LINE['violet'], 'blocks_late'),
            Trend('dropped', 'dropped blocks', LINE['red'], 'blocks_dropped'),
        ),
        from_zero=True,
    ),
)
"""Panels of a TwinState."""

OVER_LIMITS = Panel(
    'over_limits',
    'Evidence over its limits [1]',
    tuple(
        Trend(
            family.key,
            family.label,
            family.colour,
            'score',
            1.0 / (Z_CAGE if family.key == 'cage' else Z_FAULT),
            element=k,
            other=('modulation_index', 1.0 / INDEX_FAULT),
        )
        for k, family in enumerate(FAMILIES)
    ),
    (
        Limit('fault above 1', 1.0),
        Limit(
            f'suspect above {INDEX_SUSPECT / INDEX_FAULT:g} where significant',
            INDEX_SUSPECT / INDEX_FAULT,
            look='remark',
        ),
    ),
    from_zero=True,
)
"""Panel of a Diagnosis: a fault needs significance and modulation index: the lower decides."""

DIAGNOSIS = (
    Panel(
        'significance',
        'Significance [σ over noise]',
        _per_family('score'),
        (
            Limit(f'significant above {Z_FAULT:g}', Z_FAULT, f'{Z_FAULT:g}'),
            Limit(f'cage significant above {Z_CAGE:g}', Z_CAGE, look='violet'),
        ),
    ),
    Panel(
        'modulation',
        'Modulation index [1]',
        _per_family('modulation_index'),
        (
            Limit(f'fault above {INDEX_FAULT:g}', INDEX_FAULT, f'{INDEX_FAULT:g}'),
            Limit(f'suspect above {INDEX_SUSPECT:g}', INDEX_SUSPECT, look='remark'),
        ),
        from_zero=True,
    ),
    _one('level', 'Vibration level [unit] rms', 'blue', 'rms', from_zero=True),
    _one('velocity', 'Velocity [mm/s rms]', 'green', 'velocity_rms', from_zero=True),
    Panel(
        'baseline',
        'Over baseline [dB]',
        (
            Trend('baseline', 'over baseline', LINE['orange'], 'level_over_baseline'),
            Trend('correction', 'correction', LINE['red'], 'level_correction'),
        ),
        (
            Limit(f'suspect above {SUSPECT_DB:g}', SUSPECT_DB, f'{SUSPECT_DB:g}', 'remark'),
            Limit(f'fault above {FAULT_DB:g}', FAULT_DB, f'{FAULT_DB:g}'),
        ),
    ),
    Panel(
        'shape',
        'Kurtosis [1]',
        (
            Trend('kurtosis', 'kurtosis', LINE['violet'], 'kurtosis'),
            Trend('crest_factor', 'crest factor', LINE['green'], 'crest_factor'),
        ),
    ),
)
"""Panels of a Diagnosis."""

CALIBRATION = (
    Panel(
        'residual',
        'Residual of the fitted twin [limits]',
        (Trend('residual', 'residual', LINE['orange'], 'residual'),),
        (Limit('alarm above 1', 1.0),),
        from_zero=True,
    ),
    Panel(
        'width',
        'Width of the defect [mm]: 5, 50 and 95 %',
        (
            Trend('q95', '95 %', LINE['violet'], 'width_q95'),
            Trend('median', 'median', LINE['blue'], 'width_median'),
            Trend('q05', '5 %', LINE['green'], 'width_q05'),
        ),
        from_zero=True,
        band=('q05', 'q95'),
    ),
    Panel(
        'distance',
        'Spectrum of twin from machine [dB]',
        (
            Trend('fitted', 'fitted', LINE['blue'], 'distance'),
            Trend('before', 'not fitted', LINE['red'], 'distance_before'),
        ),
        from_zero=True,
    ),
)
"""Panels of a Calibration."""
