# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Vibration in files of other programs, through the command line."""

from __future__ import annotations

from collections.abc import Callable
from datetime import datetime, timedelta, UTC
import json
from pathlib import Path
import re
import sys
from typing import Any

from bearing_twin.cli import main
from bearing_twin.recording.signals.signalfile import read_signal
from bearing_twin.recording.signals.snapshots import read_snapshots, series_files
import h5py
from nptdms import ChannelObject, RootObject, TdmsWriter
import numpy as np
from numpy.typing import NDArray
import pytest
import pyuff

RATE = 25600.0
SHAFT_HZ = 29.95
N = 2 * int(RATE)


def struck(order: float) -> NDArray[np.float64]:
    """Return two seconds of impacts at an order of the shaft in noise, g."""
    x = np.zeros(N)
    x[np.arange(0.0, N, RATE / (order * SHAFT_HZ)).astype(int)] = 1.0
    time = np.arange(400) / RATE
    ring = np.exp(-900.0 * time) * np.sin(2.0 * np.pi * 3300.0 * time)
    return np.convolve(x, ring)[:N] + 0.05 * np.random.default_rng(3).standard_normal(N)


DE = struck(3.5848)
FE = 0.05 * np.random.default_rng(4).standard_normal(N)


def tdms(path: Path) -> None:
    said = {'wf_increment': 1.0 / RATE, 'unit_string': 'g', 'rpm': 60.0 * SHAFT_HZ}
    with TdmsWriter(path) as writer:
        # In two segments, as a measurement writes them.
        for half in (slice(0, N // 2), slice(N // 2, N)):
            writer.write_segment(
                [
                    RootObject({'operator': 'A. B.'}),
                    ChannelObject('Vibration', 'Motor DE', DE[half], said),
                    ChannelObject('Vibration', 'Motor FE', FE[half], said),
                    ChannelObject('Slow', 'Oil', np.ones(9), {'wf_increment': 1.0}),
                    ChannelObject('Slow', 'Remark', ['on', 'off']),
                ]
            )


def data_set(name: str, data: NDArray[Any], **options: Any) -> dict[str, Any]:
    said = {
        'binary': 0, 'id1': name, 'func_type': 1, 'rsp_node': 7, 'rsp_dir': 3, 'ref_node': 0,
        'ref_dir': 0, 'data': data, 'x': np.arange(len(data)) / RATE, 'abscissa_spacing': 1,
        'abscissa_inc': 1.0 / RATE, 'abscissa_min': 0.0, 'abscissa_spec_data_type': 17,
        'ordinate_spec_data_type': 12, 'ordinate_axis_units_lab': 'g',
        'orddenom_spec_data_type': 0,
    }  # fmt: skip
    return pyuff.prepare_58(**{**said, **options})


def uff(path: Path, binary: int = 0) -> None:
    file = pyuff.UFF(str(path))
    for name, data in (('Motor DE', DE), ('Motor FE', FE)):
        file.write_sets(data_set(name, data, binary=binary), 'add')


def unv_by_hand(path: Path) -> None:
    """Write single precision in mm/s^2 without labels: data set 164 tells the unit."""
    units = '    -1\n   164\n         5mm (milli newton)          2\n'
    units += f'{1e3:25.17E}{1e3:25.17E}{1.0:25.17E}\n{273.15:25.17E}\n    -1\n'
    text = [units]
    for name, data in (('Motor DE', DE), ('Motor FE', FE)):
        none = '         0    0    0    0                 NONE                 NONE\n'
        values = [f'{v:13.5E}' for v in 9806.65 * data]
        rows = [''.join(values[k : k + 6]) for k in range(0, N, 6)]
        text.append(
            f'    -1\n    58\n{name}\nNONE\n30-NOV-26 10:00:00\nNONE\nNONE\n'
            '    1         0    0         0       NONE         7   3       NONE         0   0\n'
            f'{2:10}{N:10}{1:10}{0.0:13.5E}{1.0 / RATE:13.5E}{0.0:13.5E}\n'
            f'{17:10}    0    0    0                 NONE                 NONE\n'
            f'{12:10}    0    0    0                 NONE                 NONE\n{none}{none}'
            + '\n'.join(rows)
            + '\n    -1\n'
        )
    path.write_text(''.join(text))


def lvm(
    path: Path,
    *,
    delta: str = f'{1.0 / RATE:.6E}',
    times: bool = True,
    comma: bool = False,
    clock: tuple[str, ...] = ('10:00:00.0', '10:00:01.0'),
    over: str = 'Time',
) -> None:
    """Write parts of a second, each with a header of its own."""
    text = [
        'LabVIEW Measurement\t', 'Writer_Version\t2', 'Reader_Version\t2', 'Separator\tTab',
        f'Decimal_Separator\t{"," if comma else "."}', 'Multi_Headings\tYes',
        f'X_Columns\t{"One" if times else "No"}', 'Time_Pref\tAbsolute', 'Operator\tA. B.',
        'Date\t2026/11/30', 'Time\t10:00:00.0', '***End_of_Header***\t', '\t',
    ]  # fmt: skip
    length = int(RATE)
    for k, time in enumerate(clock):
        text += [
            'Channels\t2\t\t', f'Samples\t{length}\t{length}\t',
            'Date\t2026/11/30\t2026/11/30\t', f'Time\t{time}\t{time}\t', 'Y_Unit_Label\tg\tg\t',
            f'X_Dimension\t{over}\t{over}\t', 'X0\t0.0000000000000000E+0\t0.0\t',
            f'Delta_X\t{delta}\t{delta}\t', '***End_of_Header***\t\t\t',
            'X_Value\tMotor DE\tMotor FE\tComment',
        ]  # fmt: skip
        for n in range(length):
            begin = f'{n / RATE:.6f}' if times else ''
            note = '\tstart' if n == 0 else ''
            text.append(f'{begin}\t{DE[k * length + n]:.9g}\t{FE[k * length + n]:.9g}{note}')
        text.append('')
    joined = '\n'.join(text)
    numbers = joined.replace('.', ',').replace('Separator\t.', 'Separator\t,')
    path.write_text(numbers if comma else joined, newline='\r\n')


def mat(path: Path) -> None:
    """Write the layout of MATLAB 7.3: 512 bytes of header, the last axis first, classes."""
    with h5py.File(path, 'w', userblock_size=512) as file:
        group = file.create_group('record')
        group.attrs['MATLAB_class'] = np.bytes_('struct')
        values = {'Motor_DE': DE[None, :], 'Motor_FE': FE[None, :], 'fs': [[RATE]]}
        for name, value in {**values, 'rpm': [[60.0 * SHAFT_HZ]]}.items():
            data = group.create_dataset(name, data=value, compression='gzip')
            data.attrs['MATLAB_class'] = np.bytes_('double')
        letters = np.array([[ord('g')]], np.uint16)
        data = group.create_dataset('unit', data=letters)
        data.attrs['MATLAB_class'] = np.bytes_('char')
        cell = file.create_dataset('note', (1, 2), dtype=h5py.ref_dtype)
        cell.attrs['MATLAB_class'] = np.bytes_('cell')
        file['loop'] = file['/']
        file['elsewhere'] = h5py.ExternalLink('/etc/hostname', '/x')
    header = b'MATLAB 7.3 MAT-file, Platform: GLNXA64'.ljust(124) + b'\x00\x02IM'
    with path.open('r+b') as opened:
        opened.write(header)


def npy(path: Path) -> None:
    np.save(path, np.column_stack((DE, FE)))


MADE: dict[str, Callable[[Path], None]] = {
    'a.tdms': tdms,
    'a.uff': uff,
    'binary.uff': lambda path: uff(path, binary=1),
    'a.unv': unv_by_hand,
    'a.lvm': lvm,
    'comma.lvm': lambda path: lvm(path, comma=True, times=False),
    'a.mat': mat,
    'a.npy': npy,
}


def answer(capsys: pytest.CaptureFixture[str], *words: object) -> dict[str, Any]:
    assert main(['diagnose', *map(str, words), '--json']) == 0
    return json.loads(capsys.readouterr().out)


@pytest.mark.parametrize('name', MADE)
def test_a_file_gives_the_verdict_of_its_samples(
    name: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    MADE[name](tmp_path / name)
    assert main(['diagnose', '--channels', str(tmp_path / name)]) == 0
    listed = capsys.readouterr().out
    de, fe = ('x:0', 'x:1') if name == 'a.npy' else ('DE', 'FE')
    assert de in listed and fe in listed
    # A NumPy array states nothing else.
    given = ['--unit', 'g', '--sample-rate', RATE] if name == 'a.npy' else []
    given += [] if name in ('a.tdms', 'a.mat') else ['--rpm', 60.0 * SHAFT_HZ]
    said = answer(capsys, tmp_path / name, '--bearing', '6205', '--channel', de, *given)
    assert said['result'] == 'outer'
    assert f'2 s at {RATE:g} Hz' in said['source']
    np.savez(tmp_path / 'b.npz', x=DE, fs=RATE, rpm=60.0 * SHAFT_HZ, unit='g')
    same = answer(capsys, tmp_path / 'b.npz', '--bearing', '6205')
    levels = [found['evidence']['severity']['velocity_rms'] for found in (said, same)]
    assert levels[0] == pytest.approx(levels[1], rel=1e-4)
    signal = read_signal(tmp_path / name, channel=fe, sample_rate=RATE)
    factor = 9.80665 if signal.unit == 'm/s^2' else 1.0
    np.testing.assert_allclose(signal.x, factor * FE, rtol=1e-4, atol=1e-7)


def refused(capsys: pytest.CaptureFixture[str], path: Path, *words: str) -> str:
    assert main(['diagnose', str(path), '--bearing', '6205', '--rpm', '1797', *words]) == 1
    return capsys.readouterr().err


def test_what_is_no_vibration_over_time_is_refused_with_the_remedy(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    spectrum = data_set('Motor DE', DE[:99], func_type=2, abscissa_spec_data_type=18)
    pyuff.UFF(str(tmp_path / 'a.uff')).write_sets(spectrum, 'add')
    assert 'Motor DE 7+Z: auto spectrum (type 2)); export the time history (type 1)' in refused(
        capsys, tmp_path / 'a.uff'
    )
    (tmp_path / 'b.uff').write_text('    -1\n    15\n    -1\n')
    assert 'no time record among its 0 data sets 58; export' in refused(capsys, tmp_path / 'b.uff')
    with TdmsWriter(tmp_path / 'a.tdms') as writer:
        over = {'wf_increment': 1.0, 'wf_xunit_string': 'Hz'}
        writer.write_segment([ChannelObject('g', 'FFT', DE[:99], over)])
        writer.write_segment([ChannelObject('g', 'None', np.zeros(0))])
    assert 'FFT is a spectrum, over Hz; None has 0 values of type' in refused(
        capsys, tmp_path / 'a.tdms'
    )
    with TdmsWriter(tmp_path / 'b.tdms') as writer:
        writer.write_segment([RootObject({'operator': 'A. B.'})])
    assert 'it has no channel; export the time record' in refused(capsys, tmp_path / 'b.tdms')
    lvm(tmp_path / 'a.lvm', over='Frequency', clock=('10:00:00',))
    assert 'over Frequency, Frequency, and not over time' in refused(capsys, tmp_path / 'a.lvm')
    (tmp_path / 'b.lvm').write_text('time\tacc\n0\t1\n')
    assert 'give a table of another program the ending .txt' in refused(capsys, tmp_path / 'b.lvm')
    with h5py.File(tmp_path / 'a.mat', 'w') as file:
        file.create_dataset('data', (1, 2), dtype=h5py.ref_dtype)
        table = file.create_dataset('log', data=np.zeros((1, 6), np.uint32))
        table.attrs['MATLAB_object_decode'] = 3
        file.create_dataset('outside', (N,), 'f8', external=[('/dev/zero', 0, 8 * N)])
    assert 'data, log, outside is no array of numbers but a cell, a table' in refused(
        capsys, tmp_path / 'a.mat'
    )
    np.save(tmp_path / 'a.npy', np.array([print, DE], dtype=object), allow_pickle=True)
    assert 'a.npy holds Python objects, which are never loaded' in refused(
        capsys, tmp_path / 'a.npy'
    )


def test_what_would_unpack_to_too_much_is_refused_before(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    with h5py.File(tmp_path / 'a.mat', 'w') as file:
        file.create_dataset('x', (200_000_000,), 'f8', chunks=(1000,), compression='gzip')
    assert 'holds 200000000 values; at most 134217728 are read: cut' in refused(
        capsys, tmp_path / 'a.mat'
    )


@pytest.mark.parametrize(
    ('library', 'name'), [('h5py', 'a.mat'), ('nptdms', 'a.tdms'), ('pyuff', 'a.uff')]
)
def test_a_missing_library_is_named(
    library: str, name: str, tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch
) -> None:
    MADE[name](tmp_path / name)
    monkeypatch.setitem(sys.modules, library, None)
    said = refused(capsys, tmp_path / name)
    assert f"reading it needs {library}: pip install {library}, or 'bearing_twin[files]'" in said


@pytest.mark.parametrize(('make', 'name'), [(tdms, 'a.tdms'), (uff, 'a.uff')])
def test_a_file_that_is_cut_off_is_said_to_be(
    make: Callable[[Path], None], name: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    make(tmp_path / name)
    content = (tmp_path / name).read_bytes()
    (tmp_path / name).write_bytes(content[: len(content) * 3 // 4])
    words = ('--bearing', '6205', '--channel', 'DE', '--json')
    assert main(['diagnose', str(tmp_path / name), *words]) == 0
    said = capsys.readouterr()
    assert re.search(r'Motor DE( 7\+Z)? \(the file ends before its header says\)', said.out)
    assert said.err == ''


def test_a_text_of_matlab_may_be_of_any_characters(tmp_path: Path) -> None:
    mat(tmp_path / 'a.mat')
    with h5py.File(tmp_path / 'a.mat', 'r+') as file:
        # A character of two units, half a one, and one that is none.
        file['label'] = np.array([[0xD83D], [0xDE00], [0xD83D], [0xFFFF0041]], np.uint32)
        file['label'].attrs['MATLAB_class'] = np.bytes_('char')
    assert read_signal(tmp_path / 'a.mat').label == '\U0001f600\ufffdA'


def test_parts_of_a_labview_measurement_are_joined_as_far_as_their_times_continue(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / 'a.lvm'
    lvm(path, clock=('23:59:59.5', '00:00:00.5'))
    whole = read_signal(path, channel='Motor DE')
    np.testing.assert_allclose(whole.x, DE, rtol=1e-8)
    assert whole.source.endswith('Motor DE')
    lvm(path, clock=('10:00:00.0', '10:00:01.1'))
    part = read_signal(path, channel='Motor DE')
    np.testing.assert_allclose(part.x, DE[: N // 2], rtol=1e-8)
    assert part.source.endswith('(the longest of 2 parts without a gap)')


def test_columns_of_a_labview_measurement_have_their_own_times_and_lengths(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / 'a.lvm'
    head = 'LabVIEW Measurement\nSeparator\tTab\nX_Columns\tMulti\n***End_of_Header***\n\n'
    head += 'Channels\t3\nY_Unit_Label\tV\t\tg\t\tg\nDelta_X\t1.000E-3\t\t2.000E-3\t\t1.0\n'
    head += '***End_of_Header***\nX_Value\tspeed\tX_Value\tDE\tX_Value\tnone\tComment\n'
    rows = [f'{k / 1e3:.6f}\t{k % 3}.5\t{k / 500:.6f}\t{DE[k]:.9g}\t\t\tok' for k in range(300)]
    rows += [f'{k / 1e3:.6f}\t{k % 3}.5' for k in range(300, 600)]
    path.write_text(head + '\n'.join(rows))
    signal = read_signal(path, channel='DE')
    assert (signal.sample_rate, signal.unit) == (500.0, 'g')
    np.testing.assert_allclose(signal.x, DE[:300], rtol=1e-8)
    speed = read_signal(path, channel='speed')
    assert (speed.sample_rate, speed.unit, len(speed.x)) == (1000.0, 'V', 600)
    assert main(['diagnose', '--channels', str(path)]) == 0
    assert 'none' not in capsys.readouterr().out
    # Where a program writes when it comes to it, Delta_X is not the rate.
    path.write_text(head + '\n'.join(rows[:100] + rows[103:300]))
    assert 'have gaps, or too few digits' in refused(capsys, path, '--channel', 'DE')


def test_a_rate_of_too_few_digits_is_asked_for(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / 'a.lvm'
    lvm(path, delta='0.000039', times=False)
    assert 'its Delta_X 0.000039 has too few digits; give the rate in Hz' in refused(capsys, path)
    lvm(path, delta='0.000039')
    assert read_signal(path).sample_rate == pytest.approx(RATE, rel=1e-5)


@pytest.mark.parametrize(
    ('there', 'instead', 'said'),
    [
        (
            'Delta_X\t3.9',
            'Delta_X\tO.9',
            r"'O.906250E-05' as Delta_X of column 1; write the time f",
        ),
        ('Delta_X\t3.9', 'Delta_X\tsNaN3.9', r"'sNaN3.906250E-05' as Delta_X of column 1; write"),
        ('X0\t0.0', 'X0\tinf', r"'inf.*' as X0 of column 1; write the time of the first sample"),
        (
            'Time\t10:00:01',
            'Time\tten',
            r"'ten.0' as Time of a part; write hours, minutes and sec",
        ),
        (
            '0.000195\t',
            'late\t',
            r"row 6 below its headings is 'late\\t-.*'; fill or remove fields",
        ),
    ],
)
def test_a_field_of_a_labview_measurement_that_is_no_number_is_named(
    there: str, instead: str, said: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / 'a.lvm'
    lvm(path)
    path.write_text(path.read_text().replace(there, instead))
    assert re.search(said, refused(capsys, path, '--channel', 'DE'))


@pytest.mark.parametrize('delta', ['0', '-1', '1E-999'])
def test_a_step_that_is_none_is_no_rate(
    delta: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    lvm(tmp_path / 'a.lvm', delta=delta, times=False)
    assert 'does not say its sample rate' in refused(capsys, tmp_path / 'a.lvm')


def test_times_beside_the_channels_of_a_tdms_give_the_rate(tmp_path: Path) -> None:
    stamps = np.datetime64('2026-11-30T10:00:00') + np.arange(N) * np.timedelta64(1000, 'us')
    for name, times in (('Time', np.arange(N) / 1000.0), ('clock', stamps)):
        with TdmsWriter(tmp_path / 'a.tdms') as writer:
            writer.write_segment([ChannelObject('g', name, times), ChannelObject('g', 'DE', DE)])
        assert read_signal(tmp_path / 'a.tdms').sample_rate == pytest.approx(1000.0)


def test_uneven_times_of_a_universal_file_give_no_rate(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    times = np.arange(N) / RATE
    for name, x in (('even', times), ('gap', times + (times > 1.0))):
        said = data_set('DE', DE, abscissa_spacing=0, x=x)
        pyuff.UFF(str(tmp_path / f'{name}.uff')).write_sets(said, 'add')
    assert read_signal(tmp_path / 'even.uff').sample_rate == pytest.approx(RATE, rel=1e-4)
    assert 'have gaps, or too few digits' in refused(capsys, tmp_path / 'gap.uff')


def test_files_of_every_kind_are_snapshots_of_a_series(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    for k, (name, make) in enumerate(sorted(MADE.items())):
        if name != 'a.npy':
            make(tmp_path / f'2026-11-{k + 10}_10-00-00{Path(name).suffix}')
    words = ['--series', '--channel', 'DE', '--bearing', '6205', '--rpm', '1797', '--json']
    assert main(['diagnose', str(tmp_path), *words]) == 0
    assert 'outer' in capsys.readouterr().out


def test_snapshots_are_as_far_apart_as_the_clocks_in_their_files(tmp_path: Path) -> None:
    """The names have no times, or other ones."""
    begin = datetime(2026, 11, 30, 10, tzinfo=UTC)
    for hours in range(3):
        time = begin + timedelta(hours=hours)
        # The first one of the channels counts; one that was never set does not.
        starts = [np.datetime64(v, 's') for v in ('1904-01-01', f'{time:%Y-%m-%dT%H:%M}')]
        with TdmsWriter(tmp_path / f'{9 - hours}.tdms') as writer:
            said = {'wf_increment': 1.0 / RATE}
            for name, start in zip(('none', 'DE'), starts, strict=True):
                properties = {**said, 'wf_start_time': start}
                writer.write_segment([ChannelObject('g', name, DE[:99], properties)])
        for binary, name in enumerate((f'2020-01-0{9 - hours}_10-00-00.uff', f'{9 - hours}.unv')):
            dated = data_set('DE', DE[:99], binary=binary, id3=f'{time:%d-%b-%y %H:%M:%S}'.upper())
            pyuff.UFF(str(tmp_path / name)).write_sets(dated, 'add')
        lvm(tmp_path / f'{9 - hours}.lvm', clock=(f'{time:%H:%M:%S}.25',))
    for kind, fraction in (('tdms', 0.0), ('uff', 0.0), ('unv', 0.0), ('lvm', 0.25)):
        files = series_files(sorted(tmp_path.glob(f'*.{kind}')))
        times = [shot.time for shot in read_snapshots(files, channel='DE')]
        assert times == [begin.timestamp() + 3600.0 * hours + fraction for hours in range(3)], kind
        fixed = [shot.time for shot in read_snapshots(files, channel='DE', cycle=5.0)]
        assert fixed == [0.0, 5.0, 10.0]
    lvm(tmp_path / 'a.lvm', clock=('10:00:00.0',))
    text = (tmp_path / 'a.lvm').read_text()
    (tmp_path / 'a.lvm').write_text(text.replace('Date\t2026/11/30\t', 'Date\t1904/01/01\t'))
    assert next(read_snapshots([tmp_path / 'a.lvm'], channel='DE')).time == begin.timestamp()
    lvm(tmp_path / '2026-12-01_00-00-00.lvm', clock=('?',), delta='1')
    text = (tmp_path / '2026-12-01_00-00-00.lvm').read_text()
    (tmp_path / '2026-12-01_00-00-00.lvm').write_text(text.replace('Time\t', 'Time\t?'))
    named = read_snapshots([tmp_path / '2026-12-01_00-00-00.lvm'], channel='DE')
    assert next(named).time == datetime(2026, 12, 1, tzinfo=UTC).timestamp()
