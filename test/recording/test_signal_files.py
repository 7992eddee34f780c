# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Signals of other people's files."""

from __future__ import annotations

from datetime import datetime, timedelta
from io import BytesIO
import math
from pathlib import Path
import pickle
from typing import Any
import warnings
import zipfile
import zlib

from bearing_twin.errors import BearingTwinError
from bearing_twin.recording.signals.signalfile import channels, read_signal
from bearing_twin.recording.signals.snapshots import read_snapshots, series_files
from bearing_twin.recording.writer import RecordingWriter
import numpy as np
import pytest
from recording_samples import (
    BLOCK,
    header,
    NANO,
    PERIOD,
    put_block,
    RATE,
    START,
    store,
    write_blocks,
)
from scipy.io import loadmat, savemat, wavfile

X = np.random.default_rng(1).normal(size=5000)
IMU = 'sensor_msgs/msg/Imu'


@pytest.fixture
def csv(tmp_path: Path) -> Path:
    """Return where a test writes its text of numbers."""
    return tmp_path / 'a.csv'


def test_npz_of_the_real_recordings(data_dir: Path) -> None:
    path = data_dir / 'cwru' / 'cwru_0130_DE.npz'
    signal = read_signal(path)
    with np.load(path) as arrays:
        np.testing.assert_array_equal(signal.x, arrays['x'].astype(float))
        assert signal.sample_rate == arrays['fs']
        assert signal.shaft_hz == pytest.approx(arrays['rpm'] / 60.0)
    assert signal.label == 'outer'
    assert signal.bearing_name.startswith('SKF 6205')
    assert math.isnan(signal.temperature)


def test_npz_with_snapshots_needs_a_row(data_dir: Path) -> None:
    path = data_dir / 'femto' / 'femto_Bearing3_1_H.npz'
    with pytest.raises(BearingTwinError, match='choose one'):
        read_signal(path)
    with np.load(path) as arrays:
        np.testing.assert_array_equal(read_signal(path, channel='5').x, arrays['x'][5])
        np.testing.assert_array_equal(read_signal(path, channel='x:7').x, arrays['x'][7])


def test_mat_as_cwru_gives_it(tmp_path: Path) -> None:
    path = tmp_path / '130.mat'
    variables = {'X130_DE_time': X[:, None], 'X130_FE_time': X[:100, None], 'X130RPM': 1796.0}
    for compress in (False, True):
        savemat(path, variables, do_compression=compress)
        with pytest.raises(BearingTwinError, match='does not say its sample rate'):
            read_signal(path)
        signal = read_signal(path, sample_rate=12000.0)
        np.testing.assert_array_equal(signal.x, X)
        assert signal.shaft_hz == pytest.approx(1796.0 / 60.0)
        other = read_signal(path, channel='FE_time', sample_rate=12000.0)
        np.testing.assert_array_equal(other.x, X[:100])


def test_mat_as_mfpt_gives_it(tmp_path: Path) -> None:
    path = tmp_path / 'bearing.mat'
    savemat(path, {'bearing': {'sr': 48828.0, 'rate': 25.0, 'load': 200.0, 'gs': X[:, None]}})
    signal = read_signal(path)
    np.testing.assert_array_equal(signal.x, X)
    assert signal.sample_rate == 48828.0


def test_mat_of_version_4(tmp_path: Path) -> None:
    path = tmp_path / 'old.mat'
    savemat(path, {'x': X, 'fs': 8000.0}, format='4')
    np.testing.assert_array_equal(read_signal(path).x, X)


@pytest.mark.parametrize(('dtype', 'bits'), [('f4', 0x7FA00000), ('f8', 0x7FF4000000000000)])
def test_damaged_samples_are_nan_without_a_warning(tmp_path: Path, dtype: str, bits: int) -> None:
    samples = np.zeros(100, dtype)
    samples.view(dtype.replace('f', 'u'))[7] = bits
    wavfile.write(tmp_path / 'a.wav', 25600, samples)
    with warnings.catch_warnings():
        warnings.simplefilter('error')
        found = read_signal(tmp_path / 'a.wav')
        np.savez(tmp_path / 'a.npz', acc=samples, fs=1000.0)
        assert np.isnan(read_signal(tmp_path / 'a.npz').x[7])
    assert np.flatnonzero(np.isnan(found.x)).tolist() == [7]


