# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Sphinx: the pages of this folder and the API of the core, as rosdoc2 builds them too."""

from pathlib import Path
import sys
import xml.etree.ElementTree as ElementTree

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT))

project = 'bearing_twin'
copyright = '2026, bearing_twin contributors'
version = release = str(ElementTree.parse(ROOT / 'package.xml').findtext('version'))
extensions = ['myst_parser', 'sphinx.ext.autodoc', 'sphinx.ext.napoleon', 'sphinx.ext.mathjax']
source_suffix = {'.md': 'markdown', '.rst': 'restructuredtext'}
myst_heading_anchors = 4
html_theme = 'alabaster'
html_theme_options = {'page_width': '76em', 'sidebar_width': '15em', 'body_max_width': 'none'}
napoleon_google_docstring = False
autodoc_default_options = {'members': True, 'imported-members': True, 'member-order': 'groupwise'}
autodoc_typehints = 'none'
# The API is documented without ROS.
autodoc_mock_imports = ['rclpy', 'bearing_twin_msgs']
