# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""What a caller gives to streams and simulators: refused in words, and no state has changed."""

import math
import warnings

from bearing_twin.bearing import find_bearing
from bearing_twin.diagnosis import diagnose_record, DiagnosisSettings, StreamingDiagnoser
from bearing_twin.diagnosis.series.monitor import SeriesMonitor
from bearing_twin.diagnosis.series.snapshots import SeriesDiagnoser
from bearing_twin.dynamics import Fleet, preset, Simulator, TwinParameters
from bearing_twin.errors import BearingTwinError
from bearing_twin.given import real_numbers
import numpy as np
import pytest

RATE = 25600.0
BLOCKS = [
    ['1', '2'],
    np.array(['a', 'b']),
    np.array([1.0 + 1.0j, 2.0]),
    [None, 1.0],
    [object()],
    [{}, []],
    [[1.0, 2.0], [3.0]],
    np.ma.array([1.0, 2.0], mask=[False, True]),
    np.float64(1.0),
    np.array(3.0),
    np.ones((2, 3)),
    [True, False],
    [10**400, 1],
    np.array(['2026-01-01'], dtype='datetime64[s]'),
    None,
    'abc',
    b'abc',
    {1.0, 2.0},
]
NUMBERS = ['25', None, 1j, [25.0, 26.0], {}, 10**400, b'1', np.ma.masked]


def refused(call, *values, **named):
    with warnings.catch_warnings(), pytest.raises(BearingTwinError) as refusal:
        warnings.simplefilter('error')
        call(*values, **named)
    return str(refusal.value)


def noise(seconds, seed=0):
    return np.random.default_rng(seed).standard_normal(round(seconds * RATE))


def stream(settings):
    bearing = find_bearing('6205')
    return (SeriesDiagnoser if settings.series_cycle else StreamingDiagnoser)(bearing, settings)


def push(stream, *block):
    return [stream.judge(excerpt.analyse()) for excerpt in stream.take(*block)]


@pytest.mark.parametrize('cycle', [0.0, 10.0])
def test_a_stream_goes_on_after_a_block_that_is_none(cycle):
    settings = DiagnosisSettings(window=1.0, memory=1.0, series_cycle=cycle)
    one, other = stream(settings), stream(settings)
    good = noise(0.7, 1), noise(0.7, 2)
    assert push(one, 0, good[0], RATE, 25.0) == push(other, 0, good[0], RATE, 25.0)
    following = len(good[0])
    saved = one.save()
    for block in BLOCKS:
        refused(one.take, following, block, RATE, 25.0)
    for value in NUMBERS:
        # At another rate the stream would begin anew.
        refused(one.take, value, good[1], 2.0 * RATE, 25.0)
        refused(one.take, following, good[1], value, 25.0)
        refused(one.take, following + 7, good[1], RATE, value)
        refused(one.take, following, good[1], 2.0 * RATE, 25.0, temperature=value)
    for index in (0.5, math.nan, math.inf, 2**63, -(2**63), 10**400):
        refused(one.take, index, good[1], RATE, 25.0)
    for rate in (0.0, -1.0, math.nan, math.inf):
        refused(one.take, following, good[1], rate, 25.0)
    assert one.save() == saved
    answers = push(one, following, good[1], RATE, 25.0)
    assert answers
    assert str(answers) == str(push(other, following, good[1], RATE, 25.0))
    assert one.save() == other.save()


def test_a_series_goes_on_after_a_snapshot_that_is_none():
    one, other = SeriesMonitor(find_bearing('6205')), SeriesMonitor(find_bearing('6205'))
    for number in range(12):
        x = noise(0.1, number)
        for block in BLOCKS:
            refused(one.add, float(number), block, RATE, 25.0)
        for value in NUMBERS:
            refused(one.add, value, x, RATE, 25.0)
            refused(one.add, float(number), x, value, 25.0)
            refused(one.add, float(number), x, RATE, value)
            refused(one.add, float(number), x, RATE, 25.0, temperature=value)
        for rate in (0.0, -1.0, math.nan, math.inf):
            refused(one.add, float(number), x, rate, 25.0)
        one.add(float(number), x, RATE, 25.0)
        other.add(float(number), x, RATE, 25.0)
    assert str(one.report()) == str(other.report())