@pytest.mark.parametrize(
    ('dtype', 'scale'),
    [(np.int16, 2.0**15), (np.int32, 2.0**31), (np.float32, 1.0), (np.uint8, 2.0**7)],
)
def test_wav(tmp_path: Path, dtype: Any, scale: float) -> None:
    path = tmp_path / 'a.wav'
    offset = 128 if dtype is np.uint8 else 0
    table = (np.clip(0.2 * X.reshape(-1, 2), -0.99, 0.99) * scale + offset).astype(dtype)
    wavfile.write(path, 20000, table)
    signal = read_signal(path, channel='1')
    assert signal.sample_rate == 20000.0
    np.testing.assert_allclose(signal.x, (table[:, 1].astype(float) - offset) / scale)
    with pytest.raises(BearingTwinError, match='does not exist'):
        read_signal(path, channel='2')


@pytest.mark.parametrize(
    'text',
    [
        'time,acc [m/s^2],other\n{rows:,}',
        'fs = 1000\nrpm = 1500\nacc [m/s^2],other,third\n{rows:,}',
        'time;acc [m/s^2];other\n{rows:;}',
        'time\tacc [m/s^2]\tother\r\n{rows:\t}',
        '# time acc[m/s^2] other\n{rows: }',
        # As oscilloscopes and spreadsheets write them.
        'time,acc [m/s^2],other,\n{rows:,},',
        '"time","acc [m/s^2]","other"\n"{rows:,}"',
    ],
)
def test_csv(csv: Path, text: str) -> None:
    separator = text[text.index('{rows:') + 6]
    columns = np.column_stack([np.arange(500) / 1000.0, X[:500], X[500:1000]])
    lines = [separator.join(f'{v:.9g}' for v in row) for row in columns]
    if separator == ';':
        lines = [line.replace('.', ',') for line in lines]
    before, after = text.split('{')[0], text.split('}')[1]
    if after == '"':
        before, lines = before[:-1], [f'"{line}"'.replace(',', '","') for line in lines]
        after = ''
    csv.write_text(before + ''.join(f'{line}{after}\n' for line in lines))
    first = 'acc [m/s^2]' if separator != ' ' else 'acc[m/s^2]'
    index = 0 if text.startswith('fs') else 1
    signal = read_signal(csv, channel=first if index else 'acc [m/s^2]')
    np.testing.assert_allclose(signal.x, columns[:, index], rtol=1e-8)
    assert signal.sample_rate == pytest.approx(1000.0)
    assert signal.unit == 'm/s^2'
    if text.startswith('fs'):
        assert signal.shaft_hz == 25.0


@pytest.mark.parametrize(
    ('head', 'rate'),
    [
        ('fs = 25.6 kHz', 25600.0),
        ('Sampling frequency [Hz]: 12000', 12000.0),
        ('Sample Rate;12000', 12000.0),
        ('fs: 12 kS/s', 12000.0),
        ('fs = 25,6 kHz', None),
        ('sampling rate [kHz]: 12', None),
        ('offs: 3', None),
    ],
)
def test_rate_before_the_numbers(csv: Path, head: str, rate: float | None) -> None:
    csv.write_text(f'{head}\nacc,b\n' + '\n'.join(f'{v:.5f},0' for v in X[:99]))
    if rate:
        assert read_signal(csv).sample_rate == rate
        return
    with pytest.raises(BearingTwinError, match='does not say its sample rate'):
        read_signal(csv)


def test_decimal_commas_in_quotes_and_before_the_numbers(csv: Path) -> None:
    rows = [(f'{v:.5f}'.replace('.', ','), f'{k},5') for k, v in enumerate(X[:99])]
    csv.write_text('acc,b\n' + '\n'.join(f'"{a}","{b}"' for a, b in rows))
    np.testing.assert_allclose(read_signal(csv, sample_rate=1e3).x, X[:99], atol=1e-5)
    text = 'fs = 25,6 kHz\nacc;b\n' + '\n'.join(f'{a};{b}' for a, b in rows)
    csv.write_text(text, encoding='utf-16')
    assert read_signal(csv).sample_rate == 25600.0


@pytest.mark.parametrize('shape', [(2500, 2), (2, 2500)])
def test_channels_are_the_longer_side_of_a_table(tmp_path: Path, shape: tuple[int, int]) -> None:
    path = tmp_path / 'a.npz'
    table = X.reshape(2, 2500)
    np.savez(path, x=table if shape == table.shape else table.T, fs=1000.0)
    assert channels(path) == ['x:0', 'x:1']
    np.testing.assert_array_equal(read_signal(path, channel='1').x, X[2500:])


