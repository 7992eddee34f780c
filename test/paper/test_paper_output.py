# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""What the command writes: files, figures, documentation; and what it refuses."""

from __future__ import annotations

import functools
import json
from pathlib import Path
import pickle
import re

from bearing_twin.cli import main
from bearing_twin.errors import BearingTwinError
from bearing_twin.paper import settings
from bearing_twin.paper.claims.claim import rounded
from bearing_twin.paper.figures.drawings import FIGURES
from bearing_twin.paper.recompute import MARKER, prepare_folder
from bearing_twin.paper.report import figure_name, summary_line
from matplotlib.backends.backend_agg import FigureCanvasAgg
import matplotlib.image
import numpy as np
import pytest

DOCS = Path(__file__).resolve().parents[2] / 'docs' / 'paper.md'
NUMBERS = (*range(4, 11), *range(12, 18), *range(19, 25), *range(27, 31), 32)
FORCE_FIGURES = {
    'expansion': (6, 7, 8),
    'hardness': (13, 14, 15),
    'friction': (20, 21, 22),
    'all': (27,),
}
WATERFALLS = {'expansion': 9, 'hardness': 16, 'friction': 23, 'all': 28}
KEYS = ['id', 'where', 'claim', 'paper_value', 'our_value', 'verdict', 'why']


@pytest.fixture(scope='module')
def drawn(study):
    """Return a function that draws a figure, each once for all tests."""
    return functools.cache(lambda number: FIGURES[number].draw(study))


def test_claims_json_holds_the_claims(folder, claims):
    entries = json.loads((folder / 'claims.json').read_text('utf-8'))
    assert all(list(entry) == KEYS for entry in entries)
    assert [entry['id'] for entry in entries] == list(claims)
    assert [entry['verdict'] for entry in entries] == [c.verdict for c in claims.values()]


def test_report_shows_every_claim_equation_table_and_figure(folder, claims):
    text = (folder / 'report.md').read_text('utf-8')
    for claim in claims.values():
        assert f'| `{claim.id}` |' in text
    for number in range(1, 26):
        assert f'\n| {number} | ' in text
    shown = re.findall(r'\]\((.*?\.png)\)', text)
    assert shown == [figure_name(number) for number in FIGURES]
    assert all((folder / name).exists() for name in shown)
    widths = {line.count(' | ') for line in text.splitlines() if line.startswith('| `')}
    assert len(widths) == 1, 'no cell breaks the table'


def test_every_figure_of_the_paper_is_drawn():
    assert {str(number) for number in NUMBERS} <= set(FIGURES)


@pytest.mark.parametrize('number', list(FIGURES))
def test_figure_is_not_blank(folder, number):
    image = matplotlib.image.imread(folder / figure_name(number))[..., :3]
    assert image.shape[0] >= 500
    assert image.shape[1] >= 800
    inked = (image < 0.95).any(axis=-1)
    assert 0.01 < inked.mean() < 0.9
    rows, columns = np.flatnonzero(inked.any(axis=1)), np.flatnonzero(inked.any(axis=0))
    assert np.ptp(rows) > 0.75 * image.shape[0]
    assert np.ptp(columns) > 0.75 * image.shape[1]
    colourful = (image.max(axis=-1) - image.min(axis=-1)) > 0.2
    assert colourful.mean() > 0.002, 'there are curves, not axes alone'


@pytest.mark.parametrize('number', list(FIGURES))
def test_every_axis_has_its_quantity_and_unit(drawn, number):
    for axes in drawn(number).axes:
        labels = [axes.get_xlabel(), axes.get_ylabel()]
        if hasattr(axes, 'get_zlabel'):
            labels.append(axes.get_zlabel())
        if axes.get_label() == '<colorbar>':
            labels = [axes.get_ylabel()]
        for label in labels:
            assert ' / ' in label, f'figure {number}: {label!r} has no unit'


@pytest.mark.parametrize('number', [6, 7, 8, 13, 14, 15, 20, 21, 22, 27])
def test_force_panels_say_what_their_curves_do(drawn, number):
    factor = next(f for f, numbers in FORCE_FIGURES.items() if number in numbers)
    beta = np.array([settings.factor_of(factor).at(t) for t in settings.TEMPERATURE_NODES])
    for axes in drawn(str(number)).axes:
        force = np.asarray(axes.lines[0].get_ydata())
        rising = np.polyfit(beta, force, 1)[0] > 0.0
        assert ('rises' if rising else 'falls') in axes.get_title()
        assert ('falls' if rising else 'rises') not in axes.get_title()


