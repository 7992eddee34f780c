# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Source of a bearing's vibration: simulated or measured, by what, and on what machine."""

from __future__ import annotations

import math
from typing import Any, TYPE_CHECKING

from bearing_twin.assets.parameters.twin import build_parameters
from bearing_twin.bearing.catalogue import find_bearing
from bearing_twin.bearing.geometry import fault_orders
from bearing_twin.errors import BearingTwinError
from bearing_twin.streams.vibration_input import SOURCE_MEASURED, SOURCE_SIMULATED
from bearing_twin.view.trends import zone_limits

if TYPE_CHECKING:
    from bearing_twin.view.trends import Limit


PLACE = {'inner': 'inner race', 'outer': 'outer race', 'ball': 'ball', 'cage': 'cage'}


class Source:
    """Source of vibration, from its messages and the parameters of twin and diagnosis."""

    def __init__(self) -> None:
        self._node = ''
        self._twins: dict[str, None] = {}
        self.frame = ''
        """``frame_id`` of the vibration: the sensor."""
        self.zones: tuple[Limit, ...] = zone_limits()
        """Velocities in mm/s at which the zones of the machine begin."""
        self.lapsed: dict[str, tuple[str, int] | None] = {}
        """Why a diagnosis has no verdict on the present, and when it said so in ns, by its name;
        None of one that has."""
        self._sources: set[int] = set()

    def vibration(self, message: Any) -> None:
        """Take a Vibration message."""
        self.frame = str(message.header.frame_id)
        self._sources.add(int(message.source))

    def forget_vibration(self) -> None:
        """Forget the vibration messages taken so far."""
        self._sources.clear()

    def parameters(self, node: str, kind: str, values: dict[str, Any]) -> None:
        """Take the parameters of a node of a kind: those of a twin or of the diagnosis count."""
        if kind == 'twin':
            self._node, words = node, twin_in_words(values)
            self._twins.pop(words, None)
            self._twins[words] = None
        elif kind == 'diagnosis':
            self.zones = zone_limits(values.get('power_group'), values.get('mounting'))

    @property
    def stale(self) -> tuple[str, int] | None:
        """Why no diagnosis has a verdict on the present, and when it was said, ns; else None."""
        return (
            None
            if None in self.lapsed.values()
            else max(filter(None, self.lapsed.values()), key=lambda told: told[1], default=None)
        )

    @property
    def whole(self) -> str:
        """Source in words like `text`, with what the twin simulated before."""
        *before, _ = [*self._twins] or ['']
        if not before or SOURCE_SIMULATED not in self._sources:
            return self.text
        more = f', and {len(before) - 1} more' if len(before) > 1 else ''
        return f'{self.text} at the end; before: {before[-1]}{more}'

    @property
    def text(self) -> str:
        """Source in words, as it is now; '' while there is no vibration."""
        if not self._sources:
            return ''
        if SOURCE_SIMULATED in self._sources:
            twin = f'{self._node}, {[*self._twins][-1]}' if self._twins else 'a twin'
            return f'simulated by {twin}'
        text = 'measured' if SOURCE_MEASURED in self._sources else 'source not stated'
        return f'{text}, {self.frame}' if self.frame else text


def fleet_tables(node: str, kind: str, values: dict[str, Any]) -> dict[str, dict[str, Any]]:
    """
    Return the parameters of each asset of a fleet by its namespace; empty for other nodes.

    The namespaces are beside the node, not below it like the topic of its checkpoint.

    Examples
    --------
    >>> fleet_tables('/plant/fleet', 'fleet', {'line3/pump': {'defect': 'inner'}})
    {'/plant/line3/pump': {'defect': 'inner'}}

    """
    if kind != 'fleet':
        return {}
    parent = node.rpartition('/')[0]
    return {f'{parent}/{n}': table for n, table in values.items() if isinstance(table, dict)}


def bearing_in_words(name: str, *, orders: bool = False) -> str:
    """Return geometry, and fault orders, of a catalogued bearing; of any other its name."""
    try:
        b = find_bearing(name)
    except BearingTwinError:
        return name
    o = fault_orders(b)
    kinematics = (
        f'. Orders without slip: BPFO {o.bpfo:.3f}, BPFI {o.bpfi:.3f}, BSF {o.bsf:.3f}, '
        f'FTF {o.ftf:.4f}'
    )
    return (
        f'{b.name}: {b.n_balls} balls of {1e3 * b.d_ball:.2f} mm on {1e3 * b.d_pitch:.1f} mm, '
        f'contact angle {math.degrees(b.contact_angle):g}°{kinematics if orders else ""}'
    )


def twin_in_words(values: dict[str, Any]) -> str:
    """Return preset and defects of a twin in words."""
    try:
        defects = build_parameters(values).defects
        text = ', '.join(f'{PLACE[d.place]} {1e3 * d.width:.3g} mm' for d in defects)
        return f'preset {values["preset"]}, {text or "no defect"}'
    except (BearingTwinError, KeyError, TypeError):
        return 'parameters of another version'