def test_of_a_stereo_file_the_other_channel_is_named(tmp_path: Path) -> None:
    path = tmp_path / 'a.wav'
    wavfile.write(path, 20000, X.reshape(-1, 2))
    assert read_signal(path).source.endswith('channel 0 (there is also channel 1)')
    assert read_signal(path, channel='1').source.endswith('channel 1')


def test_a_wav_that_is_cut_off_is_said_to_be(tmp_path: Path) -> None:
    path = tmp_path / 'a.wav'
    wavfile.write(path, 20000, X.astype(np.float32))
    path.write_bytes(path.read_bytes()[:-4000])
    signal = read_signal(path)
    np.testing.assert_array_equal(signal.x, X[:4000].astype(np.float32))
    assert signal.source.endswith('channel 0 (the file ends before its header says)')


def test_a_channel_of_one_axis_or_of_three_dimensions_is_refused_with_the_remedy(
    tmp_path: Path,
) -> None:
    path = tmp_path / 'a.npz'
    np.savez(path, x=X, fs=1000.0)
    with pytest.raises(BearingTwinError, match=r"one axis of 5000 samples: leave .* '7'"):
        read_signal(path, channel='x:7')
    with pytest.raises(BearingTwinError, match=r"channel '7' does not exist; there are 0..0"):
        read_signal(path, channel='7')
    np.savez(path, x=X.reshape(2, 50, 50), fs=1000.0)
    with pytest.raises(BearingTwinError, match='3 dimensions; save each signal as a row'):
        read_signal(path)


@pytest.mark.parametrize('heading', ['', 'time\tDE\tFE\n'])
def test_a_column_of_a_text_file_is_chosen_by_its_number_in_the_list(
    tmp_path: Path, heading: str
) -> None:
    path = tmp_path / 'a.txt'
    columns = X[:900].reshape(3, 300).copy()
    if heading:
        columns[0] = np.arange(300) / 5000.0
    path.write_text(heading + '\n'.join('\t'.join(f'{v:.9g}' for v in row) for row in columns.T))
    names = channels(path)
    assert names == (['DE', 'FE'] if heading else ['c0', 'c1', 'c2'])
    for number, name in enumerate(names):
        signal = read_signal(path, channel=str(number), sample_rate=5000.0)
        assert signal.source.endswith(f', {name}')
        np.testing.assert_allclose(signal.x, columns[number - len(names)], rtol=1e-8)
    with pytest.raises(BearingTwinError, match=rf"channel '3' does not .* 0..{len(names) - 1}"):
        read_signal(path, channel='3', sample_rate=5000.0)


def test_csv_without_any_heading(csv: Path) -> None:
    csv.write_text('\n'.join(f'{v:.9g}' for v in X[:300]))
    signal = read_signal(csv, sample_rate=5000.0)
    np.testing.assert_allclose(signal.x, X[:300], rtol=1e-8)


@pytest.mark.parametrize(
    ('first', 'rows'),
    [('-5e-5;0.5;0.25;0.9;0.8', 301), ('300', 300), ('9;9;9;9', 300), ('0;1', 300)],
)
def test_numbers_before_the_table_are_a_row_only_with_notes_at_its_right(
    csv: Path, first: str, rows: int
) -> None:
    table = [f'{5e-5 * k:g};{v:.9g} ;{-v:.9g} ' for k, v in enumerate(X[:300])]
    csv.write_text('\n'.join([first, *table]))
    assert channels(csv) == ['c0', 'c1', 'c2']
    x = read_signal(csv, sample_rate=2e4).x
    np.testing.assert_allclose(x[-300:], X[:300], rtol=1e-8)
    assert x[:-300].tolist() == [0.5] * (rows - 300)
    if rows > 300:
        csv.write_text('\n'.join(['Time (s);u;v', first, *table]))
        signal = read_signal(csv, channel='u')
        assert (signal.x[0], signal.sample_rate) == (0.5, pytest.approx(2e4))
    csv.write_text('\n'.join([*table[:9], first, *table[9:]]))
    with pytest.raises(BearingTwinError, match='the same columns'):
        read_signal(csv, sample_rate=2e4)


@pytest.mark.parametrize('head', ['', ','.join(map(str, range(2499))) + ',label', 'fs = 64 kHz'])
def test_long_lines_of_a_text_are_a_signal_each(csv: Path, head: str) -> None:
    rows = [','.join(f'{v:.9g}' for v in X[k : k + 2500]) for k in (0, 2500)]
    csv.write_text('\n'.join([head, *rows] if head else rows))
    assert channels(csv) == ['x:0', 'x:1']
    signal = read_signal(csv, channel='x:1', sample_rate=6.4e4)
    np.testing.assert_allclose(signal.x, X[2500:], rtol=1e-8)
    with pytest.raises(BearingTwinError, match='x has 2 rows of 2500 samples; choose one'):
        read_signal(csv)
    csv.write_text(rows[0])
    np.testing.assert_allclose(read_signal(csv, sample_rate=6.4e4).x, X[:2500], rtol=1e-8)


