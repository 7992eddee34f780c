# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Sphinx: the pages of this folder and the API of the core, as rosdoc2 builds them too."""

from pathlib import Path
import re
import sys
from typing import Any
import xml.etree.ElementTree as ElementTree

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT))

project = 'bearing_twin'
project_copyright = '2026, bearing_twin contributors'
version = release = str(ElementTree.parse(ROOT / 'package.xml').findtext('version'))
extensions = ['myst_parser', 'sphinx.ext.autodoc', 'sphinx.ext.napoleon']
source_suffix = {'.md': 'markdown', '.rst': 'restructuredtext'}
myst_heading_anchors = 4
# Quotes are of values to be typed.
smartquotes_action = 'De'
html_theme = 'alabaster'
html_theme_options = {
    'page_width': '78em',
    'sidebar_width': '14em',
    'body_max_width': 'none',
    'fixed_sidebar': True,
    'font_size': '16px',
}
html_sidebars = {'**': ['about.html', 'searchfield.html', 'localtoc.html', 'navigation.html']}
napoleon_google_docstring = False
autodoc_default_options = {'members': True, 'imported-members': True, 'member-order': 'groupwise'}
autodoc_typehints = 'none'
# The API is documented without ROS.
autodoc_mock_imports = ['rclpy', 'bearing_twin_msgs']


def break_names(
    app: object, page: str, template: str, context: dict[str, Any], doctree: object
) -> None:
    """Let long names in tables break behind a point, an underline or a slash."""

    def breakable(cell: re.Match[str]) -> str:
        return re.sub(r'(?<=[a-z])([._/])(?=[a-z])', r'\1</span><wbr><span class="pre">', cell[0])

    if 'body' in context:
        cell = r'(?<=<td>).*?(?=</td>)'
        code = r'(?<=<span class="pre">)[^<]{16,}'
        context['body'] = re.sub(
            cell, lambda m: re.sub(code, breakable, m[0]), context['body'], flags=re.DOTALL
        )


def setup(app: Any) -> None:
    """Connect what changes the pages."""
    app.connect('html-page-context', break_names)
