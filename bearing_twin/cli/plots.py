# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Pictures of ``--plot``: a diagnosis and a calibration as the report draws them."""

from __future__ import annotations

from pathlib import Path
from textwrap import fill
from typing import TYPE_CHECKING

from bearing_twin.assets.calibration.task import comparison
from bearing_twin.assets.messages import diagnosis_message, spectrum_message
from bearing_twin.dynamics.equations.sensor_path import BAND_HZ
from bearing_twin.view.report.fitted import draw_comparison
from bearing_twin.view.report.spectra import (
    draw_envelope_spectrum,
    draw_spectrum,
    envelope_caption,
)
from bearing_twin.view.report.svg import STYLE
from bearing_twin.view.spectrum import SpectrumPicture
from bearing_twin.view.verdict import title_of
from bearing_twin.wholefile import output_file
import matplotlib as mpl
from matplotlib.figure import Figure

if TYPE_CHECKING:
    from bearing_twin.calibration import Calibration
    from bearing_twin.diagnosis import Diagnosis
    import numpy as np
    from numpy.typing import NDArray


def draw_diagnosis(diagnosis: Diagnosis, path: Path, *, title: str) -> None:
    """Write the spectra of a diagnosis to ``path`` (PNG)."""
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
            upper.supxlabel(fill(envelope_caption(envelope), 120), fontsize='small')
        if spectrum is not None:
            band = envelope.band if envelope is not None else (0.0, 0.0)
            draw_spectrum(lower.subplots(), spectrum, band)
        _save(figure, path)


def draw_calibration(
    found: Calibration, x: NDArray[np.float64], sample_rate: float, path: Path
) -> None:
    """Write machine and twin, and the distribution of the width, to ``path`` (PNG)."""
    spectrum, turns = comparison(found, x, sample_rate)
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(11, 8), layout='constrained')
        *pair, lower = figure.subplots(3, 1)
        figure.suptitle(found.statement)
        steps = BAND_HZ, 1.0 / found.situation.sample_rate
        draw_comparison(pair, (found.spectrum, spectrum), turns, steps, found.sensor_unit)
        width = found.quantities['defect_width_mm']
        # Behind the candidates. It may reach beyond them, since few candidates end too early.
        lower.axvspan(width.q05, width.q95, color='#bbdefb', label='5 to 95 %')
        lower.axvline(width.median, color='#1565c0', dashes=(4, 2), label='median')
        lower.hist(
            found.candidates['defect_width_mm'], bins=40, weights=found.weights,
            color='#424242', label='candidates',
        )  # fmt: skip
        lower.set(xlabel='width of the defect [mm]', ylabel='share of the candidates')
        lower.legend(loc='lower right', bbox_to_anchor=(1.0, 1.0), ncols=3)
        _save(figure, path)


def _save(figure: Figure, path: Path) -> None:
    with output_file(path, folder=True) as file:
        figure.savefig(file, format='png', dpi=110)
