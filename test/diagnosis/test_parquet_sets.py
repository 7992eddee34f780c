# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""A data set in Parquet, as bearing-datasets writes it: diagnosed, scored, shown."""

import base64
import io
import json
import os
import shutil
import zlib

from bearing_twin.bearing import fault_orders, find_bearing
from bearing_twin.bench.diagnosis import fault_signal, RATE, SHAFT_HZ
from bearing_twin.cli import main
from bearing_twin.errors import BearingTwinError
from bearing_twin.recording.signals import dataset
from bearing_twin.recording.signals.signalfile import read_signal
from commands import json_lines
import numpy as np
import pytest


@pytest.fixture(scope='module')
def parquet_set(tmp_path_factory):
    """Return a data set of three signals as bearing-datasets 0.3 writes it (layout 2)."""
    import pyarrow as pa
    from pyarrow import parquet

    folder = tmp_path_factory.mktemp('root') / 'rig'
    (folder / 'signals').mkdir(parents=True)
    noise = np.random.default_rng(2).standard_normal(len(fault_signal(4.0)))
    signals = {'r0/DE': fault_signal(4.0), 'r0/FE': noise, 'r1/DE': noise[::-1]}
    table = pa.table(
        {
            'signal_id': list(signals),
            'signal': pa.array([x.astype(np.float32) for x in signals.values()],
                               pa.list_(pa.float32())),
        }
    )  # fmt: skip
    parquet.write_table(
        table, folder / 'signals' / 'part-float32.parquet', compression='zstd', row_group_size=2
    )
    orders = fault_orders(find_bearing('6307'))._asdict()
    labels = ['inner', 'inner', 'normal']
    columns = {
        'dataset': ['rig'] * 3, 'signal_id': list(signals), 'recording_id': ['r0', 'r0', 'r1'],
        'native_label': labels, 'channel': ['DE', 'FE', 'DE'], 'sensor_location': ['base'] * 3,
        'fs': [RATE] * 3, 'n_samples': [len(noise)] * 3, 'fault_type': labels,
        'fault_location': ['test_bearing', 'test_bearing', 'none'],
        'sensor_at_fault': [False] * 3,
        'signal_file': ['part-float32.parquet'] * 3, 'signal_row_group': [0, 0, 1],
        'signal_row': [0, 1, 0], 'quantity': ['acceleration'] * 3, 'unit': ['g', 'g', 'V'],
        'sensitivity': ['none', 'none', '10 V/g'],
        'speed_profile': ['constant', 'constant', 'increasing'],
        'speed_rpm': [60.0 * SHAFT_HZ] * 3, 'bearing_model': ['of our own'] * 3,
        **{name: [round(order, 5)] * 3 for name, order in orders.items()},
        # Python has no such times without pandas.
        'start': pa.array([1, 2, 3], pa.timestamp('ns')),
    }  # fmt: skip
    parquet.write_table(pa.table(columns), folder / 'metadata.parquet')
    manifest = {'dataset': 'rig', 'schema_version': 2, 'n_recordings': 2, 'n_signals': 3}
    (folder / 'manifest.json').write_text(json.dumps(manifest))
    return folder


def test_parquet_form_of_bearing_datasets(parquet_set, capsys):
    assert main(['diagnose', str(parquet_set), '--json', '--jobs', '1']) == 0
    answers = json_lines(capsys)
    assert [answer['result'] for answer in answers] == ['inner', 'healthy', 'insufficient']
    assert [answer['channel'] for answer in answers] == ['r0/DE', 'r0/FE', 'r1/DE']
    assert {answer['evidence']['severity']['unit'] for answer in answers} == {'g'}
    assert 'the shaft speed is unknown' in answers[2]['reasons'][0]
    assert main(['diagnose', str(parquet_set), '--jobs', '1']) == 0
    assert 'rig, r0/FE: healthy' in capsys.readouterr().out
    assert main(['diagnose', str(parquet_set), '--channel', 'r0/DE']) == 0
    assert 'rig, r0/DE' in capsys.readouterr().out
    assert main(['diagnose', str(parquet_set), '--channels']) == 0
    assert capsys.readouterr().out.split()[1:] == ['r0/DE', 'r0/FE', 'r1/DE']
    assert main(['benchmark', str(parquet_set), '--full', '--jobs', '1']) == 0
    said = capsys.readouterr()
    assert '| rig | 2 | 1 |  |  |  |  | 1 |' in said.out
    assert '1 signals are left out: they are without a fault of ours or a constant' in said.err
    (parquet_set.parent / 'bad').mkdir()
    (parquet_set.parent / 'bad' / 'metadata.parquet').write_bytes(b'PAR1 no')
    assert main(['diagnose', str(parquet_set.parent / 'bad')]) == 1
    assert 'cannot be read as Parquet' in capsys.readouterr().err


def test_a_damaged_text_of_a_parquet_set_is_refused(parquet_set, tmp_path, capsys):
    import pyarrow as pa
    from pyarrow import parquet

    table = parquet.read_table(parquet_set / 'metadata.parquet')
    texts = pa.StringArray.from_buffers(
        3, pa.py_buffer(np.array([0, 1, 2, 3], np.int32)), pa.py_buffer(b'g\xffV')
    )
    changed = table.set_column(table.column_names.index('unit'), 'unit', texts)
    parquet.write_table(changed, tmp_path / 'metadata.parquet')
    assert main(['diagnose', str(tmp_path)]) == 1
    assert 'metadata.parquet cannot be read as Parquet' in capsys.readouterr().err