def test_waterfalls_mark_the_peak_times_and_show_their_ratio_to_20_degc(study, drawn):
    for number in (9, 16, 23, 28):
        axes = drawn(str(number)).axes
        for one in (one for one in axes if one.name == '3d'):
            assert len(one.lines) == 10 + len(settings.PEAK_TIMES)
        flat = [one for one in axes if one.name != '3d']
        assert len(flat) == len(settings.PRESET_NAMES) == len(axes) / 2
        for one, name in zip(flat, settings.PRESET_NAMES, strict=True):
            factor = next(f for f, numbers in WATERFALLS.items() if number == numbers)
            shown = one.lines[len(settings.PEAK_TIMES)].get_ydata()[-1]
            assert shown == pytest.approx(100.0 * study.change(name, factor))


def test_no_waterfall_covers_the_label_of_the_one_on_its_left(drawn):
    figure = drawn('28')
    renderer = FigureCanvasAgg(figure).get_renderer()
    figure.draw(renderer)
    left, right = (axes for axes in figure.axes if axes.name == '3d')
    label = left.zaxis.label.get_window_extent(renderer)
    assert label.width > 5.0
    for pane in (axis.pane for axis in (right.xaxis, right.yaxis, right.zaxis)):
        assert label.x1 < pane.get_window_extent(renderer).x0


def test_documentation_has_the_table_of_the_command(claims):
    """Update it with the output of ``bearing-twin paper --table``."""
    document = DOCS.read_text('utf-8')
    assert f'\n{summary_line(list(claims.values()))}.\n' in document
    rows = re.findall(r'^\| `([\w-]+)` \| (.*) \|$', document, re.MULTILINE)
    found = {name: cells.split(' | ') for name, cells in rows}
    assert list(found) == list(claims)
    for name, claim in claims.items():
        where, text, _, _, verdict = found[name]
        assert (where, text) == (claim.where, claim.claim)
        assert verdict == claim.verdict.replace('_', ' ')


def test_foreign_folder_is_left_alone(tmp_path, capsys):
    (tmp_path / 'report.md').write_text('mine')
    assert main(['paper', '--out', str(tmp_path)]) == 1
    assert '--out' in capsys.readouterr().err
    assert [path.name for path in tmp_path.iterdir()] == ['report.md']
    assert (tmp_path / 'report.md').read_text() == 'mine'


def test_file_in_place_of_the_folder(tmp_path, capsys):
    path = tmp_path / 'file'
    path.write_text('mine')
    assert main(['paper', '--out', str(path)]) == 1
    assert 'is a file' in capsys.readouterr().err
    assert main(['paper', '--out', str(path / 'below')]) == 1
    assert 'cannot write' in capsys.readouterr().err


def test_own_folder_is_written_again(tmp_path):
    folder = tmp_path / 'new' / 'out'
    prepare_folder(folder)
    (folder / 'report.md').write_text('old')
    prepare_folder(folder)
    (folder / MARKER).unlink()
    with pytest.raises(BearingTwinError, match='not empty'):
        prepare_folder(folder)


@pytest.mark.parametrize(
    ('jobs', 'said'), [('0', 'at least one process'), ('1000', 'at most 256 processes')]
)
def test_a_number_of_processes_is_refused_before_a_folder_is_made(jobs, said, tmp_path, capsys):
    assert main(['paper', '--out', str(tmp_path / 'out'), '--jobs', jobs]) == 2
    assert f'--jobs {jobs}: {said}' in capsys.readouterr().err
    assert not (tmp_path / 'out').exists()


def test_the_command_prints_the_claims_that_it_writes(command, folder, claims):
    entries = json.loads((folder / 'claims.json').read_text('utf-8'))
    assert entries == json.loads(json.dumps([claim.to_dict() for claim in claims.values()]))
    assert entries == json.loads((command / 'stdout').read_text('utf-8'))
    assert (command / 'stderr').read_text('utf-8') == '', 'a progress bar is for terminals'


def test_another_process_simulates_the_same_to_the_bit(command):
    """The command has two: no random number, no order of work."""
    (work, jobs), found = pickle.loads((command / 'in_parallel').read_bytes())
    for k, job in enumerate(jobs):
        # The first of each kind, and some.
        if k % 20 == 0 or job[0] is not jobs[k - 1][0]:
            ours = pickle.loads(pickle.dumps(work(job)))
            assert pickle.dumps(ours) == pickle.dumps(found[k]), job


def test_rounding_keeps_six_digits():
    value = {'a': [np.float64(1.23456789), True, np.int64(3)], 'b': (None, 'x')}
    assert rounded(value) == {'a': [1.23457, True, 3], 'b': [None, 'x']}
