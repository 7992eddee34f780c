# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Whether the vibration of a bearing is simulated or measured, and by what."""

from __future__ import annotations

from typing import Any

from bearing_twin.assets.twin_parameters import build_parameters
from bearing_twin.errors import BearingTwinError
from bearing_twin.recording.plainyaml import load_plain
from bearing_twin.stamps import stamp_ns

__all__ = ['Source', 'twin_in_words']

PLACE = {'inner': 'inner race', 'outer': 'outer race', 'ball': 'ball', 'cage': 'cage'}


class Source:
    """
    Tell simulated vibration from measured.

    The state of a twin carries stamp and number of the block that it belongs to: vibration that
    matches one is that twin's.
    """

    def __init__(self) -> None:
        self._twin = ''
        self.frame = ''
        """Frame of the vibration: the sensor."""
        self._simulated = False
        self._block: tuple[int, int] | None = None
        self._state: tuple[int, int] | None = None

    def vibration(self, message: Any) -> None:
        """Take a Vibration message."""
        self.frame = str(message.header.frame_id)
        self._block = (stamp_ns(message.header.stamp), int(message.first_sample))
        self._simulated = self._simulated or self._block == self._state

    def state(self, message: Any) -> None:
        """Take a TwinState message."""
        self._state = (stamp_ns(message.header.stamp), int(getattr(message, 'first_sample', -1)))
        self._simulated = self._simulated or self._block == self._state

    def checkpoint(self, message: Any) -> None:
        """Take a Checkpoint message."""
        if str(message.kind) == 'twin':
            values = load_plain(str(message.configuration), 'the configuration of a twin')
            self._twin = f'{message.node}, {twin_in_words(values)}'

    @property
    def text(self) -> str:
        """In words; '' while there is no vibration."""
        if self._block is None:
            return ''
        if self._simulated:
            return f'simulated by {self._twin or "a twin"}'
        return f'measured, {self.frame}' if self.frame else 'measured'


def twin_in_words(values: Any) -> str:
    """Return preset and defects of the parameters of a twin."""
    try:
        defects = build_parameters(values).defects
        text = ', '.join(f'{PLACE[d.place]} {1e3 * d.width:.2g} mm' for d in defects)
        return f'preset {values["preset"]}, {text or "no defect"}'
    except (BearingTwinError, KeyError, TypeError):
        return 'parameters of another version'
