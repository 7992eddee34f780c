# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Messages of any type: numbers as lines, arrays as bars."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import fields, is_dataclass
import math
import numbers
from typing import Any, TYPE_CHECKING

from bearing_twin.view.rerun.pictures.picture import Picture
from bearing_twin.view.style import LINE
import numpy as np
import rerun as rr

if TYPE_CHECKING:
    from bearing_twin.view.style import Colour


MOST = 24
"""Largest number of lines of one topic."""
SHORT = 12
"""Arrays up to this length are lines, longer ones bars."""
COLOURS = [LINE[key] for key in ('blue', 'green', 'orange', 'violet', 'red', 'olive')]
SKIPPED = ('header', 'stamp', 'layout')


def scalars(message: Any, prefix: str = '') -> Iterator[tuple[str, Any]]:
    """
    Yield (path, number or numeric array) of every field, nested messages included.

    Constants (upper case) and time stamps are left out.
    """
    for name in (field.name for field in fields(message)):
        if name in SKIPPED or name.isupper():
            continue
        value = getattr(message, name)
        if isinstance(value, numbers.Real):
            yield prefix + name, float(value)
        elif is_dataclass(value):
            yield from scalars(value, f'{prefix}{name}/')
        elif isinstance(value, (np.ndarray, list)):
            array = _numeric(value)
            if array is not None:
                yield prefix + name, array


class AnyPicture(Picture):
    """Draw messages of any other type."""

    kind = 'numbers'

    def draw(self, message: Any, time: int) -> bool:
        """Draw the numbers and arrays of a message at ``time`` in ns."""
        series: dict[str, tuple[float, str, Colour]] = {}
        arrays = False
        labels = _labels(message)
        for path, value in scalars(message):
            colour = COLOURS[len(series) % len(COLOURS)]
            if isinstance(value, float):
                series[f'fields/{path}'] = (value, path, colour)
            elif value.size <= SHORT:
                for k, element in enumerate(value):
                    label = labels[k] if len(labels) == value.size else f'{path}[{k}]'
                    colour = COLOURS[len(series) % len(COLOURS)]
                    series[f'fields/{path}/{k}'] = (float(element), label, colour)
            else:
                arrays = True
                bars = rr.BarChart(_thinned(value), color=LINE['blue'])
                self.canvas.put(f'arrays/{path}', time, bars)
            if len(series) >= MOST:
                break
        times = np.array([time], dtype=np.int64)
        finite = {key: entry for key, entry in series.items() if math.isfinite(entry[0])}
        for key, (number, label, colour) in finite.items():
            self.canvas.line(key, times, np.array([number]), label=label, colour=colour, slow=True)
        self.kind = 'numbers' if finite else 'arrays'
        return bool(finite) or arrays


def _numeric(value: Any) -> np.ndarray[Any, Any] | None:
    try:
        array = np.asarray(value, dtype=np.float64)
    except (TypeError, ValueError):
        return None
    return array.ravel() if array.size else None


def _thinned(values: np.ndarray[Any, Any]) -> np.ndarray[Any, Any]:
    step = -(-values.size // 2048)
    return np.asarray(np.nan_to_num(values[::step]))


def _labels(message: Any) -> list[str]:
    """Return the labels that a multi-array gives its elements; [] if there are none."""
    layout = getattr(message, 'layout', None)
    return [str(d.label) for d in getattr(layout, 'dim', ())] if layout is not None else []
