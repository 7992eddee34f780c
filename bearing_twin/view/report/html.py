# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Style sheet and tables of the page."""

from __future__ import annotations

from collections.abc import Iterable
from html import escape

# On a phone a picture keeps a width at which its text is legible, and scrolls sideways.
CSS = """
:root { color-scheme: light; }
body { font: 15px/1.4 system-ui, 'Segoe UI', 'DejaVu Sans', sans-serif; color: #212121;
  background: #fff; max-width: 860px; margin: 0 auto; padding: 20px 16px; }
h1 { font-size: 22px; margin: 0 0 4px; overflow-wrap: anywhere; }
h2 { font-size: 17px; margin: 24px 0 6px; border-bottom: 1px solid #bdbdbd;
  overflow-wrap: anywhere; }
p.sub { color: #616161; margin: 0 0 10px; }
.verdict { border-radius: 6px; padding: 10px 16px; margin: 10px 0;
  print-color-adjust: exact; -webkit-print-color-adjust: exact; overflow-wrap: anywhere; }
td.verdict { border-radius: 0; padding: 2px 8px; font-weight: 600; }
.wide { overflow-x: auto; } .wide table { min-width: 660px; } .wide th { width: auto; }
.wide td, .wide tr:first-child th { overflow-wrap: normal; }
.wide tr > :first-child { min-width: 10em; } .wide td + td, .wide th + th { padding-left: 8px; }
.print { display: none; }
.verdict b { display: block; font-size: 28px; line-height: 1.2; }
.columns { display: grid; grid-template-columns: 1fr 1fr; gap: 0 24px; align-items: start; }
figure { margin: 10px 0; break-inside: avoid; }
figure div { overflow-x: auto; }
figure svg { display: block; width: 100%; min-width: 660px; height: auto; }
figcaption { color: #616161; font-size: 13px; }
table { border-collapse: collapse; width: 100%; font-size: 13px; margin: 6px 0; }
th, td { text-align: left; vertical-align: top; padding: 2px 8px 2px 0;
  border-bottom: 1px solid #e0e0e0; overflow-wrap: anywhere; }
th { font-weight: 600; width: 32%; }
tr { break-inside: avoid; }
tr.found { background: #fdecea; print-color-adjust: exact; }
td.n, th.n { text-align: right; width: auto; overflow-wrap: normal;
  font-variant-numeric: tabular-nums; }
ul { margin: 6px 0; padding-left: 20px; font-size: 14px; overflow-wrap: anywhere; }
.bad { color: #b71c1c; font-weight: 600; }
.good { color: #2e7d32; font-weight: 600; }
.appendix { border-top: 2px solid #616161; margin-top: 28px; padding-top: 12px; }
@media (max-width: 640px) { .columns { grid-template-columns: 1fr; }
  body { padding: 12px 10px; } }
@page { size: A4; margin: 12mm; }
@media print { body { padding: 0; max-width: none; font-size: 9.5pt; }
  h1 { font-size: 14pt; } .verdict b { font-size: 18pt; } table { font-size: 8.5pt; }
  ul { font-size: 9pt; } figcaption { font-size: 8pt; } h1, h2, .good, .bad { break-after: avoid; }
  figure { margin: 6px 0; } figure svg { min-width: 0; }
  .columns { grid-template-columns: 1fr 1fr; } .wide table { min-width: 0; }
  .screen { display: none; } .print { display: block; }
  .overview table { font-size: 7.5pt; }
  .overview { break-after: page; } .machine + .machine { break-before: page; }
  .appendix .machine { break-before: auto; }
  .appendix { break-before: page; border: 0; margin: 0; padding: 0; }
  .appendix table { break-inside: avoid; } .appendix table.long { break-inside: auto; }
  .appendix table, .appendix ul { font-size: 7.5pt; } }
"""

SHEET = 25
"""Largest number of rows of a table that print does not part."""


def table(rows: Iterable[tuple[str, str]]) -> str:
    """Return names and values as a table."""
    lines = [f'<tr><th>{escape(k)}</th><td>{escape(v)}</td></tr>' for k, v in rows]
    return f'<table{" class=long" if len(lines) > SHEET else ""}>{"".join(lines)}</table>'
