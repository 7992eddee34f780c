# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Coloured lanes: a state over time that is read from across a room."""

from __future__ import annotations

from typing import TYPE_CHECKING

import rerun as rr

if TYPE_CHECKING:
    from collections.abc import Sequence

    from bearing_twin.view.canvas import Canvas
    from bearing_twin.view.style import State

__all__ = ['Lane']


class Lane:
    """One lane; ``states`` by the number that a message gives them."""

    def __init__(self, canvas: Canvas, name: str, states: Sequence[State]) -> None:
        self._canvas = canvas
        self._name = name
        self._states = states
        self._last: int | None = None

    def set(self, number: int, time: int) -> None:
        """Note the state at ``time`` in ns; only changes are logged."""
        if number == self._last or not 0 <= number < len(self._states):
            return
        self._last = number
        self._canvas.once(
            self._name,
            rr.StateConfiguration(
                values=[state.key for state in self._states],
                labels=[state.label for state in self._states],
                colors=[state.colour for state in self._states],
            ),
        )
        self._canvas.put(self._name, time, rr.StateChange(state=self._states[number].key))
