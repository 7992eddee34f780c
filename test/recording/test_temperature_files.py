# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""A temperature that somebody measured becomes a recording for the twin."""

from datetime import datetime, UTC

from bearing_twin.cli import main
from bearing_twin.recording.reader import read_messages
from bearing_twin.recording.temperature import START
from bearing_twin.stamps import NANO
import numpy as np
import pytest

NOON = int(datetime(2026, 3, 4, 12, tzinfo=UTC).timestamp()) * NANO


def _recorded(path):
    """Return times, ns, and temperatures of a recording."""
    found = [(m.log_time, m.decode()) for m in read_messages(path)]
    for time, message in found:
        assert message.header.stamp.sec * NANO + message.header.stamp.nanosec == time
    return [time for time, _ in found], [message.temperature for _, message in found]


@pytest.mark.parametrize(
    ('text', 'start', 'seconds'),
    [
        ('time,temperature\n0,20\n1.5,21\n4,23.5\n', START, [0.0, 1.5, 4.0]),
        ('t [min];Temp. [degC];speed\n10;20;1\n11;21;1\n13;23,5;1\n', START, [0.0, 60.0, 180.0]),
        ('0.0 20.0\n1.0 21\n5 23.5\n', START, [0.0, 1.0, 5.0]),
        ('logger 7\n0,20\n1,21\n5,23.5\n', START, [0.0, 1.0, 5.0]),
        ('t_us,temp\n0,20\n5e5,21\n2e6,23.5\n', START, [0.0, 0.5, 2.0]),
        ('3\t20\n4\t21\n\n6\t23.5', START, [0.0, 1.0, 3.0]),
        (
            'logger 7\nDate,Bearing °C,Oil\n2026-03-04 12:00:00,20,1\n2026-03-04T13:00:00+01:00,'
            '21,1\n2026-03-04T12:00:00.500Z,23.5,1\n',
            NOON,
            [0.0, 0.0, 0.5],
        ),
        (
            'Time [h:min],temp\n2026-03-04 12:00,20\n2026-03-04 12:01,21\n2026-03-04 12:05,23.5\n',
            NOON,
            [0.0, 60.0, 300.0],
        ),
        (
            'Datum;Temperatur [°C]\n4.3.2026 12:00:00;20,0\n04.03.2026 12:01;21\n'
            '04.03.2026 12:05:00;23,5\n',
            NOON,
            [0.0, 60.0, 300.0],
        ),
        (
            'Datum;Uhrzeit;Temp. 1\n04.03.2026;12:00:00;20,0\n04.03.2026;12:01;21\n'
            '04.03.2026;12:05:00;23,5\n',
            NOON,
            [0.0, 60.0, 300.0],
        ),
        (
            '2026-03-04\t12:00\t20\n2026-03-04\t12:01\t21\n2026-03-04\t12:05\t23.5\n',
            NOON,
            [0.0, 60.0, 300.0],
        ),
        (
            ',timestamp,temperature\n0,2026-03-04 12:00,20\n1,2026-03-04 12:01,21\n'
            '2,2026-03-04 12:05,23.5\n',
            NOON,
            [0.0, 60.0, 300.0],
        ),
        ('time,t1\n1772625600,20\n1772625601,21\n1772625603,23.5\n', NOON, [0.0, 1.0, 3.0]),
    ],
)
def test_a_table_of_times_and_temperatures_becomes_a_recording(text, start, seconds, tmp_path):
    (tmp_path / 'log.csv').write_text(text)
    words = ['schedule', '--from', str(tmp_path / 'log.csv'), '-o', str(tmp_path / 'run')]
    assert main(words) == 0
    times, temperatures = _recorded(tmp_path / 'run')
    assert times == [start + round(s * NANO) for s in seconds]
    assert temperatures == [20.0, 21.0, 23.5]


@pytest.mark.parametrize(
    ('dates', 'order', 'month'),
    [
        ('04/03/2026 {}', 'day-first', 3),
        ('4/3/2026 {}', 'month-first', 4),
        ('30/03/2026 {}', '', 3),
        ('3/30/2026,{}', '', 3),
        ('30-03-2026 {}', 'day-first', 3),
        ('2026/3/4 {}', '', 3),
    ],
)
def test_the_order_of_dates_with_slashes_is_told_by_a_day_or_by_the_user(
    dates, order, month, tmp_path, capsys
):
    clocks = ('9:00:00 AM', '12:30 PM', '1:05 pm') if month == 4 else ('9:00', '12:30', '13:05')
    lines = [f'{dates.format(clock)},{20 + k}' for k, clock in enumerate(clocks)]
    (tmp_path / 'log.csv').write_text('\n'.join(lines))
    words = ['schedule', '--from', str(tmp_path / 'log.csv'), '-o', str(tmp_path / 'run')]
    assert main([*words, *(['--dates', order] if order else [])]) == 0
    times, temperatures = _recorded(tmp_path / 'run')
    day = 30 if '30' in dates else (3 if month == 4 else 4)
    start = datetime(2026, month, day, 9, tzinfo=UTC).timestamp()
    assert [time / NANO - start for time in times] == [0.0, 12600.0, 14700.0]
    assert temperatures == [20.0, 21.0, 22.0]
    if '30' in dates:
        capsys.readouterr()
        other = 'month-first' if dates[0] == '3' and dates[1] == '0' else 'day-first'
        assert main([*words[:-1], str(tmp_path / 'other'), '--dates', other]) == 1
        assert 'give all in one order, that of --dates' in capsys.readouterr().err


