# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Messages of any type: every number that it holds as a line, every array as bars."""

from __future__ import annotations

import math
import numbers
from typing import Any, TYPE_CHECKING

from bearing_twin.view.style import LINE
import numpy as np
import rerun as rr

if TYPE_CHECKING:
    from collections.abc import Iterator

    from bearing_twin.view.rerun.canvas import Canvas

__all__ = ['draw_anything', 'scalars']

MOST = 24
"""Most lines of one topic."""
SHORT = 12
"""Arrays up to this length are lines, longer ones bars."""
COLOURS = [LINE[key] for key in ('first', 'second', 'third', 'fourth', 'measured', 'horizontal')]
SKIPPED = ('header', 'stamp', 'layout')


def scalars(message: Any, prefix: str = '') -> Iterator[tuple[str, Any]]:
    """
    Yield (path, number or numeric array) of every field, nested messages included.

    Constants (upper case) and time stamps are left out.
    """
    fields: Any = getattr(message, '__dataclass_fields__', None)
    if fields is None:
        fields = getattr(message, '__slots__', ())
    for field in fields:
        name = str(field).lstrip('_')
        if name in SKIPPED or name.isupper() or name.startswith('_') or name == 'check_fields':
            continue
        value = getattr(message, name, None)
        if isinstance(value, (bool, numbers.Real)):
            yield prefix + name, float(value)
        elif hasattr(value, '__dataclass_fields__') or hasattr(value, '__slots__'):
            yield from scalars(value, f'{prefix}{name}/')
        elif isinstance(value, (np.ndarray, memoryview, list, tuple)) or hasattr(
            value, 'typecode'
        ):
            array = _numeric(value)
            if array is not None:
                yield prefix + name, array


def draw_anything(canvas: Canvas, name: str, message: Any, time: int) -> str:
    """Draw what can be drawn; return what that was: 'numbers', 'arrays', '' for nothing."""
    series: dict[str, tuple[float, str, tuple[int, int, int]]] = {}
    drawn = False
    labels = _labels(message)
    for path, value in scalars(message):
        if isinstance(value, float):
            series[f'{name}/fields/{path}'] = (value, path, COLOURS[len(series) % len(COLOURS)])
        elif value.size <= SHORT:
            for k, element in enumerate(value):
                label = labels[k] if len(labels) == value.size else f'{path}[{k}]'
                series[f'{name}/fields/{path}/{k}'] = (
                    float(element),
                    label,
                    COLOURS[len(series) % len(COLOURS)],
                )
        else:
            drawn = True
            canvas.put(
                f'{name}/arrays/{path}', time, rr.BarChart(_thinned(value), color=LINE['first'])
            )
        if len(series) >= MOST:
            break
    finite = {key: entry for key, entry in series.items() if math.isfinite(entry[0])}
    canvas.points(time, finite)
    return 'numbers' if finite else 'arrays' if drawn else ''


def _numeric(value: Any) -> np.ndarray[Any, Any] | None:
    try:
        array = np.asarray(value, dtype=np.float64)
    except (TypeError, ValueError):
        return None
    return array.ravel() if array.size else None


def _thinned(values: np.ndarray[Any, Any], most: int = 2048) -> np.ndarray[Any, Any]:
    step = -(-values.size // most)
    return np.asarray(np.nan_to_num(values[::step]))


def _labels(message: Any) -> list[str]:
    """Return the labels that a multi-array gives its elements; [] where it gives none."""
    layout = getattr(message, 'layout', None)
    return [str(d.label) for d in getattr(layout, 'dim', ())] if layout is not None else []
