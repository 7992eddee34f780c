# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Picture of a diagnosis: its spectra as the report draws them."""

from __future__ import annotations

from textwrap import fill
from typing import TYPE_CHECKING

from bearing_twin.assets.messages import diagnosis_message, spectrum_message
from bearing_twin.view.report.spectra import CAPTION, draw_envelope_spectrum, draw_spectrum
from bearing_twin.view.report.svg import STYLE
from bearing_twin.view.spectrum import SpectrumPicture
from bearing_twin.view.verdict import title_of
from bearing_twin.wholefile import whole_file
import matplotlib as mpl
from matplotlib.figure import Figure

if TYPE_CHECKING:
    from pathlib import Path

    from bearing_twin.diagnosis import Diagnosis


def draw(diagnosis: Diagnosis, path: Path, *, title: str) -> None:
    """Write the picture of a diagnosis to ``path`` (PNG)."""
    verdict = diagnosis_message(diagnosis, stamp=0, frame_id='', bearing='')
    envelope, spectrum = (
        SpectrumPicture.of(spectrum_message(values, diagnosis, stamp=0, frame_id=''), verdict)
        for values in (diagnosis.envelope_spectrum, diagnosis.spectrum)
    )
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(11, 7), layout='constrained')
        upper, lower = figure.subfigures(2, 1, height_ratios=[2.0, 1.0])
        figure.suptitle(f'{title}: {title_of(verdict)} [{diagnosis.level}]')
        if envelope is not None:
            draw_envelope_spectrum(upper, envelope)
            upper.supxlabel(fill(CAPTION, 120), fontsize='small')
        if spectrum is not None:
            band = envelope.band if envelope is not None else (0.0, 0.0)
            draw_spectrum(lower.subplots(), spectrum, band)
        with whole_file(path) as file:
            figure.savefig(file, format='png', dpi=110)
