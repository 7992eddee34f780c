# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Files of machines are shown as recordings are."""

from pathlib import Path
import re

from bearing_twin import cli
import numpy as np
import pytest
from scipy.io import savemat, wavfile

pytest.importorskip('bearing_twin_msgs', reason='the message package is not built')

MACHINE = ['--geometry', '9,7.94,39.04,0', '--rpm', '1797']


@pytest.fixture(scope='module')
def folder(tmp_path_factory, data_dir):
    """Return a folder with one record in every format."""
    record = np.load(data_dir / 'cwru' / 'cwru_0105_DE.npz')
    x, folder = record['x'], tmp_path_factory.mktemp('files')
    np.savez(folder / 'fan.npz', x=x, fs=12000.0, rpm=1797.0, bearing_name='6205', unit='g')
    savemat(folder / 'fan.mat', {'X105_DE_time': x[:, None].astype(float)})
    wavfile.write(folder / 'fan.wav', 12000, (x / np.abs(x).max() * 32767).astype(np.int16))
    np.savetxt(folder / 'fan.csv', np.column_stack([np.arange(x.size) / 12000.0, x]),
               delimiter=',', header='time,x', comments='')  # fmt: skip
    return folder


def text_of(page):
    return re.sub(r'\s+', ' ', re.sub('<[^>]+>', ' ', page.read_text()))


@pytest.mark.usefixtures('undrawn')
@pytest.mark.parametrize(
    ('name', 'words'),
    [
        ('fan.npz', []),
        ('fan.mat', ['--channel', 'DE', '--sample-rate', '12000', '--unit', 'g', *MACHINE]),
        ('fan.wav', MACHINE),
        ('fan.csv', ['--channel', 'x', *MACHINE]),
    ],
)
def test_the_page_of_a_file_has_its_verdict_and_no_invented_date(folder, tmp_path, name, words):
    page = tmp_path / 'page.html'
    assert cli.main(['report', str(folder / name), '-o', str(page), *words]) == 0
    text = text_of(page)
    assert f'{folder.name}/{name}' in text
    assert 'Inner race fault' in text
    assert 'Vibration measured' in text
    found = re.search(r'Found ([\d.]+) Hz', text)[1]
    assert float(found) == pytest.approx(161.7, abs=0.3)
    assert '2020-01-01' not in text


def test_a_file_without_a_bearing_is_refused_with_the_remedy(folder, tmp_path, capsys):
    assert cli.main(['report', str(folder / 'fan.wav'), '-o', str(tmp_path / 'page.html')]) == 1
    assert '--bearing' in capsys.readouterr().err


@pytest.mark.usefixtures('undrawn')
def test_a_short_file_and_one_with_a_block_twice_have_verdicts_too(folder, tmp_path):
    with np.load(folder / 'fan.npz') as whole:
        x = whole['x'][:24000].copy()
        # A program may fill what is missing so.
        x[2048:3072] = x[1024:2048]
        np.savez(tmp_path / 'short.npz', **{**whole, 'x': x})
    page = tmp_path / 'page.html'
    assert cli.main(['report', str(tmp_path / 'short.npz'), '-o', str(page)]) == 0
    assert 'Inner race fault' in text_of(page)


def test_files_side_by_side_have_one_scale_and_say_what_they_are(folder, tmp_path):
    reader = pytest.importorskip('rerun.chunk').RrdReader
    with np.load(folder / 'fan.npz') as whole:
        np.savez(tmp_path / 'fan.npz', **{**whole, 'x': 0.1 * whole['x']})
    rrd = tmp_path / 'both.rrd'
    both = [str(folder / 'fan.npz'), str(tmp_path / 'fan.npz')]
    assert cli.main(['view', *both, '--save', str(rrd)]) == 0
    ranges, sources, tops, ends = set(), set(), {}, {}
    store = reader(rrd)
    for chunk in store.stream():
        path, batch = str(chunk.entity_path), chunk.to_record_batch()
        if path.endswith('whole/scale'):
            tops[path] = batch.column('BarChart:values').to_pylist()[0]
            ends[path] = batch.column('BarChart:abscissa').to_pylist()[-1][0]['buffer'][0]
        if path.startswith('/__properties/vibration'):
            named = [name for name in batch.schema.names if 'source' in name]
            sources |= {batch.column(name).to_pylist()[0][0] for name in named}
    for blueprint in store.blueprints():
        for chunk in store.stream(store=blueprint):
            for name, values in chunk.to_record_batch().to_pydict().items():
                if name.startswith('ScalarAxis:range'):
                    ranges.add(tuple(values[0][0]))
    assert sources == {'measured'}
    one, other = tops.values()
    assert one == other
    # The band is narrower than 1000 Hz, but the viewer numbers the axis there and not before.
    assert list(ends.values()) == [pytest.approx(1000.0, rel=0.01)] * 2
    peak = float(np.abs(np.load(folder / 'fan.npz')['x']).max())
    # The scale grows with what is drawn.
    low, high = max(ranges, key=max)
    assert (low, high) == (-high, pytest.approx(peak))


def test_a_page_for_which_nothing_is_there_is_refused(folder, tmp_path, capsys, monkeypatch):
    args = ['view', str(folder / 'fan.npz'), '--save', str(tmp_path / 'a.rrd'), '--page']
    assert cli.main([*args, 'Temperature']) == 1
    said = 'nothing is there to show on the page {}; the pages are Verdict, Vibration'
    assert said.format('Temperature') in capsys.readouterr().err
    with monkeypatch.context() as drawing:
        drawing.setattr('bearing_twin.view.rerun.opening.RerunLogger', None)
        assert cli.main([*args, 'Twin']) == 1
    assert said.format('Twin') in capsys.readouterr().err
    assert cli.main([*args, 'Evidence']) == 0


@pytest.mark.parametrize(
    ('words', 'said'),
    [
        (['report', 'RUN', '--bearing', '6205', '--rpm', '1480'], '--bearing, --rpm: for .npz'),
        (['view', 'RUN', '--channel', 'y', '--save', 'x.rrd'], '--channel: for .npz'),
        (['view', 'RUN', '--at', '3'], '--at: only with --screenshot'),
        (['view', '--live', '--page', 'Twin', '--rpm', '9'], ': not with --live'),
        (['view', 'RUN', '--web-port', '1'], '--web-port: only with --web'),
        (['view', 'RUN', '--web', '--screenshot', 'x.png'], '--web: not with --screenshot'),
    ],
)
def test_what_would_do_nothing_is_refused(words, said, capsys):
    run = str(Path(__file__).resolve().parents[2] / 'recordings' / 'paper_schedule.mcap')
    assert cli.main([run if word == 'RUN' else word for word in words]) == 2
    assert said in capsys.readouterr().err