def test_a_name_that_ends_in_a_number_is_a_text(tmp_path: Path) -> None:
    names = ['2004.02.12.10.42.39', '2004.02.12.10.32.39', 'README.md']
    for name in names:
        rows = [f'{v:.9g}\t{-v:.9g}' for v in X[:300] * (1.0 + ('42' in name))]
        (tmp_path / name).write_text('\n'.join(rows))
    signal = read_signal(tmp_path / names[1], channel='c1', sample_rate=20480.0)
    np.testing.assert_allclose(signal.x, -X[:300], rtol=1e-8)
    files = series_files([tmp_path])
    snapshots = list(read_snapshots(files, channel='c0', sample_rate=20480.0))
    assert [snapshot.signal.x[0] / X[0] for snapshot in snapshots] == pytest.approx([1.0, 2.0])
    assert snapshots[1].time - snapshots[0].time == 600.0


def test_our_own_recording(tmp_path: Path) -> None:
    write_blocks(tmp_path / 'run', 40)
    signal = read_signal(tmp_path / 'run')
    expected = 2.0 * np.sin(0.01 * np.arange(40 * BLOCK)).astype(np.float32)
    np.testing.assert_array_equal(signal.x, expected.astype(np.float32))
    assert (signal.sample_rate, signal.shaft_hz, signal.unit) == (RATE, 25.0, 'm/s^2')
    x = read_signal(tmp_path / 'run', channel='/vibration:x')
    np.testing.assert_array_equal(2.0 * x.x, signal.x)
    with pytest.raises(BearingTwinError, match=r'no channel ./temperature.; it has /vib'):
        read_signal(tmp_path / 'run', channel='/temperature')


def test_the_longest_stretch_without_a_gap_is_taken(tmp_path: Path) -> None:
    with RecordingWriter(tmp_path / 'run.mcap') as writer:
        for index in [*range(5), *range(10, 22), *range(30, 34)]:
            put_block(writer, index)
    signal = read_signal(tmp_path / 'run.mcap')
    expected = 2.0 * np.sin(0.01 * np.arange(10 * BLOCK, 22 * BLOCK)).astype(np.float32)
    np.testing.assert_array_equal(signal.x, expected)


def test_blocks_that_repeat_the_one_before_are_left_out(tmp_path: Path) -> None:
    with RecordingWriter(tmp_path / 'run.mcap') as writer:
        # The driver sends blocks twice, and then hangs for 20 of them.
        sent = [(k, 0) for k in range(5) for _ in range(2)]
        for index, hung in [*sent, *((5 + k, 1 + k) for k in range(20)), (25, 0)]:
            put_block(writer, index, hung=hung)
    signal = read_signal(tmp_path / 'run.mcap')
    expected = 2.0 * np.sin(0.01 * np.arange(5 * BLOCK)).astype(np.float32)
    np.testing.assert_array_equal(signal.x, expected)
    assert '(left out: 25 blocks with the samples of the block before)' in signal.source


def test_recordings_of_a_series_are_as_far_apart_as_their_first_messages(tmp_path: Path) -> None:
    for number in range(3):
        with RecordingWriter(tmp_path / f'{number}.mcap') as writer:
            for index in range(3):
                put_block(writer, index, START + 3600 * number * NANO + index * PERIOD)
    files = [tmp_path / f'{number}.mcap' for number in (2, 0, 1)]
    times = [snapshot.time for snapshot in read_snapshots(files)]
    assert np.diff(times).tolist() == [3600.0, 3600.0]
    assert [snapshot.time for snapshot in read_snapshots(files, cycle=5.0)] == [0.0, 5.0, 10.0]


def write_imu(path: Path, times: np.ndarray) -> None:
    types = store(IMU)
    vector = types.types['geometry_msgs/msg/Vector3']
    zero, nine = vector(x=0.0, y=0.0, z=0.0), np.zeros(9)
    with RecordingWriter(path) as writer:
        for k, second in enumerate(times):
            ns = START + round(second * NANO)
            message = types.types[IMU](
                header=header(types, ns),
                orientation=types.types['geometry_msgs/msg/Quaternion'](
                    x=0.0, y=0.0, z=0.0, w=1.0
                ),
                orientation_covariance=nine,
                angular_velocity=zero,
                angular_velocity_covariance=nine,
                linear_acceleration=vector(x=0.0, y=float(k), z=float(X[k])),
                linear_acceleration_covariance=nine,
            )
            cdr = bytes(types.serialize_cdr(message, IMU))
            writer.write('/imu', IMU, cdr, log_time=ns)


