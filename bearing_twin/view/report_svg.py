# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Style of the pictures in a report, and how a figure becomes part of a page."""

from __future__ import annotations

import io
import re
from typing import TYPE_CHECKING, Any

import matplotlib as mpl

if TYPE_CHECKING:
    from matplotlib.figure import Figure

__all__ = [
    'BINS',
    'DEFECTS',
    'FAMILY_COLOURS',
    'FAMILY_LABELS',
    'STYLE',
    'VERDICT_COLOURS',
    'WIDTH',
    'pretty',
    'svg_element',
]

FAMILY_COLOURS = {
    'inner': '#c62828',
    'outer': '#1565c0',
    'ball': '#e65100',
    'cage': '#7b1fa2',
    'shaft': '#78909c',
}
"""Dark enough for white paper; told apart in print by their labels too."""

FAMILY_LABELS = {
    'inner': 'BPFI',
    'outer': 'BPFO',
    'ball': '2×BSF',
    'cage': 'FTF',
    'shaft': 'shaft',
}
DEFECTS = ('inner', 'outer', 'ball', 'cage')
"""In the order of the per-family arrays of a Diagnosis."""

VERDICT_COLOURS = {
    'healthy': '#2e7d32',
    'inner': '#c62828',
    'outer': '#ad1457',
    'ball': '#e65100',
    'cage': '#7b1fa2',
    'suspect': '#f9a825',
    'ambiguous': '#6d4c41',
    'insufficient': '#757575',
}

BINS = 2400
"""Most points of a drawn spectrum; of neighbouring bins the highest is kept."""
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
}
WIDTH = 7.4
"""Of every picture, inches: fits a printed A4 page."""


def svg_element(figure: Figure, prefix: str) -> str:
    """Return a figure as an SVG element whose ids all start with ``prefix``."""
    buffer = io.StringIO()
    with mpl.rc_context({'svg.hashsalt': prefix}):
        figure.savefig(buffer, format='svg', metadata={'Date': None, 'Creator': None})
    text = buffer.getvalue()
    text = text[text.index('<svg') :]
    text = re.sub(r'\bid="', f'id="{prefix}', text)
    text = text.replace('url(#', f'url(#{prefix}').replace('href="#', f'href="#{prefix}')
    return re.sub(r'<metadata>.*?</metadata>', '', text, flags=re.DOTALL)


def pretty(unit: str) -> str:
    """Return a unit as it is printed."""
    return str(unit).replace('^2', '²')
