# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""The report in Markdown, and the table of claims that the documentation shows."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from typing import Any, TYPE_CHECKING

from bearing_twin.paper import settings
from bearing_twin.paper.claims.claim import rounded, VERDICTS
from bearing_twin.paper.equation_table import equation_table
from bearing_twin.paper.figures.drawings import FIGURES
from bearing_twin.thermal import gcr15

if TYPE_CHECKING:
    from bearing_twin.paper.claims.claim import Claim


def figure_name(number: str) -> str:
    """Return the file name of a figure, e.g. ``figure-09.png``."""
    return f'figure-{number:0>2}.png'


def summary_line(claims: Sequence[Claim]) -> str:
    """Count the verdicts in one line."""
    counts = Counter(claim.verdict for claim in claims)
    parts = ', '.join(f'{counts[verdict]} {verdict.replace("_", " ")}' for verdict in VERDICTS)
    return f'{len(claims)} claims: {parts}'


def claims_table(claims: Sequence[Claim], *, with_reason: bool = True) -> str:
    """Render the claims as a Markdown table."""
    head = ['id', 'where', 'claim', 'paper', 'ours', 'verdict', *(['why'] * with_reason)]
    rows = []
    for claim in claims:
        cells = [
            f'`{claim.id}`', claim.where, claim.claim, _value(claim.paper_value),
            _value(claim.our_value), claim.verdict.replace('_', ' '),
        ]  # fmt: skip
        rows.append(cells + [claim.why] * with_reason)
    return _table(head, rows)


def render_report(claims: Sequence[Claim]) -> str:
    """Render report.md: verdicts, equations, tables and figures."""
    parts = [
        '# The paper, recomputed',
        'Zhang, C.; Liu, T.; Wang, Y.; He, H.; Zhang, C. *Mechanism Study of Symmetric '
        'Mechanism-Rolling Bearing Dynamic System Considering the Influence of Temperature '
        'Factor.* Symmetry 2023, 15(12), 2166.',
        'Written by `bearing-twin paper`. Every verdict is computed from this run by the rule '
        'that its reason states.',
        summary_line(claims) + '.',
        '## Settings',
        _settings_text(),
        '## Claims',
        claims_table(claims),
        '## Equations',
        _table(['no.', 'quantity', 'reading, case', 'value'], equation_table()),
        '## Tables',
        _tables(),
        '## Figures',
        'Figures 1 to 3, 11, 18, 25 and 26 of the paper are sketches; figure 31 is a measurement '
        'that is not disclosed. Left: `paper`, right: `incipient`, where there are two panels '
        'of simulation.',
    ]
    for number, drawing in FIGURES.items():
        name = f'Figure {number}'
        parts += [f'### {name}. {drawing.caption}', f'![{name}]({figure_name(number)})']
    return '\n\n'.join(parts) + '\n'


def _settings_text() -> str:
    bearing = settings.BEARING
    return (
        f"The paper's: 6307, N_b = {bearing.n_balls}, d = {bearing.d_ball * 1e3:g} mm, D = "
        f'{bearing.d_pitch * 1e3:g} mm, f_r = {settings.SHAFT_HZ} r/s, '
        f'{settings.COLD:g} to {settings.HOT:g} °C in steps of '
        f'10 °C, records of {settings.DURATION} s from an impact at t0 = 0.\n\n'
        f'Ours, where it gives none: Δh = {settings.DELTA_H:g}, Δμ = {settings.DELTA_MU:g}; '
        'masses, stiffnesses, load and spall of the presets `paper` (3.2 kN, spall 2.45 mm wide, '
        '80 µm deep) and `incipient` (500 N, 0.8 mm, 15 µm), clearance 5 µm. No jitter, no noise, '
        'no waviness, no sensor resonance; the signal is the vertical acceleration of the '
        'housing, sampled at 51.2 kHz (12 s records and grids: 25.6 kHz). The equations advance '
        'by one step a sample, at 25.6 kHz by three where the contact mode is fast (`paper`), '
        'parted where contact or the path is not smooth; three values a sample are decimated. '
        f'For the static formula the approach is {settings.APPROACH * 1e6:g} µm.'
    )


def _tables() -> str:
    head = ['T / °C', '1: α / 10⁻⁵ K⁻¹', '2: H / HRC', '3: µ', 'β expansion', 'β hardness']
    head += ['β friction', 'β0']
    factors = [settings.factor_of(factor) for factor in settings.FACTORS]
    tables = settings.TEMPERATURE_NODES, gcr15.EXPANSION_TABLE, gcr15.HARDNESS_TABLE
    rows = (
        [f'{value:g}' for value in row] + [f'{factor.at(row[0]):.5f}' for factor in factors]
        for row in zip(*tables, gcr15.FRICTION_TABLE, strict=True)
    )
    return _table(head, rows)


def _value(value: Any) -> str:
    value = rounded(value)
    if value is None:
        return '—'
    if isinstance(value, Mapping):
        return '; '.join(
            f'{key}: ({_value(item)})' if isinstance(item, Mapping) else f'{key}: {_value(item)}'
            for key, item in value.items()
        )
    if isinstance(value, list):
        return '[' + ', '.join(_value(item) for item in value) + ']'
    return str(value)


def _table(head: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    return '\n'.join(
        '| ' + ' | '.join(cell.replace('|', '\\|') for cell in cells) + ' |'
        for cells in (head, ['---'] * len(head), *rows)
    )
