# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""What the benchmarks claim, from runs given by hand."""

import argparse
import json
from pathlib import Path
import re

from bearing_twin.bench import end_to_end, files, kernel, live
from bearing_twin.bench.live import FleetRun, Search
from bearing_twin.cli import bench
from bearing_twin.cli.bench import FIGURES
from bearing_twin.errors import BearingTwinError
from bearing_twin.recording.writer import RecordingWriter
from bearing_twin_msgs.msg import TwinState, Vibration
import numpy as np
import pytest
from rclpy.serialization import serialize_message

PAGE = Path(__file__).resolve().parents[1] / 'docs' / 'performance.md'


def test_a_claim_of_live_bearings_grows_with_the_runs_that_kept_time():
    search = Search()
    search.add(FleetRun(search.following, 0.08, 0, 0))
    assert search.claim == 32
    search.add(FleetRun(search.following, 0.2, 0, 0))
    assert search.proved == 64
    assert search.claim == 128
    assert search.following == 160
    search.add(FleetRun(160, 0.52, 0, 0))
    # Half of 308 is enough to prove them.
    assert search.claim == pytest.approx(307.7, abs=0.1)
    assert search.following == 0
    assert search.late == 0


def test_a_fleet_that_is_hardly_larger_proves_nothing_more():
    search = Search()
    for run in (FleetRun(16, 0.06, 0, 0), FleetRun(64, 0.17, 0, 0), FleetRun(214, 0.49, 0, 0)):
        search.add(run)
    # Half of 437 bearings are five more.
    assert search.claim == 428
    assert search.following == 0


def test_a_small_fleet_that_took_long_does_not_end_the_search():
    search = Search()
    for run in (FleetRun(16, 0.42, 0, 0), FleetRun(20, 0.39, 0, 0)):
        assert search.following == run.bearings
        search.add(run)
    assert search.claim == 40
    assert search.following == 26


def test_every_figure_of_the_bench_stands_on_the_page():
    text = PAGE.read_text()
    rows = text[text.index('| `kernel_rtf`') : text.index('| not in')].splitlines()
    named = [re.findall('`([a-z0-9_]+)`', row) for row in rows]
    assert {row[0] for row in named if row} <= set(FIGURES)
    assert set(FIGURES) <= {name for row in named for name in row}


def test_the_bench_of_files_imports_nothing_from_the_working_directory(tmp_path, monkeypatch):
    for name in ('bearing_twin', 'numpy', 'json'):
        (tmp_path / f'{name}.py').write_text('raise SystemExit(7)')
    record = tmp_path / 'noise.npz'
    noise = np.random.default_rng(0).standard_normal(25600)
    np.savez(record, x=noise, fs=25600.0, rpm=1524.0)
    monkeypatch.chdir(tmp_path)
    took, _ = files._diagnose([str(record), '--jobs', '1'], [])
    assert took > 0.0


def test_no_more_is_claimed_than_twice_what_kept_time():
    search = Search()
    for run in (FleetRun(16, 0.04, 0, 0), FleetRun(64, 0.1, 0, 0), FleetRun(256, 0.3, 0, 7)):
        search.add(run)
    assert search.claim == 128
    # Something else may have had the core for a moment.
    assert search.following == 256
    search.add(FleetRun(256, 0.3, 1, 0))
    # Between the most that kept time and the fewest that did not.
    assert search.following == 128
    search.add(FleetRun(128, 0.2, 0, 0))
    assert search.claim == 2 * search.proved == 256
    assert search.following == 181
    search.add(FleetRun(181, 0.3, 1, 0))
    # A search ends, whatever the machine does.
    assert search.made == live.MOST_RUNS
    assert search.following == 0
    assert search.late == 181


def test_a_fleet_that_kept_time_the_second_time_was_not_late():
    search = Search()
    for run in (FleetRun(16, 0.04, 3, 0), FleetRun(16, 0.04, 0, 0), FleetRun(64, 0.1, 0, 2)):
        assert search.following == run.bearings
        search.add(run)
    search.add(FleetRun(search.following, 0.1, 0, 0))
    assert search.proved == 64
    assert search.late == 0


def test_a_machine_on_which_16_bearings_are_late_proves_nothing():
    search = Search()
    search.add(FleetRun(16, 0.1, 1, 0))
    with pytest.raises(BearingTwinError, match='2 blocks were late'):
        search.add(FleetRun(16, 0.1, 2, 0))


def test_what_was_measured_is_printed_though_another_bench_fails(monkeypatch, capsys):
    def fails(say):
        raise BearingTwinError('of 16 bearings 3 blocks were late')

    monkeypatch.setattr(live, 'measure', fails)
    monkeypatch.setattr(kernel, 'measure', lambda: {'kernel_rtf': 200.0})
    asked = argparse.Namespace(names=['live', 'kernel'], live=False, calibrate=False, json=True)
    assert bench.run(asked) == 1
    told = capsys.readouterr()
    assert json.loads(told.out)['kernel_rtf'] == 200.0
    assert 'bench live: of 16 bearings' in told.err


@pytest.mark.parametrize('lost', [[], [3], [3, 4]])
def test_lost_blocks_are_counted_and_those_of_a_second_twin_are_refused(tmp_path, lost):
    bag = tmp_path / 'run.mcap'

    def write(blocks):
        with RecordingWriter(bag) as writer:
            for n in blocks:
                block = Vibration(sample_rate=1000.0, first_sample=100 * n, y=[0.0] * 100)
                for topic, message in (('/vibration', block), ('/twin_state', TwinState())):
                    data = serialize_message(message)
                    kind = f'bearing_twin_msgs/msg/{type(message).__name__}'
                    writer.write(topic, kind, data, log_time=n)

    blocks = [n for n in range(10) if n not in lost]
    write(blocks)
    found = end_to_end.punctuality(bag, 0, 10, calibrate=False)
    assert found['lost_blocks'] == len(lost)
    bag.unlink()
    write(sorted([*blocks, 5, 6]))
    with pytest.raises(BearingTwinError, match=r'2 blocks .* another twin'):
        end_to_end.punctuality(bag, 0, 10, calibrate=False)
