# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Table of the drawn figures. Figures 1-3, 11, 18, 25, 26 are sketches, 31 is an experiment."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
import functools
from types import MappingProxyType
from typing import TYPE_CHECKING

from bearing_twin.paper.figures import force, material, spectrum, time

if TYPE_CHECKING:
    from bearing_twin.paper.settings import Factor
    from bearing_twin.paper.study import Study
    from matplotlib.figure import Figure


@dataclass(frozen=True)
class Drawing:
    """One figure."""

    caption: str
    draw: Callable[[Study], Figure]


def _registry() -> dict[str, Drawing]:
    drawings = {
        '4': Drawing('Signal and spectra without temperature', spectrum.signal),
        '5': Drawing('Thermal expansion coefficient', functools.partial(material.table, number=5)),
        '12': Drawing('Hardness', functools.partial(material.table, number=12)),
        '19': Drawing('Friction coefficient', functools.partial(material.table, number=19)),
        '30': Drawing(
            'Envelope spectrum at 20 degC',
            functools.partial(spectrum.spectrum, number=30, temperature=20.0),
        ),
        '32': Drawing(
            'Envelope spectrum at 100 degC',
            functools.partial(spectrum.spectrum, number=32, temperature=100.0),
        ),
    }
    kinds = (
        ('F_x, stiffness alone', force.single_stiffness),
        ("F_x, 'damping' alone", force.single_damping),
        ('Resultant force', force.resultant),
        ('Time-domain waterfall', time.waterfall),
        ('Peaks over temperature', time.peaks),
    )
    numbers: dict[Factor, tuple[int | None, ...]] = {
        'expansion': (6, 7, 8, 9, 10),
        'hardness': (13, 14, 15, 16, 17),
        'friction': (20, 21, 22, 23, 24),
        'all': (None, None, 27, 28, 29),
    }
    for factor, row in numbers.items():
        for number, (caption, draw) in zip(row, kinds, strict=True):
            if number is not None:
                drawings[str(number)] = Drawing(
                    f'{caption}: {factor}', functools.partial(draw, number=number, factor=factor)
                )
    return {number: drawings[number] for number in sorted(drawings, key=int)}


FIGURES: Mapping[str, Drawing] = MappingProxyType(_registry())
"""Figures by their number in the paper."""