@pytest.mark.parametrize(('time', 'hertz'), [(math.nan, 25.0), (math.inf, 25.0), (0.0, math.inf)])
def test_a_snapshot_without_time_or_speed_is_left_out_and_the_next_one_is_not(time, hertz):
    monitor = SeriesMonitor(None)
    assert monitor.add(time, noise(0.1), RATE, hertz) is None
    assert monitor.add(1.0, noise(0.1), RATE, 25.0) is not None


def test_a_record_is_one_axis_of_numbers():
    bearing = find_bearing('6205')
    for block in BLOCKS:
        refused(diagnose_record, block, RATE, bearing, 25.0)
    for value in NUMBERS:
        refused(diagnose_record, noise(1.0), value, bearing, 25.0)
        refused(diagnose_record, noise(1.0), RATE, bearing, value)


def test_a_simulator_goes_on_after_inputs_that_are_none():
    one, other = (Simulator(preset('paper'), sample_rate=2000.0) for _ in range(2))
    for value in NUMBERS:
        refused(one.advance, value, 30.0, 25.0)
        refused(one.advance, 64, value, 25.0)
        refused(one.advance, 64, 30.0, value)
        refused(Simulator, preset('paper'), sample_rate=value)
        if value is not np.ma.masked:
            # NumPy itself warns of that, and makes it NaN.
            refused(one.advance_all, 64, [30.0, value], [25.0, 25.0])
            refused(one.advance_all, 64, [30.0, 30.0], [25.0, value])
    for size in (0, -1, 2.5, math.nan, math.inf, 2**24 + 1):
        refused(one.advance, size, 30.0, 25.0)
    for speeds in ([25.0], [25.0] * 3, 25.0, '25', []):
        refused(one.advance_all, 64, [30.0, 40.0], speeds)
    assert one.save() == other.save()
    assert one.advance(64, 30.0, 25.0).y.tobytes() == other.advance(64, 30.0, 25.0).y.tobytes()


def test_a_fleet_goes_on_after_inputs_that_are_none():
    one, other = (Fleet([preset('paper')] * 2, sample_rate=2000.0) for _ in range(2))
    for value in ['25', None, 1j, [25.0] * 3, {}, 10**400, ['25', '26'], [[25.0, 25.0]]]:
        refused(one.advance, 64, value, 25.0)
        refused(one.advance, 64, 30.0, value)
    for size in ('64', None, 0, 2.5, math.nan):
        refused(one.advance, size, 30.0, 25.0)
    for index in ('0', None, 0.5, -1, 2):
        refused(one.extract, index)
    assert one.save() == other.save()
    assert one.advance(64, 30.0, 25.0).y.tobytes() == other.advance(64, 30.0, 25.0).y.tobytes()


@pytest.mark.parametrize('value', ['5', None, 1j, [1.0, 2.0], np.array([1.0, 2.0]), {}])
def test_a_quantity_is_a_number(value):
    text = refused(TwinParameters, **{**vars(preset('paper')), 'load': value})
    assert text.startswith('load=')
    assert ' N' in text
    assert refused(DiagnosisSettings, window=value).startswith('window=')


def test_a_signalling_nan_is_a_nan_without_a_warning():
    damaged = np.array([0x7FA00000, 0x3F800000], dtype=np.uint32).view(np.float32)
    with warnings.catch_warnings():
        warnings.simplefilter('error')
        assert np.array_equal(real_numbers('x', damaged), [math.nan, 1.0], equal_nan=True)
        assert np.isposinf(real_numbers('x', np.array([np.finfo(np.longdouble).max])))
