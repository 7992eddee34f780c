# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Base class of pictures: a picture takes the messages of a topic and draws on a canvas."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Sequence
from dataclasses import dataclass, field
import math
from typing import Any, TYPE_CHECKING

from bearing_twin.view.over_temperature import NUMBERED, OverTemperature
from bearing_twin.view.rerun.pictures.scales import Scales
from bearing_twin.view.source import Source
from bearing_twin.view.style import LINE
from bearing_twin.view.trends import Limit, ZERO
from bearing_twin.view.verdict import Headline, pretty
import numpy as np

if TYPE_CHECKING:
    from bearing_twin.view.rerun.canvas import Canvas
    from bearing_twin.view.trends import Panel


LOW = 0.7
"""Fraction of a power of ten up to which the viewer numbers each tenth on an axis from 0, a
quarter of a laptop's screen high."""
ABOVE = 1.08
"""Ratio of an axis from 0 to its highest value, which would else lie on the picture's edge."""


@dataclass
class Asset:
    """State that the pictures of one bearing share."""

    namespace: str = ''
    """'' for the root namespace."""
    narrow: bool = False
    """Whether another recording is shown beside it."""
    full: bool = False
    """Draw every sample of the vibration instead of a part of each second and its envelope."""
    temperature: float = math.nan
    """Latest temperature, degC: of the twin if there is one, else measured."""
    thermometer: str = ''
    """Topic of the measured temperature that is used while there is no twin."""
    twin: bool = False
    """Whether a TwinState has arrived."""
    diagnosis: Any = None
    """Latest Diagnosis message."""
    received: int = 0
    """Arrival of the message that is being drawn, ns."""
    judged: int = 0
    """Time at which the latest diagnosis is drawn, ns."""
    sources: defaultdict[str, Source] = field(default_factory=lambda: defaultdict(Source))
    """Sources of all bearings by namespace: the parameters of a fleet belong to several."""
    scales: Scales = field(default_factory=Scales)
    """Scales of all recordings that are drawn side by side."""
    headline: Headline = field(default_factory=Headline)
    over_temperature: OverTemperature = field(default_factory=OverTemperature)
    unit: str = ''
    """Unit of the vibration that the verdict is about."""
    units: dict[str, str] = field(default_factory=dict)
    """Unit of each vibration topic."""
    panels: set[str] = field(default_factory=set)
    """Keys of panels over time that have values, paths of those over temperature, and ``severity``
    if the level of a verdict depends on the velocity."""

    @property
    def source(self) -> Source:
        """Source of its vibration."""
        return self.sources[self.namespace]


class Picture:
    """Picture of one topic."""

    kind = ''
    """Kind by which the layout chooses the views; '' for pictures without a view."""
    panels: Sequence[Panel] = ()
    """Quantities that are drawn over time."""
    low = LOW
    """`LOW` for the height of their views."""

    def __init__(self, canvas: Canvas, asset: Asset) -> None:
        self.canvas = canvas
        self.asset = asset
        self.trends = Trends(canvas, asset, self.panels, self.low)

    def draw(self, message: Any, time: int) -> bool:
        """Draw a message at ``time`` in ns; return whether anything is shown."""
        raise NotImplementedError

    def flush(self, *, slow: bool) -> None:
        """Send what is held, with ``slow`` the slow lines too."""
        if slow:
            self.trends.flush()
        self.canvas.flush(slow=slow)

    def finish(self) -> None:
        """Draw what is known only at the end of a recording."""


class Trends:
    """Draw the quantities of ``panels`` over time, a block of messages at once."""

    def __init__(self, canvas: Canvas, asset: Asset, panels: Sequence[Panel], low: float) -> None:
        self._canvas = canvas
        self._low = low
        self._asset = asset
        self._panels = panels
        self._times: list[int] = []
        self._rows: list[list[float]] = []

    def hold(self, message: Any, time: int) -> None:
        """Hold the quantities of a message at ``time`` in ns."""
        self._asset.unit = pretty(getattr(message, 'unit', self._asset.unit))
        self._times.append(time)
        self._rows.append(
            [float(trend.value(message)) for panel in self._panels for trend in panel.trends]
        )

    def flush(self) -> None:
        """Draw the held quantities on the canvas; missing values are left out."""
        if not self._rows:
            return
        times = np.array(self._times, dtype=np.int64)
        columns = iter(np.array(self._rows).T)
        self._times, self._rows = [], []
        for panel in self._panels:
            drawn, top = False, 0.0
            for trend in panel.trends:
                values = next(columns)
                there = np.isfinite(values)
                if there.any():
                    drawn |= trend is panel.trends[0]
                    top = max(top, float(values[there].max()))
                    self._canvas.line(
                        f'{panel.key}/{trend.key}',
                        times if there.all() else times[there],
                        values if there.all() else values[there],
                        label=trend.label,
                        colour=trend.colour,
                        slow=True,
                        parted=True,
                    )
            if drawn:
                self._asset.panels.add(panel.key)
            limits = self._asset.source.zones if panel.key == 'velocity' else panel.limits
            numbered = panel.key == 'temperature' and self._asset.over_temperature.is_wide
            if numbered:
                limits = tuple(Limit(f'{t:g} °C', t, look='grid') for t in NUMBERED)
            if panel.from_zero:
                highest = ABOVE * max(top, *(limit.value for limit in limits), 0.0)
                end = labelled_power(highest, self._low) or highest
                limits = *limits, ZERO
                if drawn and end:
                    self._canvas.line(
                        f'{panel.key}/axis', times[[0, -1]], np.full(2, end), label='axis',
                        colour=LINE['back'], slow=True,
                    )  # fmt: skip
            for limit in limits if drawn else ():
                self._canvas.line(
                    f'{panel.key}/limit/{limit.value:g}',
                    times[[0, -1]],
                    np.full(2, limit.value),
                    label=limit.label,
                    colour=LINE[limit.look],
                    slow=True,
                )


def labelled_power(top: float, part: float) -> float:
    """
    Return the power of ten that an axis up to ``top`` must include to have a number beside 0.

    The viewer numbers each tenth of a power of ten on an axis up to ``part`` of that power, and
    only the power itself on a longer one. 0 means that the axis need not include more.

    Examples
    --------
    >>> labelled_power(85.0, 0.6), labelled_power(55.0, 0.6), labelled_power(0.0, 0.6)
    (100.0, 0.0, 0.0)

    """
    if not 0.0 < top < math.inf:
        return 0.0
    power: float = 10.0 ** math.ceil(math.log10(top) - 1e-9)
    return power if top > part * power else 0.0


def numbered_end(end: float, steps: float) -> float:
    """
    Return the end of an axis from 0 to about ``end`` on which the viewer writes two numbers.

    The viewer numbers every multiple of a power of ten if at most ``steps`` of them fit on the
    axis, else every tenth multiple. A longer axis therefore ends at ``steps`` or at ten multiples,
    whichever is nearer.

    Examples
    --------
    >>> numbered_end(530.0, 6.0), numbered_end(530.0, 4.0), numbered_end(900.0, 6.0)
    (530.0, 400.0, 1000.0)

    """
    step: float = 10.0 ** math.floor(math.log10(end) + 1e-9)
    if end <= steps * step:
        return end
    return steps * step if end**2 < 10.0 * steps * step**2 else 10.0 * step
