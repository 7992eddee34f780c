# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Recompute the paper: write report.md, claims.json and the figures."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING

from bearing_twin.errors import BearingTwinError
from bearing_twin.paper.claims.frequency import frequency_claims
from bearing_twin.paper.claims.general import general_claims
from bearing_twin.paper.claims.material import material_claims
from bearing_twin.paper.claims.model import model_claims
from bearing_twin.paper.claims.peaks import peak_claims
from bearing_twin.paper.claims.shift import shift_claims
from bearing_twin.paper.claims.trend import trend_claims
from bearing_twin.paper.figures.drawings import FIGURES
from bearing_twin.paper.figures.style import save
from bearing_twin.paper.report import figure_name, render_report
from bearing_twin.paper.study import run_study
from tqdm import tqdm

if TYPE_CHECKING:
    from bearing_twin.paper.claims.claim import Claim
    from bearing_twin.paper.study import Study


MARKER = '.bearing-twin-paper'
"""Marker file of a folder that this command wrote."""


def prepare_folder(folder: Path) -> None:
    """Create ``folder``, or accept it if it is empty or was written by this command."""
    try:
        if folder.is_file():
            raise BearingTwinError(f'{folder} is a file; give a folder with --out')
        if folder.exists() and any(folder.iterdir()) and not (folder / MARKER).exists():
            raise BearingTwinError(
                f'{folder} is not empty and was not written by this command; give a new folder '
                'with --out, or empty it'
            )
        folder.mkdir(parents=True, exist_ok=True)
        (folder / MARKER).write_text('Files here are rewritten by bearing-twin paper.\n', 'utf-8')
    except OSError as error:
        msg = f'cannot write {folder}: {error.strerror}; give another folder with --out'
        raise BearingTwinError(msg) from error


def recompute(folder: Path, *, processes: int) -> list[Claim]:
    """Recompute the paper into ``folder`` and return the claims."""
    prepare_folder(folder)
    study = run_study(processes=processes)
    try:
        return write_results(folder, study)
    except OSError as error:
        msg = f'cannot write {error.filename or folder}: {error.strerror}; free it, or use --out'
        raise BearingTwinError(msg) from error


def judge(study: Study) -> list[Claim]:
    """Return every claim with its verdict, in the order of the report."""
    return [
        *frequency_claims(study),
        *shift_claims(study),
        *peak_claims(study),
        *trend_claims(study),
        *general_claims(study),
        *material_claims(),
        *model_claims(study),
    ]


def write_results(folder: Path, study: Study) -> list[Claim]:
    """Judge ``study``, write claims.json, the figures and report.md, and return the claims."""
    claims = judge(study)
    data = json.dumps(
        [claim.to_dict() for claim in claims], indent=2, ensure_ascii=False, allow_nan=False
    )
    (folder / 'claims.json').write_text(data + '\n', 'utf-8')
    for number, drawing in tqdm(FIGURES.items(), desc='figures', unit='', ncols=80, disable=None):
        save(drawing.draw(study), folder / figure_name(number))
    (folder / 'report.md').write_text(render_report(claims), 'utf-8')
    return claims