def test_a_reading_without_a_number_stays_and_is_none(tmp_path):
    (tmp_path / 'log.csv').write_text('time,temperature\n0,20\n1,\n2,n/a\n3,1e400\n4,23\n')
    words = ['schedule', '--from', str(tmp_path / 'log.csv'), '-o', str(tmp_path / 'run')]
    assert main(words) == 0
    _, temperatures = _recorded(tmp_path / 'run')
    np.testing.assert_array_equal(temperatures, [20.0, np.nan, np.nan, np.nan, 23.0])


@pytest.mark.parametrize(
    ('text', 'said'),
    [
        ('time,temperature\n0,20\n2,21\n1,23\n', 'the time of reading 3 falls; sort the file\n'),
        (
            't;temp\n25.10.2026 02:58;20\n25.10.2026 02:59;21\n25.10.2026 02:00;22\n',
            'reading 3 falls; sort the file, or, where summer time ends, give dates with their',
        ),
        ('time,temperature\n0,20\n', 'has fewer than two temperatures; record for longer'),
        ('time,temperature\n0,20\nend\n', 'line 3 has no time: end'),
        ('time,Temp [°F]\n0,20\n1,21\n', "'Temp [°F]' is not in degC; convert it"),
        ('Time (s),Motor (g)\n0,0.1\n1,0.2\n', "'Motor (g)' is not in degC; convert it"),
        ('time,temp in,temp out\n0,20,1\n1,21,1\n', '2 of its columns temp in, temp out are'),
        ('time,speed,load\n0,20,1\n1,21,1\n', '0 of its columns speed, load are temperatures'),
        (
            'nothing\n',
            'has no line of a time and a temperature; give times in s or as dates such as',
        ),
        (
            'time;T\n03/01/2026 12:00;20\n04/01/2026 12:00;20\n',
            '03/01/2026 may have the day or the month first; give --dates day-first or --dates m',
        ),
        (
            '30/11/2026 12:00;20\n11/30/2026 12:00;20\n',
            'has the dates 30/11/2026 (day-first) and 11/30/2026 (month-first); give all in one',
        ),
        ('time,temperature\nnan,20\n0,21\n1,22\n', 'line 2 has no time: nan'),
        ('0,20\n1e300,21\n', 'a time of 1e+300 s; stamps of ROS end in 2038'),
    ],
)
def test_what_is_no_temperature_is_refused_in_a_sentence(text, said, tmp_path, capsys):
    (tmp_path / 'log.csv').write_text(text)
    words = ['schedule', '--from', str(tmp_path / 'log.csv'), '-o', str(tmp_path / 'run')]
    assert main(words) == 1
    assert said in capsys.readouterr().err
    assert not (tmp_path / 'run').exists()


def test_arrays_of_times_and_temperatures_are_both_needed(tmp_path, capsys):
    np.savez(tmp_path / 'log.npz', temp_t_s=np.arange(3.0))
    words = ['schedule', '--from', str(tmp_path / 'log.npz'), '-o', str(tmp_path / 'run')]
    assert main(words) == 1
    assert 'has no array temp_C; give both (s, degC)' in capsys.readouterr().err


@pytest.mark.parametrize(
    ('log', 'begin'),
    [
        ('0,20\n1,21\n', 'not dated'),
        ('2026-03-04 12:00:00,20\n2026-03-04 12:00:01,21\n', '2026-03-04 12:00:00'),
    ],
)
def test_info_shows_a_date_only_where_the_log_has_one(tmp_path, capsys, log, begin):
    (tmp_path / 'log.csv').write_text(f'time,temperature\n{log}')
    made = str(tmp_path / 'made')
    assert main(['schedule', '--from', str(tmp_path / 'log.csv'), '-o', made]) == 0
    capsys.readouterr()
    assert main(['info', made]) == 0
    assert f'begin       {begin}' in capsys.readouterr().out
