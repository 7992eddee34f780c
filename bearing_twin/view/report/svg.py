# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Style of the figures in a report, and their conversion to SVG."""

from __future__ import annotations

import io
import re
from typing import Any, TYPE_CHECKING
import warnings

from bearing_twin.view.style import FAMILIES
import matplotlib as mpl

if TYPE_CHECKING:
    from bearing_twin.view.style import Colour
    from matplotlib.figure import Figure


def hex_colour(colour: Colour) -> str:
    """Return a colour as HTML and matplotlib take it."""
    return '#{:02x}{:02x}{:02x}'.format(*colour)


FAMILY_COLOURS = {family.key: hex_colour(family.colour) for family in FAMILIES} | {
    'shaft': '#78909c'
}
"""Colours of the viewer by family; in print the labels distinguish them too."""

BINS = 2400
"""Largest number of points of a drawn spectrum; the highest of neighbouring bins is kept."""
STYLE: dict[Any, Any] = {
    'svg.fonttype': 'none',
    'font.family': 'sans-serif',
    'font.size': 9.0,
    'axes.spines.top': False,
    'axes.spines.right': False,
    'axes.grid': True,
    'grid.color': '#e0e0e0',
    'grid.linewidth': 0.6,
    'axes.axisbelow': True,
    'axes.titlesize': 9.0,
    'axes.titlelocation': 'left',
    'legend.frameon': False,
    'legend.fontsize': 8.0,
    # Units and names from recordings may hold a dollar sign.
    'text.parse_math': False,
}
WIDTH = 7.4
"""Width of every figure, inches; fits a printed A4 page."""


def svg_element(figure: Figure, prefix: str) -> str:
    """Return a figure as an SVG element whose ids all start with ``prefix``."""
    buffer = io.StringIO()
    with mpl.rc_context({'svg.hashsalt': prefix}), warnings.catch_warnings():
        # It warns of missing glyphs and of numbers near the largest of their type.
        warnings.simplefilter('ignore')
        figure.savefig(buffer, format='svg', metadata={'Date': None, 'Creator': None})
    text = buffer.getvalue()
    text = text[text.index('<svg') :]
    # Matplotlib names shapes by a hash of coordinates that differ in the last bit from run to run.
    hashed = dict.fromkeys(re.findall(r'\bid="([a-z][0-9a-f]{10})"', text))
    numbers = {name: str(number) for number, name in enumerate(hashed)}
    text = re.sub(r'\b[a-z][0-9a-f]{10}\b', lambda m: 'shape' + numbers.get(m[0], m[0]), text)
    text = re.sub(r'\bid="', f'id="{prefix}', text)
    text = text.replace('url(#', f'url(#{prefix}').replace('href="#', f'href="#{prefix}')
    return re.sub(r'<metadata>.*?</metadata>', '', text, flags=re.DOTALL)