def test_imu_of_anybody(tmp_path: Path) -> None:
    write_imu(tmp_path / 'imu.mcap', np.arange(400) / 800.0)
    signal = read_signal(tmp_path / 'imu.mcap')
    assert signal.sample_rate == pytest.approx(800.0, rel=1e-6)
    np.testing.assert_array_equal(signal.x, X[:400])
    y = read_signal(tmp_path / 'imu.mcap', channel='y')
    np.testing.assert_array_equal(y.x, np.arange(400.0))
    times = np.cumsum(np.random.default_rng(2).uniform(0.0001, 0.01, 400))
    write_imu(tmp_path / 'irregular.mcap', times)
    with pytest.raises(BearingTwinError, match='not equally spaced'):
        read_signal(tmp_path / 'irregular.mcap')


class Evil:
    """Makes a file when it is unpickled."""

    def __init__(self, path: str) -> None:
        self.path = path

    def __reduce__(self) -> Any:
        return (open, (self.path, 'w'))


def test_objects_in_npz_are_never_loaded(tmp_path: Path) -> None:
    made, path = tmp_path / 'made', tmp_path / 'a.npz'
    np.savez(path, x=np.array([Evil(str(made))] * 3, dtype=object), fs=1000.0)
    with pytest.raises(BearingTwinError, match='Python objects'):
        read_signal(path)
    with zipfile.ZipFile(path, 'w') as archive:
        archive.writestr('x.npy', pickle.dumps(Evil(str(made))))
    with pytest.raises(BearingTwinError, match='cannot be read as'):
        read_signal(path)
    assert not made.exists()


def npy(shape: str, payload: bytes = b'') -> bytes:
    head = f"{{'descr': '<f8', 'fortran_order': False, 'shape': {shape}, }}".ljust(117) + '\n'
    return b'\x93NUMPY\x01\x00' + len(head).to_bytes(2, 'little') + head.encode() + payload


def test_the_error_of_a_damaged_npz_is_short(tmp_path: Path) -> None:
    path = tmp_path / 'a.npz'
    np.savez(path, x=X, fs=1000.0)
    content = bytearray(path.read_bytes())
    # The length of the first name, in its local header.
    content[26:28] = b'\xff\xff'
    path.write_bytes(content)
    with pytest.raises(BearingTwinError, match='File name in directory') as said:
        read_signal(path)
    assert len(str(said.value)) < 500


@pytest.mark.parametrize('shape', ['(100000000000,)', '(1000000, 1000000)', '(-5,)', '(2**70,)'])
def test_npz_that_claims_more_than_it_has(tmp_path: Path, shape: str) -> None:
    path = tmp_path / 'a.npz'
    with zipfile.ZipFile(path, 'w') as archive:
        archive.writestr('x.npy', npy(shape, bytes(80)))
    with pytest.raises(BearingTwinError):
        read_signal(path, sample_rate=1000.0)


