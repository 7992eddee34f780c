# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Picture of a diagnosis: its spectra as the report draws them."""

from __future__ import annotations

from textwrap import fill
from types import SimpleNamespace
from typing import TYPE_CHECKING

from bearing_twin.bearing.vocabulary import TITLES
from bearing_twin.view.report.spectra import CAPTION, draw_envelope_spectrum, draw_spectrum
from bearing_twin.view.report.svg import STYLE
from bearing_twin.view.spectrum import SpectrumPicture
from bearing_twin.wholefile import whole_file
import matplotlib as mpl
from matplotlib.figure import Figure

if TYPE_CHECKING:
    from pathlib import Path

    from bearing_twin.diagnosis import Diagnosis, Spectrum


def draw(diagnosis: Diagnosis, path: Path, *, title: str) -> None:
    """Write the picture of a diagnosis to ``path`` (PNG)."""
    envelope = _picture(diagnosis.envelope_spectrum, diagnosis)
    spectrum = _picture(diagnosis.spectrum, diagnosis)
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(11, 7), layout='constrained')
        upper, lower = figure.subfigures(2, 1, height_ratios=[2.0, 1.0])
        figure.suptitle(f'{title}: {TITLES[diagnosis.result]} [{diagnosis.level}]')
        if envelope is not None:
            draw_envelope_spectrum(upper, envelope)
            upper.supxlabel(fill(CAPTION, 120), fontsize='small')
        if spectrum is not None:
            band = envelope.band if envelope is not None else (0.0, 0.0)
            draw_spectrum(lower.subplots(), spectrum, band)
        with whole_file(path) as file:
            figure.savefig(file, format='png', dpi=110)


def _picture(spectrum: Spectrum, diagnosis: Diagnosis) -> SpectrumPicture | None:
    """Prepare a spectrum, which on the wire has the cursors of its diagnosis beside it."""
    message = SimpleNamespace(
        **vars(spectrum),
        **diagnosis.expected._asdict(),
        band_low=spectrum.band[0],
        band_high=spectrum.band[1],
        shaft_hz=diagnosis.shaft_hz,
        first_sample=diagnosis.first_sample,
    )
    return SpectrumPicture.of(message, diagnosis)
