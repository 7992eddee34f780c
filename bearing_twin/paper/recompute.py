# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""From nothing to report.md, claims.json and the figures."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING

from bearing_twin.errors import BearingTwinError
from bearing_twin.paper.figures import FIGURES
from bearing_twin.paper.figures_style import save
from bearing_twin.paper.judge import judge
from bearing_twin.paper.output import prepare_folder
from bearing_twin.paper.report import figure_name, render_report
from bearing_twin.paper.study import run_study
from tqdm import tqdm

if TYPE_CHECKING:
    from pathlib import Path

    from bearing_twin.paper.claims import Claim
    from bearing_twin.paper.study import Study


def recompute(folder: Path, *, processes: int) -> list[Claim]:
    """Recompute the paper into ``folder`` and return the claims."""
    prepare_folder(folder)
    study = run_study(processes=processes)
    try:
        return write_results(folder, study)
    except OSError as error:
        msg = f'cannot write {error.filename or folder}: {error.strerror}; free it, or use --out'
        raise BearingTwinError(msg) from error


def write_results(folder: Path, study: Study) -> list[Claim]:
    """Judge ``study``, write claims.json, the figures and report.md, and return the claims."""
    claims = judge(study)
    data = json.dumps(
        [claim.to_dict() for claim in claims], indent=2, ensure_ascii=False, allow_nan=False
    )
    (folder / 'claims.json').write_text(data + '\n', 'utf-8')
    for number, drawing in tqdm(FIGURES.items(), desc='figures', unit='', ncols=80):
        save(drawing.draw(study), folder / figure_name(number))
    (folder / 'report.md').write_text(render_report(claims), 'utf-8')
    return claims