def test_mat_that_unpacks_to_too_much_or_nests_too_deeply(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    head = b'MATLAB 5.0 MAT-file'.ljust(124) + b'\x00\x01IM'
    path = tmp_path / 'a.mat'
    bomb = zlib.compress(bytes(50_000_000))
    path.write_bytes(head + np.array([15, len(bomb)], '<u4').tobytes() + bomb)
    monkeypatch.setattr('bearing_twin.recording.signals.matfile.MOST_UNPACKED', 10_000_000)
    with pytest.raises(BearingTwinError, match='would unpack to more than'):
        read_signal(path)
    # A struct in a struct in a struct ...: flags, dimensions, empty name, one field 'a' each.
    deep = b''
    for _ in range(3000):
        head_of_one = np.array([6, 8, 2, 0, 5, 8, 1, 1, 1, 0, 4 << 16 | 5, 8, 1, 8], '<u4')
        body = head_of_one.tobytes() + b'a'.ljust(8, b'\0') + deep
        deep = np.array([14, len(body)], '<u4').tobytes() + body
    path.write_bytes(head + deep)
    with pytest.raises(BearingTwinError, match='nests more than'):
        read_signal(path)


def test_a_struct_in_a_struct_is_not_too_deep(tmp_path: Path) -> None:
    value: Any = {'gs': X}
    for level in range(8):
        value = {f'level{level}': value, 'sr': 1000.0}
    savemat(tmp_path / 'a.mat', value)
    assert loadmat(tmp_path / 'a.mat')
    np.testing.assert_array_equal(read_signal(tmp_path / 'a.mat').x, X)


def test_other_endings_and_missing_files(tmp_path: Path) -> None:
    (tmp_path / 'a.xlsx').write_bytes(BytesIO(b'PK').read())
    with pytest.raises(BearingTwinError, match=r'files ending in .npz'):
        read_signal(tmp_path / 'a.xlsx')
    for name in ('a.npz', 'a.mat', 'a.wav', 'a.csv', 'a.mcap'):
        with pytest.raises(BearingTwinError):
            read_signal(tmp_path / name)


@pytest.mark.parametrize(
    ('heading', 'factor'),
    [
        ('time (ms)', 1e3),
        ('t [us]', 1e6),
        ('time_s', 1.0),
        ('Timestamp', 1.0),
        ('t', 1.0),
        ('Zeit/s', 1.0),
        ('Zeit in ms', 1e3),
        ('Time (Seconds)', 1.0),
        ('Time Stamp (s)', 1.0),
        ('time stamp', 1.0),
        ('time [µs]', 1e6),
    ],
)
def test_times_have_the_unit_that_their_heading_says(csv: Path, heading, factor) -> None:
    rows = '\n'.join(f'{factor * k / 25600.0:.9g},{v:.9g}' for k, v in enumerate(X[:500]))
    csv.write_text(f'{heading},acc [g]\n{rows}')
    signal = read_signal(csv)
    assert signal.sample_rate == pytest.approx(25600.0)
    np.testing.assert_allclose(signal.x, X[:500], rtol=1e-8)


@pytest.mark.parametrize('decimals', [3, 4, 5, 6])
@pytest.mark.parametrize('rate', [12000.0, 25600.0])
@pytest.mark.parametrize('heading', ['time,acc', 'X_Value,Voltage'])
def test_times_of_few_decimals_are_times_and_give_the_rate_they_have(
    csv: Path, decimals, rate, heading
) -> None:
    x = np.random.default_rng(0).standard_normal(60000)
    rows = '\n'.join(f'{k / rate:.{decimals}f},{v:.4f}' for k, v in enumerate(x))
    csv.write_text(f'{heading}\n{rows}')
    timed = heading.startswith('time')
    signal = read_signal(csv, sample_rate=None if timed else rate)
    assert signal.sample_rate == pytest.approx(rate, rel=2e-4 if decimals == 3 else 2e-5)
    assert signal.sample_rate == rate or decimals < 6
    np.testing.assert_allclose(signal.x, x, atol=1e-4)


def test_times_with_a_gap_give_no_sample_rate(csv: Path) -> None:
    rows = [f'{k / 12000.0:.6f},{v:.4f}' for k, v in enumerate(np.sin(np.arange(30000)))]
    csv.write_text('time,acc\n' + '\n'.join(rows[:12000] + rows[12020:]))
    with pytest.raises(BearingTwinError, match="times of its column 'time' have gaps, or"):
        read_signal(csv)
    assert read_signal(csv, sample_rate=12000.0).sample_rate == 12000.0


@pytest.mark.parametrize(('seconds', 'decimals'), [(4.5, 0), (1.03, 1), (0.5, 2), (0.5, 4)])
def test_times_that_stand_still_for_many_values_give_the_rate_between_their_changes(
    csv: Path, seconds, decimals
) -> None:
    times = np.floor(np.arange(round(seconds * 25600.0)) / 25600.0 * 10**decimals) / 10**decimals
    csv.write_text(
        'time,acc\n' + '\n'.join(f'{t:.{decimals}f},{k % 7}' for k, t in enumerate(times))
    )
    assert read_signal(csv).sample_rate == pytest.approx(25600.0, rel=1.5e-3)


def test_infinite_times_are_refused_without_a_warning(csv: Path) -> None:
    csv.write_text('time,acc\n' + '-1e308,4\n1e308,5\n' * 50 + 'inf,2\ninf,3\n')
    with warnings.catch_warnings():
        warnings.simplefilter('error')
        with pytest.raises(BearingTwinError, match='have gaps, or too few digits'):
            read_signal(csv)


def test_times_that_hardly_change_give_no_sample_rate(csv: Path) -> None:
    csv.write_text('time,acc\n' + '\n'.join(f'{k // 12000},{k % 7}' for k in range(18000)))
    with pytest.raises(BearingTwinError, match="its column 'time' have gaps, or too few digits"):
        read_signal(csv)


def test_a_rate_that_overrules_the_file_is_named_beside_it(csv: Path) -> None:
    csv.write_text('time,acc\n' + '\n'.join(f'{k / 1000.0},{k % 7}' for k in range(500)))
    signal = read_signal(csv, sample_rate=25600.0)
    assert signal.source.endswith('acc (the file says 1000 Hz)')
    assert signal.sample_rate == 25600.0


def test_times_in_another_unit_give_no_sample_rate(csv: Path) -> None:
    csv.write_text('time (min),acc\n' + '\n'.join(f'{k},{v:.9g}' for k, v in enumerate(X[:50])))
    with pytest.raises(BearingTwinError, match='does not say its sample rate'):
        read_signal(csv)
    np.testing.assert_allclose(read_signal(csv, sample_rate=1000.0).x, X[:50], rtol=1e-8)


def test_a_temperature_is_no_time(csv: Path) -> None:
    rows = '\n'.join(f'{20.0 + 0.01 * (k // 7)},{v:.9g}' for k, v in enumerate(X[:500]))
    csv.write_text(f'T (°C),acc\n{rows}')
    signal = read_signal(csv, channel='acc', sample_rate=1000.0)
    np.testing.assert_allclose(signal.x, X[:500], rtol=1e-8)
    assert read_signal(csv, channel='T', sample_rate=1000.0).x[0] == 20.0


@pytest.mark.parametrize(
    ('heading', 'row', 'rate'),
    [('acc,T1,time', '{1},20,{0}', 1000.0), ('time (h),time (s),acc', '0,{0},{1}', 1000.0)],
)
def test_the_time_is_found_beside_what_looks_like_it(csv, heading, row, rate) -> None:
    rows = '\n'.join(row.format(k / rate, f'{v:.9g}') for k, v in enumerate(X[:500]))
    csv.write_text(f'{heading}\n{rows}')
    signal = read_signal(csv)
    assert signal.sample_rate == pytest.approx(rate)
    np.testing.assert_allclose(signal.x, X[:500], rtol=1e-8)


def test_a_counter_is_no_vibration(csv: Path) -> None:
    rows = '\n'.join(f'{k},{v:.9g},{2 * v:.9g}' for k, v in enumerate(X[:500]))
    csv.write_text(f'Sample,acc [g],other\n{rows}')
    signal = read_signal(csv, sample_rate=1000.0)
    np.testing.assert_allclose(signal.x, X[:500], rtol=1e-8)
    assert signal.source.endswith('acc [g] (there is also other)')


def test_commas_of_two_meanings_are_refused(csv: Path) -> None:
    csv.write_text('\n'.join(f'{k},{k + 10}' for k in range(50)))
    with pytest.raises(BearingTwinError, match='decimal ones or part two columns: write a head'):
        read_signal(csv, sample_rate=1000.0)
    rows = [f'{k / 1e3:.3f},{v:.5f}'.replace('.', ',') for k, v in enumerate(X[:50])]
    csv.write_text('\n'.join(['time,acc', *rows]))
    with pytest.raises(BearingTwinError, match='decimal ones and also part columns; export it'):
        read_signal(csv, sample_rate=1000.0)
    csv.write_text('acc\n' + '\n'.join(f'{v:.5f}; 0'.replace('.', ',') for v in X[:50]))
    assert read_signal(csv, channel='c0', sample_rate=1000.0).x[3] == pytest.approx(X[3], abs=1e-5)


@pytest.mark.parametrize('heading', ['', 'acc\n'])
def test_digits_with_a_zero_in_front_follow_a_decimal_comma(csv: Path, heading) -> None:
    csv.write_text(heading + '\n'.join(f'{v:.5f}'.replace('.', ',') for v in X[:50]))
    np.testing.assert_allclose(read_signal(csv, sample_rate=1e3).x, X[:50], atol=1e-5)


@pytest.mark.parametrize(
    ('heading', 'clock', 'separator'),
    [
        ('timestamp,acc\n', '%Y-%m-%dT%H:%M:%S.%fZ', ','),
        (',acc\n', '%Y-%m-%d %H:%M:%S.%f+02:00', ','),
        ('', '%H:%M:%S.%f', '\t'),
        ('Date Time acc\n', '%Y/%m/%d %H:%M:%S.%f', ' '),
        ('Datum;Uhrzeit;acc\n', '%d.%m.%Y;%H:%M:%S,%f', ';'),
        ('Zeit;acc\n', '"%d.%m.%Y %H:%M:%S,%f"', ';'),
        ('Time,acc\n', '%m/%d/%Y %I:%M:%S.%f %p', ','),
        ('Time,acc\n', '%d.%m.%Y %H:%M:%S', ','),
    ],
)
def test_times_of_day_give_the_sample_rate(csv: Path, heading, clock, separator) -> None:
    # From before noon on: after it the hours of AM and PM begin anew.
    begin = datetime(2026, 3, 4, 11, 59, 58)
    values = [f'{k % 7}{"," if separator == ";" else "."}25' for k in range(6000)]
    rows = [
        f'{begin + timedelta(seconds=k / 1000.0):{clock}}{separator}{value}'
        for k, value in enumerate(values)
    ]
    csv.write_text(heading + '\n'.join(rows))
    signal = read_signal(csv)
    assert signal.sample_rate == pytest.approx(1000.0)
    assert signal.x[:9].tolist() == [0.25, 1.25, 2.25, 3.25, 4.25, 5.25, 6.25, 0.25, 1.25]
    csv.write_text(heading + '\n'.join(rows[:3000] + rows[5000:]))
    with pytest.raises(BearingTwinError, match=r'longest step: [0-9.]+ s after \d+ values'):
        read_signal(csv)


@pytest.mark.parametrize('unit', [1.0, 1e3, 1e6, 1e9])
def test_times_since_1970_tell_their_unit(csv: Path, unit: float) -> None:
    times = (np.arange(500) * 1000 + 1_772_625_600_000_000) * (unit / 1e6)
    rows = [f'{time:.6f},{v:.9g}' for time, v in zip(times, X, strict=False)]
    csv.write_text('timestamp,acc\n' + '\n'.join(rows))
    assert read_signal(csv).sample_rate == pytest.approx(1000.0, rel=1e-4)


def test_units_in_a_line_below_the_heading(csv: Path) -> None:
    rows = '\n'.join(f'{k};{v:.9g};{k % 3}' for k, v in enumerate(X[:500]))
    csv.write_text(f'Fan 7;;\nZeit;Motor DE;Motor NDE\n[ms];[mg];[mg]\n{rows}')
    signal = read_signal(csv)
    assert (signal.sample_rate, signal.unit) == (pytest.approx(1000.0), 'mg')
    assert signal.source.endswith('Motor DE [mg] (there is also Motor NDE [mg])')


def test_a_column_of_acceleration_goes_before_others(csv: Path) -> None:
    rows = '\n'.join(f'{k},{k / 1e3},{1500 + k % 2},{v:.9g}' for k, v in enumerate(X[:500]))
    csv.write_text(f',time,Speed [1/min],Motor [m/s²]\n{rows}', encoding='cp1252')
    signal = read_signal(csv)
    assert signal.source.endswith('Motor [m/s²] (there is also Speed [1/min])')
    assert signal.unit == 'm/s^2'
    assert signal.sample_rate == pytest.approx(1000.0)
    np.testing.assert_allclose(signal.x, X[:500], rtol=1e-8)


def test_a_line_that_is_no_row_is_shown(csv: Path) -> None:
    rows = [f'{k};{v:.5f}' for k, v in enumerate(X[:500])]
    csv.write_text('\n'.join(['n;acc', *rows[:200], '200;#NV', *rows[201:]]))
    with pytest.raises(BearingTwinError, match=r"columns of numbers \(line 202 is '200;#NV'\)"):
        read_signal(csv, sample_rate=1e3)
    csv.write_text('n|acc\n' + '\n'.join(rows).replace(';', '|'))
    with pytest.raises(BearingTwinError, match=r"line 100 is '98\|.*'; export columns"):
        read_signal(csv, sample_rate=1e3)


def test_a_bearing_may_be_named_under_the_key_bearing(tmp_path: Path) -> None:
    np.savez(tmp_path / 'a.npz', x=X, fs=1000.0, bearing='6205')
    signal = read_signal(tmp_path / 'a.npz')
    assert signal.bearing is None
    assert signal.bearing_name == '6205'


def test_a_speed_that_is_unknown_at_first_is_that_of_what_follows(tmp_path: Path) -> None:
    rpm = np.full(len(X), 1500.0)
    rpm[:100] = np.nan
    np.savez(tmp_path / 'a.npz', x=X, fs=1000.0, rpm=rpm)
    assert read_signal(tmp_path / 'a.npz').shaft_hz == pytest.approx(25.0)
