# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Coloured lanes: a state over time that is read from across a room."""

from __future__ import annotations

from typing import TYPE_CHECKING

import rerun as rr

if TYPE_CHECKING:
    from collections.abc import Sequence

    from bearing_twin.view.rerun.canvas import Canvas
    from bearing_twin.view.style import State

__all__ = ['Lane']

AGAIN = 10_000_000_000
"""A state that lasts is logged again after this time, ns: servers forget, viewers come late."""


class Lane:
    """One lane; ``states`` by the number that a message gives them."""

    def __init__(self, canvas: Canvas, name: str, states: Sequence[State]) -> None:
        self._canvas = canvas
        self._name = name
        self._states = states
        self._last: int | None = None
        self._time = 0

    def set(self, number: int, time: int) -> None:
        """Note the state at ``time`` in ns; changes, and what lasts once more."""
        if not 0 <= number < len(self._states):
            return
        if number == self._last and 0 <= time - self._time < AGAIN:
            return
        self._last, self._time = number, time
        self._canvas.once(
            self._name,
            rr.StateConfiguration(
                values=[state.key for state in self._states],
                labels=[state.label for state in self._states],
                colors=[state.colour for state in self._states],
            ),
        )
        self._canvas.put(self._name, time, rr.StateChange(state=self._states[number].key))