@pytest.mark.parametrize(
    ('column', 'values', 'why'),
    [
        ('signal_row_group', [None, 0, 1], 'has no signal r0/DE in row 0 of group None'),
        ('signal_row_group', [2**62, 0, 1], f'has no signal r0/DE in row 0 of group {2**62}'),
        ('signal_row', ['a', '1', '0'], 'has no signal r0/DE in row a of group 0'),
        ('signal_row', [-1, 1, 0], 'has no signal r0/DE in row -1 of group 0 (rows count from 0)'),
        ('signal_id', [['a'], ['a'], ['b']], 'has one signal_id twice'),
        ('signal_id', ['r0/DE', 'r0/DE', 'r1/DE'], 'has one signal_id twice'),
    ],
)
def test_a_parquet_set_that_contradicts_itself(parquet_set, tmp_path, capsys, column, values, why):
    import pyarrow as pa
    from pyarrow import parquet

    shutil.copytree(parquet_set, tmp_path / 'rig')
    table = parquet.read_table(parquet_set / 'metadata.parquet')
    index = table.column_names.index(column)
    parquet.write_table(
        table.set_column(index, column, pa.array(values)), tmp_path / 'rig' / 'metadata.parquet'
    )
    assert main(['diagnose', str(tmp_path / 'rig'), '--jobs', '1']) == 1
    assert why in capsys.readouterr().err


@pytest.mark.parametrize('samples', ['texts', 'times', 'a pipe'])
def test_samples_of_a_parquet_set_that_are_none_are_refused(parquet_set, tmp_path, samples):
    import pyarrow as pa
    from pyarrow import parquet

    folder = tmp_path / 'rig'
    shutil.copytree(parquet_set, folder)
    path = folder / 'signals' / 'part-float32.parquet'
    path.unlink()
    if samples == 'a pipe':
        os.mkfifo(path)
    else:
        kind = pa.string() if samples == 'texts' else pa.timestamp('ms')
        rows = [['1', '2']] if samples == 'texts' else [[1, 2]]
        table = pa.table({'signal': pa.array(rows * 3, pa.list_(kind))})
        parquet.write_table(table, path, row_group_size=2)
    said = 'is no file but a pipe' if samples == 'a pipe' else 'the signal r1/DE holds'
    # Of this signal the unit is V, so that its samples are multiplied.
    with pytest.raises(BearingTwinError, match=said) as refusal:
        read_signal(folder, channel='r1/DE')
    assert str(path) in str(refusal.value)


@pytest.mark.parametrize('said', ['1.2.3 mV/g', '. V/g', '0.0 V/g', '10 V/(mm/s)', 'none', None])
def test_volts_of_a_sensitivity_that_tells_no_acceleration_have_no_unit(said):
    assert dataset._physical({'unit': 'V', 'sensitivity': said}) == (1.0, '')


def test_one_signal_of_a_parquet_set_is_shown_as_a_file_is(parquet_set, tmp_path, capsys):
    page = tmp_path / 'page.html'
    assert main(['report', str(parquet_set), '--channel', 'r0/DE', '-o', str(page)]) == 0
    assert 'Inner race fault' in page.read_text()
    assert main(['report', str(parquet_set), '-o', str(page)]) == 1
    assert 'r0/DE, r0/FE, r1/DE' in capsys.readouterr().err


def test_parquet_form_is_what_the_package_itself_reads(parquet_set):
    bearing_datasets = pytest.importorskip('bearing_datasets', reason='pip install it')
    from bearing_datasets.schema import validate

    theirs = bearing_datasets.open('rig', root=parquet_set.parent)
    validate(theirs.metadata(), {'start': 'a column that only this set has'})
    for name in ('r0/DE', 'r1/DE'):
        ours = read_signal(parquet_set, channel=name)
        np.testing.assert_allclose(ours.x, theirs.signal(name, unit='g'), rtol=1e-14)


def test_parquet_of_newer_writers_is_read():
    """Arrow from 19.0.1 on leaves out the counts of levels that plain columns do not have."""
    from pyarrow import parquet

    # A column 'signal_id' with one value 'a', by Arrow 26.
    written = (
        'eNpNTzsKwkAUnF3ComKhgReysEUalxRJMIJWNvYW4gVk0aABP3Hj50oe0xcri2lmhvlsVtuSAhrQYE2SEAICgCNQ'
        'SGHG1IgUKbNAKlws3HjMquwghAQFOpsjVu3+VF0cMTGcyLjf1serO+/qwwRrw95IaqONhaGhnkON9J+FWI185G1h'
        'e/8tOuNV6CLBEySWHKK0/XWzX9pe5JEmjfP3Z/XI902TO+9v7+RV+ba+XZPZopgWpTbdgA9jw0e/sXIlhQ=='
    )
    table = parquet.read_table(io.BytesIO(zlib.decompress(base64.b64decode(written))))
    assert table.to_pydict() == {'signal_id': ['a']}
