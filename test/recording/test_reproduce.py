# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""The same recording, parameters and seed give the same bytes."""

from __future__ import annotations

from collections.abc import Callable
from importlib import import_module
import json
import math
import os
from pathlib import Path
import signal
import threading
import time
from typing import Any

from bearing_twin.assets.checkpoints import configuration_values
from bearing_twin.assets.messages import floats, message_header
from bearing_twin.assets.parameters.diagnosis import SPECS
from bearing_twin.assets.parameters.spec import read_values
from bearing_twin.bench.end_to_end import punctuality
from bearing_twin.cli import main
from bearing_twin.cli.bench import FIGURES
from bearing_twin.dynamics import preset, Simulator
from bearing_twin.errors import BearingTwinError
from bearing_twin.offline.agreement import Agreement
from bearing_twin.offline.diagnosis_run import DiagnosisRun
from bearing_twin.offline.output import output
from bearing_twin.offline.run import run_offline
from bearing_twin.offline.verify import reproduce
from bearing_twin.recording.health import examine
from bearing_twin.recording.mcap.schema import canonical_cdr
from bearing_twin.recording.reader import read_messages
from bearing_twin.recording.temperature import paper_schedule, write_temperature_recording
from bearing_twin.recording.writer import RecordingWriter
from bearing_twin.ros.topics.qos import RESULT, STREAM
from bearing_twin.stamps import NANO, samples_ns, stamp_ns
from bearing_twin.streams.vibration_input import read_vibration, VibrationBlock
from bearing_twin_msgs.msg import Diagnosis, Vibration
from copies import put
from forked import ForkedNodes
import numpy as np
import pytest
from rclpy.serialization import deserialize_message, serialize_message
from recorder_process import Source, TIMEOUT
from recording_samples import store
from std_srvs.srv import Trigger
import yaml

SNAPSHOTS = {'series_cycle': 10.0, 'series_snapshot': 1.0}
COMPARED = ('/vibration', '/diagnosis', '/twin_state', '/envelope_spectrum', '/features/rms')


@pytest.fixture(scope='module')
def schedule(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Twelve seconds from 20 to 110 degC."""
    path = tmp_path_factory.mktemp('schedule') / 'schedule.mcap'
    write_temperature_recording(path, *paper_schedule(12.0), source='test')
    return path


@pytest.fixture(scope='module')
def run(schedule: Path) -> Path:
    """Run offline with an inner-race defect."""
    target = schedule.with_name('run')
    run_offline(schedule, target, twin={'defect': 'inner', 'seed': 7})
    return target


def contents(path: Path, topic: str) -> list[bytes]:
    return [m.cdr for m in read_messages(path, topics=[topic])]


def test_offline_twice_gives_the_same_bytes(schedule: Path, run: Path) -> None:
    again = schedule.with_name('again')
    report = run_offline(schedule, again, twin={'defect': 'inner', 'seed': 7})
    assert report.blocks == 12 * 25
    for topic in COMPARED:
        assert len(contents(run, topic)) > 5
        assert contents(run, topic) == contents(again, topic), topic
    other = schedule.with_name('other')
    run_offline(schedule, other, twin={'defect': 'inner', 'seed': 8})
    assert contents(run, '/vibration') != contents(other, '/vibration')


def test_offline_writes_what_rclpy_would(run: Path) -> None:
    for message in read_messages(run):
        channel = message.channel
        package, _, name = channel.type_name.split('/')
        kind = getattr(import_module(f'{package}.msg'), name)
        again = serialize_message(deserialize_message(message.cdr, kind))
        assert canonical_cdr(channel.type_name, channel.schema, again) == message.cdr


def test_offline_follows_the_schedule(run: Path) -> None:
    assert examine(run)[1].problems == []
    states = [m.decode() for m in read_messages(run, topics=['/twin_state'])]
    used = np.array([s.temperature_used for s in states])
    ends = np.array([s.first_sample + s.sample_count for s in states]) / 25600.0
    # The reading in force when a block is due: at most one of 0.1 s old.
    law = 20.0 + 90.0 * np.minimum(ends, 12.0) / 12.0
    assert np.all(used <= law + 1e-6)
    assert np.all(used >= law - 90.0 / 12.0 * 0.1 - 1e-6)
    assert all(s.temperature_status == 0 for s in states)


def test_verify_agrees(run: Path, capsys: pytest.CaptureFixture[str]) -> None:
    result = reproduce(run)
    assert result.identical
    assert result.topics['/vibration'].identical == 12 * 25
    assert result.topics['/twin_state'].identical == 12 * 25
    assert result.topics['/diagnosis'].identical == 12
    assert main(['verify', str(run)]) == 0
    assert (
        'identical to the byte: /diagnosis, /twin_state, /vibration\n' in capsys.readouterr().out
    )


def test_diagnose_takes_the_speed_of_a_recording_as_the_node_does(
    schedule: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """It is exact. With a nominal speed an outer race may be three impacts a turn."""
    twin = {'defect': 'outer', 'thermal_mode': 'physical'}
    run_offline(schedule, tmp_path / 'run', twin=twin)
    told = [m.decode().result_name for m in read_messages(tmp_path / 'run', topics=['/diagnosis'])]
    words = ('diagnose', str(tmp_path / 'run'), '--bearing', '6307', '--json')
    said = []
    for nominal in ([], ['--shaft-hz', '25.4']):
        assert main([*words, *nominal]) == 0
        said.append(json.loads(capsys.readouterr().out)['result'])
    assert told[-1] == 'outer'
    assert said == ['outer', 'ambiguous']


def rewritten(source: Path, target: Path, change: Callable[[Any, bytes], bytes | None]) -> Path:
    """Copy a recording; ``change`` gives each message its bytes, None leaves it out."""
    with RecordingWriter(target) as writer:
        for m in read_messages(source):
            cdr = change(m, m.cdr)
            if cdr is not None:
                put(writer, m, cdr=cdr)
    return target


def test_one_changed_bit_is_found(run: Path, tmp_path: Path) -> None:
    target = contents(run, '/vibration')[100]

    def flip(message: Any, cdr: bytes) -> bytes:
        if cdr == target:
            damaged = bytearray(cdr)
            damaged[-100] ^= 1
            return bytes(damaged)
        return cdr

    result = reproduce(rewritten(run, tmp_path / 'flipped', flip))
    assert not result.identical
    assert result.topics['/vibration'].different == 1
    assert f'at sample {100 * 1024}' in result.topics['/vibration'].first_difference
    assert main(['verify', str(tmp_path / 'flipped')]) == 1


@pytest.mark.parametrize(
    ('topic', 'field', 'value', 'found'),
    [
        ('/vibration', 'header', message_header(1, 'bearing_housing'), '/vibration'),
        ('/twin_state', 'header', message_header(1, 'bearing_housing'), '/vibration'),
        ('/twin_state', 'defect', 'outer', '/twin_state'),
        ('/twin_state', 'life_hours', 1.0, '/twin_state'),
        ('/twin_state', 'inner_x', 1e-6, '/twin_state'),
    ],
)
def test_a_changed_time_or_state_is_found(
    run: Path, tmp_path: Path, topic: str, field: str, value: Any, found: str
) -> None:
    def change(message: Any, cdr: bytes) -> bytes:
        if message.topic == topic and message.decode().first_sample == 100 * 1024:
            return changed(message, **{field: value})
        return cdr

    result = reproduce(rewritten(run, tmp_path / 'changed', change))
    assert result.topics[found].different == 1
    assert f'at sample {100 * 1024}' in result.topics[found].first_difference


def test_after_a_loss_it_goes_on_at_the_next_checkpoint(run: Path, tmp_path: Path) -> None:
    lost = contents(run, '/vibration')[100]

    def drop(message: Any, cdr: bytes) -> bytes | None:
        return None if cdr == lost else cdr

    result = reproduce(rewritten(run, tmp_path / 'lossy', drop))
    vibration = result.topics['/vibration']
    # The next checkpoint is that of sample 256000, block 250.
    assert (vibration.identical, vibration.different) == (100 + 50, 0)
    assert any('blocks are missing' in note for note in result.notes)


def test_a_missing_verdict_is_counted_and_shifts_no_other(
    run: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    verdicts = contents(run, '/diagnosis')
    for place, identical in ((0, 11), (5, 11), (11, 11)):
        lost = verdicts[place]
        lossy = rewritten(
            run, tmp_path / f'lossy{place}', lambda _, cdr, lost=lost: None if cdr == lost else cdr
        )
        diagnosis = reproduce(lossy).topics['/diagnosis']
        # After the last verdict the recording ends: it may have been published later.
        missing = int(place < 11)
        assert (diagnosis.identical, diagnosis.different) == (identical, 0), diagnosis
        assert (diagnosis.missing, diagnosis.skipped) == (missing, 0)
        assert main(['verify', str(lossy)]) == 0
        assert ('1 missing in the recording' in capsys.readouterr().out) == bool(missing)


@pytest.mark.parametrize('topic', ['/vibration', '/twin_state', '/diagnosis', '/twin_checkpoint'])
def test_a_message_that_is_there_twice_is_counted_once(
    run: Path, tmp_path: Path, topic: str
) -> None:
    twice = contents(run, topic)[1]
    with RecordingWriter(tmp_path / 'twice') as writer:
        for message in read_messages(run):
            put(writer, message)
            if message.topic == topic and message.cdr == twice:
                put(writer, message)
    result, once = reproduce(tmp_path / 'twice'), reproduce(run)
    assert result.identical
    assert result.topics == once.topics
    assert result.notes == [*once.notes, f'{topic}: 1 messages are there twice']


def test_a_verdict_that_nobody_makes_again_is_different(run: Path, tmp_path: Path) -> None:
    def forge(message: Any, cdr: bytes) -> bytes:
        if message.topic == '/diagnosis' and cdr == contents(run, '/diagnosis')[4]:
            return changed(message, first_sample=message.decode().first_sample + 1)
        return cdr

    diagnosis = reproduce(rewritten(run, tmp_path / 'forged', forge)).topics['/diagnosis']
    assert (diagnosis.identical, diagnosis.different, diagnosis.missing) == (11, 1, 1)
    assert diagnosis.first_difference == '/diagnosis at sample 1: not made again'


def record(
    path: Path,
    run: DiagnosisRun,
    simulator: Simulator,
    speeds: dict[int, float],
    runs: dict[int, DiagnosisRun | None] | None = None,
    first: int = 0,
) -> None:
    """
    Record a diagnosis of numbered blocks of a sensor; ``speeds`` are those of a joint, Hz.

    From some numbers on there are other ``runs``, or none. The sensor begins its index anew at the
    block ``first``.
    """
    now: DiagnosisRun | None = run
    with RecordingWriter(path) as writer:
        for number, hz in speeds.items():
            now = (runs or {}).get(number, now)
            samples = floats(simulator.advance(1024, 40.0, 25.3).y)
            stamp = number * samples_ns(1024, 25600.0)
            index = 1024 * (number - first if number >= first else number)
            message = Vibration(
                header=message_header(stamp, 's'), sample_rate=25600.0, first_sample=index,
                source=Vibration.SOURCE_MEASURED, unit='m/s^2', shaft_hz=math.nan, y=samples,
            )  # fmt: skip
            made = [output('/vibration', message)]
            if now is None:
                writer.write(made[0].topic, made[0].type_name, made[0].cdr, log_time=stamp)
                continue
            run = now
            block = read_vibration(message, 'y')
            if run.needs_checkpoint(block):
                made.append(run.checkpoint_output(block))
            for due in run.take(block, temperature=math.nan, joint_hz=hz):
                made += run.outputs(due.judge(due.excerpt.analyse()))
            for each in made:
                writer.write(each.topic, each.type_name, each.cdr, log_time=stamp)


@pytest.mark.parametrize('joint', ['silent', 'begins', 'steady', 'moves'])
def test_a_joint_that_is_silent_or_moves_makes_no_sound_recording_differ(
    joint: str, tmp_path: Path
) -> None:
    run = DiagnosisRun(read_values(SPECS, {'joint': 'shaft', 'shaft_hz': 25.0}))
    simulator = Simulator(preset('incipient', defect='inner'))
    speeds = {'silent': [], 'begins': [math.nan] * 50, 'steady': [], 'moves': [25.2, 25.3] * 100}
    rest = math.nan if joint == 'silent' else 25.3
    speeds = [*speeds[joint], *[rest] * 150][:150]
    record(tmp_path / 'run', run, simulator, dict(enumerate(speeds)))
    diagnosis = reproduce(tmp_path / 'run').topics['/diagnosis']
    assert diagnosis == Agreement(identical=6 - diagnosis.skipped, skipped=diagnosis.skipped)
    # The speed of each block is known where it is the nameplate's, or one for all.
    assert (diagnosis.skipped == 0) == (joint in {'silent', 'steady'})


def test_blocks_that_a_source_left_out_make_no_sound_recording_differ(tmp_path: Path) -> None:
    run = DiagnosisRun(read_values(SPECS, {'shaft_hz': 25.0}))
    simulator = Simulator(preset('incipient', defect='inner'))
    # The checkpoint after 10 s comes before the first verdict on the samples after the gap.
    numbers = (*range(240), *range(245, 330))
    record(tmp_path / 'run', run, simulator, dict.fromkeys(numbers, math.nan))
    diagnosis = reproduce(tmp_path / 'run').topics['/diagnosis']
    assert diagnosis == Agreement(identical=9 + 3)


def test_several_gaps_within_a_window_make_no_sound_recording_differ(tmp_path: Path) -> None:
    """The first verdict after them tells how many there were."""
    run = DiagnosisRun(read_values(SPECS, {'shaft_hz': 25.0}))
    simulator = Simulator(preset('incipient', defect='inner'))
    numbers = (*range(215), *range(216, 225), *range(226, 235), *range(240, 500))
    record(tmp_path / 'run', run, simulator, dict.fromkeys(numbers, math.nan))
    diagnosis = reproduce(tmp_path / 'run').topics['/diagnosis']
    assert diagnosis == Agreement(identical=18)


def verdicts_of(path: Path) -> int:
    return len(contents(path, '/diagnosis'))


@pytest.mark.parametrize('after', ['the same', 'a new one', 'none'])
@pytest.mark.parametrize('times', [{}, SNAPSHOTS])
def test_blocks_that_the_diagnosis_did_not_receive_make_no_sound_recording_differ(
    after: str, times: dict[str, float], tmp_path: Path
) -> None:
    """It was busy, inactive or not there; the recorder had them all."""
    values = read_values(SPECS, {'shaft_hz': 25.3, **times})
    run = DiagnosisRun(values)
    runs = {'the same': run, 'a new one': DiagnosisRun(values), 'none': None}
    # Behind the 13th block of a snapshot.
    lacking = {201: None, 300: runs[after]}
    simulator = Simulator(preset('incipient', defect='inner'))
    record(tmp_path / 'run', run, simulator, dict.fromkeys(range(600), math.nan), lacking)
    result = reproduce(tmp_path / 'run')
    # The begin of a snapshot that is cut short is not known any more.
    skipped = int(bool(times) and after == 'the same')
    assert result.topics['/diagnosis'] == Agreement(
        identical=verdicts_of(tmp_path / 'run') - skipped, skipped=skipped
    )
    said = {
        'the same': f'has not received the samples {201 * 1024} to {300 * 1024}',
        'a new one': f'was restarted at sample {300 * 1024}',
        'none': 'the diagnosis ended before, or its verdicts are lost',
    }
    assert any(said[after] in note for note in result.notes), result.notes


def test_a_source_that_is_restarted_makes_no_sound_recording_differ(tmp_path: Path) -> None:
    """Its last snapshot is cut short, and has the time of its own samples."""
    simulator = Simulator(preset('incipient', defect='inner'))
    run = DiagnosisRun(read_values(SPECS, {'shaft_hz': 25.3, **SNAPSHOTS}))
    numbers = dict.fromkeys(range(600), math.nan)
    record(tmp_path / 'run', run, simulator, numbers, first=201)
    diagnosis = reproduce(tmp_path / 'run').topics['/diagnosis']
    assert diagnosis == Agreement(identical=verdicts_of(tmp_path / 'run'))
    verdicts = [m.decode() for m in read_messages(tmp_path / 'run', topics=['/diagnosis'])]
    (cut,) = [v for v in verdicts if v.sample_count < 25 * 1024]
    assert (cut.first_sample, cut.sample_count) == (188 * 1024, 13 * 1024)
    assert stamp_ns(cut.header.stamp) == 188 * samples_ns(1024, 25600.0)


def test_a_snapshot_shorter_than_wanted_has_the_time_of_its_own_samples() -> None:
    """The samples of each are counted from 0, so that the next one alone tells that it is all."""
    run = DiagnosisRun(read_values(SPECS, {'shaft_hz': 25.3, **SNAPSHOTS}))
    rng, stamps = np.random.default_rng(0), []
    for second in range(0, 50, 10):
        x = rng.standard_normal(20000).astype(np.float32)
        block = VibrationBlock(0, x, 25600.0, 25.3, 'm/s^2', simulated=False, stamp=second * NANO)
        stamps += [
            stamp_ns(verdict.judge(verdict.excerpt.analyse()).diagnosis.header.stamp)
            for verdict in run.take(block, temperature=math.nan, joint_hz=math.nan)
        ]
    assert stamps == [0, 10 * NANO, 20 * NANO, 30 * NANO]


@pytest.mark.parametrize('times', [{}, SNAPSHOTS])
def test_parameters_that_change_to_and_fro_make_no_sound_recording_differ(
    times: dict[str, float], tmp_path: Path
) -> None:
    """
    The window begins anew, although the next checkpoint has the parameters from before.

    A snapshot that has begun is given up.
    """
    values = read_values(SPECS, {'shaft_hz': 25.3, **times})
    run = DiagnosisRun(values)

    class Changed(DiagnosisRun):
        def needs_checkpoint(self, block: VibrationBlock) -> bool:
            if block.first_sample == 200 * 1024:
                self.reconfigure({**values, 'window': 2.0})
                self.reconfigure(values)
            return super().needs_checkpoint(block)

    run.__class__ = Changed
    simulator = Simulator(preset('incipient', defect='inner'))
    record(tmp_path / 'run', run, simulator, dict.fromkeys(range(600), math.nan))
    diagnosis = reproduce(tmp_path / 'run').topics['/diagnosis']
    assert diagnosis == Agreement(identical=verdicts_of(tmp_path / 'run'))


def test_snapshots_with_pauses_between_them_are_compared(tmp_path: Path) -> None:
    series = {'shaft_hz': 25.3, 'series_cycle': 20.0, 'series_snapshot': 1.0}
    simulator = Simulator(preset('incipient', defect='inner'))
    # Snapshots of a second, 20 s apart, and some blocks more; in the third one a block is missing.
    numbers = [500 * k + n for k in range(6) for n in range(28) if (k, n) != (2, 10)]
    run = DiagnosisRun(read_values(SPECS, series))
    record(tmp_path / 'run', run, simulator, dict.fromkeys(numbers, math.nan))
    diagnosis = reproduce(tmp_path / 'run').topics['/diagnosis']
    assert diagnosis == Agreement(identical=6)


def test_the_begin_of_a_snapshot_that_the_diagnosis_lacks_makes_no_sound_recording_differ(
    tmp_path: Path,
) -> None:
    """A few blocks are enough: the next one, begun later, has other samples."""
    run = DiagnosisRun(read_values(SPECS, {'shaft_hz': 25.3, **SNAPSHOTS}))
    simulator = Simulator(preset('incipient', defect='inner'))
    numbers = dict.fromkeys(range(600), math.nan)
    record(tmp_path / 'run', run, simulator, numbers, {185: None, 191: run})
    verdicts = [m.decode() for m in read_messages(tmp_path / 'run', topics=['/diagnosis'])]
    assert verdicts[1].first_sample == 191 * 1024
    diagnosis = reproduce(tmp_path / 'run').topics['/diagnosis']
    assert diagnosis == Agreement(identical=len(verdicts))


@pytest.mark.parametrize(
    ('series', 'runs', 'first'),
    [
        # It ended, began anew, and right after this the source was restarted as well.
        (False, {40: None, 186: 'another'}, 208),
        # It was inactive while the source was restarted.
        (True, {320: None, 837: 'the same'}, 349),
    ],
)
def test_restarts_of_diagnosis_and_source_that_meet_make_no_sound_recording_differ(
    series: bool, runs: dict[int, str | None], first: int, tmp_path: Path
) -> None:
    values = read_values(SPECS, {'shaft_hz': 25.3, **(SNAPSHOTS if series else {})})
    run = DiagnosisRun(values)
    named = {None: None, 'the same': run, 'another': DiagnosisRun(values)}
    chosen = {number: named[name] for number, name in runs.items()}
    simulator = Simulator(preset('incipient', defect='inner'))
    numbers = (*range(60), *range(157, 400)) if not series else range(900)
    record(tmp_path / 'run', run, simulator, dict.fromkeys(numbers, math.nan), chosen, first)
    verdicts = verdicts_of(tmp_path / 'run')
    assert verdicts > 2
    diagnosis = reproduce(tmp_path / 'run').topics['/diagnosis']
    assert diagnosis == Agreement(identical=verdicts)


def test_verdicts_that_come_seconds_late_are_compared(run: Path, tmp_path: Path) -> None:
    """The diagnosis, which has become busy, is as late with its checkpoints."""
    busy = next(m.log_time for m in read_messages(run)) + 2 * NANO
    late = [
        m._replace(log_time=m.log_time + 5 * NANO, publish_time=m.publish_time + 5 * NANO)
        if m.topic.startswith('/diagnosis') and m.log_time > busy
        else m
        for m in read_messages(run)
    ]
    with RecordingWriter(tmp_path / 'late') as writer:
        for message in sorted(late, key=lambda message: message.log_time):
            put(writer, message)
    assert reproduce(tmp_path / 'late').topics['/diagnosis'] == Agreement(identical=12)


@pytest.mark.parametrize('lacking', [(), (3,), (12, 13)])
def test_a_source_that_sends_more_often_than_the_series_needs_makes_few_checkpoints(
    lacking: tuple[int, ...], tmp_path: Path
) -> None:
    """The state of a series is large. The diagnosis may lack bursts, one with a snapshot, too."""
    series = {'shaft_hz': 25.3, 'series_cycle': 60.0, 'series_snapshot': 0.3}
    simulator = Simulator(preset('incipient', defect='inner'))
    numbers = [125 * burst + n for burst in range(40) for n in range(10)]
    run = DiagnosisRun(read_values(SPECS, series))
    runs = {number: None if number // 125 in lacking else run for number in numbers}
    record(tmp_path / 'run', run, simulator, dict.fromkeys(numbers, math.nan), runs)
    verdicts = verdicts_of(tmp_path / 'run')
    assert verdicts >= 4
    assert len(contents(tmp_path / 'run', '/diagnosis_checkpoint')) <= 2 * verdicts + 1
    diagnosis = reproduce(tmp_path / 'run').topics['/diagnosis']
    assert diagnosis == Agreement(identical=verdicts)


@pytest.mark.parametrize(('cycle', 'seconds'), [(499, 20.0), (500, 20.0), (49, 2.0)])
def test_snapshots_that_a_pause_cuts_short_make_no_sound_recording_differ(
    cycle: int, seconds: float, tmp_path: Path
) -> None:
    """Such a verdict comes after the pause; checkpoints are within or between the snapshots."""
    series = {'shaft_hz': 25.3, 'series_cycle': seconds, 'series_snapshot': 2.5}
    simulator = Simulator(preset('incipient', defect='inner'))
    numbers = [cycle * k + n for k in range(14) for n in range(28)]
    run = DiagnosisRun(read_values(SPECS, series))
    record(tmp_path / 'run', run, simulator, dict.fromkeys(numbers, math.nan))
    diagnosis = reproduce(tmp_path / 'run').topics['/diagnosis']
    assert (diagnosis.different, diagnosis.missing) == (0, 0)
    assert diagnosis.identical + diagnosis.skipped == 13


@pytest.mark.parametrize(('number', 'identical'), [(100, 4), (249, 9)])
def test_a_missing_block_costs_the_verdicts_on_it(
    number: int, identical: int, run: Path, tmp_path: Path
) -> None:
    """One of them is the last one before a checkpoint."""
    lost = contents(run, '/vibration')[number]
    lossy = rewritten(run, tmp_path / 'lossy', lambda _, cdr: None if cdr == lost else cdr)
    result = reproduce(lossy)
    diagnosis = result.topics['/diagnosis']
    assert diagnosis == Agreement(identical=identical, skipped=12 - identical)
    assert any(note.startswith('/diagnosis: blocks are missing') for note in result.notes)


def test_a_recording_from_before_a_parameter_existed_is_not_judged_and_one_sentence_says_why(
    run: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Such a twin had perfect surfaces, and started in another way: no bit would be the same."""

    def older(message: Any, cdr: bytes) -> bytes:
        checkpoint = message.decode() if message.topic == '/twin_checkpoint' else None
        if checkpoint is None:
            return cdr
        kept = {n: v for n, v in configuration_values(checkpoint).items() if n != 'waviness'}
        return changed(message, configuration=yaml.safe_dump(kept))

    before = rewritten(run, tmp_path / 'before', older)
    assert main(['verify', str(before)]) != 0
    said = capsys.readouterr().err.strip().splitlines()
    assert len(said) == 1
    assert "the parameter 'waviness' of the twin is missing" in said[0]
    assert 'run it again with that version' in said[0]


@pytest.mark.parametrize('rate', [-1.0, 0.0, float('nan'), float('inf'), 1e308])
@pytest.mark.parametrize('first', [0, 3])
def test_absurd_sample_rates_are_a_sentence(
    run: Path, tmp_path: Path, rate: float, first: int
) -> None:
    def absurd(message: Any, cdr: bytes) -> bytes:
        if message.topic != '/vibration' or message.decode().first_sample < first * 1024:
            return cdr
        return changed(message, sample_rate=rate)

    result = reproduce(rewritten(run, tmp_path / 'absurd', absurd))
    assert not result.identical
    assert any('a block is refused: sample_rate=' in note for note in result.notes)


def test_a_claimed_number_of_samples_is_not_believed(run: Path, tmp_path: Path) -> None:
    def claim(message: Any, cdr: bytes) -> bytes:
        if message.topic != '/twin_state':
            return cdr
        return changed(message, sample_count=16_777_216)

    result = reproduce(rewritten(run, tmp_path / 'claims', claim))
    vibration = result.topics['/vibration']
    assert (vibration.identical, vibration.different, vibration.skipped) == (0, 0, 300)


@pytest.mark.parametrize('name', ['/fan/twin/vibration', '/fan/simulated', '/elsewhere/vibration'])
def test_a_twin_whose_vibration_was_renamed_beside_a_sensor(
    run: Path, tmp_path: Path, name: str
) -> None:
    """As machine.launch.py has it: what is named as the twin's vibration is the sensor's."""
    target = tmp_path / 'machine'
    with RecordingWriter(target) as writer:
        for m in read_messages(run):
            if m.topic == '/vibration':
                put(writer, m, '/fan/vibration', changed(m, source=Vibration.SOURCE_MEASURED))
                put(writer, m, name)
            elif not m.topic.startswith('/diagnosis'):
                put(writer, m, f'/fan{m.topic}')
    result = reproduce(target)
    assert result.identical, result
    assert result.topics[name].identical == 12 * 25
    assert result.topics.keys() == {name, '/fan/twin_state'}
    assert any(note.startswith('/fan/vibration: no twin') for note in result.notes)


def test_renamed_checkpoints_and_verdicts_are_compared(run: Path, tmp_path: Path) -> None:
    names = {
        '/twin_checkpoint': '/plant/states_of_twins',
        '/diagnosis_checkpoint': '/plant/states',
        '/diagnosis': '/verdict',
    }
    with RecordingWriter(tmp_path / 'one') as one, RecordingWriter(tmp_path / 'two') as two:
        for m in read_messages(run):
            put(one, m, names.get(m.topic, m.topic))
            put(two, m, names.get(m.topic, m.topic))
            if m.topic == '/diagnosis':
                put(two, m, '/other')
    result = reproduce(tmp_path / 'one')
    assert result.identical, result
    assert result.topics['/vibration'].identical == 12 * 25
    assert result.topics['/verdict'].identical == 12
    # Which one is the diagnosis's own?
    uncompared = reproduce(tmp_path / 'two').uncompared
    assert uncompared == ['/diagnosis', '/other', '/verdict']


def test_renamed_checkpoints_of_a_second_node_are_not_those_of_the_first(
    run: Path, tmp_path: Path
) -> None:
    with RecordingWriter(tmp_path / 'two') as two:
        for m in read_messages(run):
            put(two, m)
            if m.topic.endswith('_checkpoint'):
                put(two, m, f'{m.topic}s', changed(m, node='/second', state=np.zeros(1, np.uint8)))
    assert reproduce(tmp_path / 'two').identical


def test_a_renamed_twin_without_its_first_block_takes_no_other_twins(
    run: Path, tmp_path: Path
) -> None:
    target = tmp_path / 'machines'
    first = True
    with RecordingWriter(target) as writer:
        for m in read_messages(run, topics=['/vibration', '/twin_state', '/twin_checkpoint']):
            for machine in ('/m1', '/m2'):
                if machine == '/m2' and m.topic == '/vibration' and first:
                    first = False
                    continue
                name = m.topic.replace('/vibration', '/twin/vibration')
                put(writer, m, f'{machine}{name}')
    result = reproduce(target)
    assert result.topics['/m1/twin/vibration'].identical == 12 * 25
    # The next checkpoint is that of block 250.
    assert result.topics['/m2/twin/vibration'].identical == 50


def changed(message: Any, **fields: Any) -> bytes:
    """Return the bytes of a message in which some fields have other values."""
    types = store(message.type_name)
    decoded = message.decode()
    for name, value in fields.items():
        object.__setattr__(decoded, name, value)
    return bytes(types.serialize_cdr(decoded, message.type_name))


def without(*topics: str) -> Callable[[Any, bytes], bytes | None]:
    return lambda message, cdr: None if message.topic in topics else cdr


def test_verify_says_what_it_did_not_compare(
    run: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    blind = rewritten(run, tmp_path / 'blind', without('/diagnosis_checkpoint'))
    result = reproduce(blind)
    assert result.topics['/vibration'].identical == 12 * 25
    assert (result.uncompared, result.identical) == (['/diagnosis'], False)
    assert main(['verify', str(blind)]) == 1
    assert 'NOT compared: /diagnosis;' in capsys.readouterr().out
    # A sensor's vibration is nobody's to re-run; the diagnosis of it is.
    measured = rewritten(run, tmp_path / 'measured', without('/twin_checkpoint', '/twin_state'))
    assert main(['verify', str(measured)]) == 0
    said = capsys.readouterr().out
    assert 'no twin was recorded with it' in said
    assert 'identical to the byte: /diagnosis\n' in said


def test_a_recording_begun_within_a_run(schedule: Path, tmp_path: Path) -> None:
    often = {'checkpoint_period': 1.0}
    run_offline(schedule, tmp_path / 'often', twin=often, diagnosis=often)
    start = next(m.log_time for m in read_messages(tmp_path / 'often'))

    def late(message: Any, cdr: bytes) -> bytes | None:
        return cdr if message.log_time > start + 3e9 else None

    result = reproduce(rewritten(tmp_path / 'often', tmp_path / 'late', late))
    vibration, diagnosis = result.topics['/vibration'], result.topics['/diagnosis']
    assert result.identical, result
    # The window of 8 s of the last verdict alone is all in the recording, with the second before
    # it, on which it rests, and a checkpoint lies between it and the verdict before.
    assert (vibration.identical, vibration.skipped) == (9 * 25, 0)
    assert (diagnosis.identical, diagnosis.skipped) == (1, 8)


def test_windows_that_do_not_touch_are_made_again_from_a_checkpoint_between_them(
    tmp_path: Path,
) -> None:
    seldom = {'shaft_hz': 25.3, 'window': 2.0, 'memory': 2.0, 'update_interval': 7.0}
    simulator = Simulator(preset('incipient', defect='inner'))
    run = DiagnosisRun(read_values(SPECS, seldom))
    record(tmp_path / 'run', run, simulator, dict.fromkeys(range(1250), math.nan))

    def late(message: Any, cdr: bytes) -> bytes | None:
        return cdr if message.log_time > 22e9 else None

    diagnosis = reproduce(rewritten(tmp_path / 'run', tmp_path / 'late', late)).topics[
        '/diagnosis'
    ]
    # Verdicts at 28, 35, 42 and 49 s, checkpoints at 30 and 40 s.
    assert diagnosis == Agreement(identical=3, skipped=1)


def test_nothing_to_verify_and_nothing_to_run(schedule: Path, run: Path, tmp_path: Path) -> None:
    with pytest.raises(BearingTwinError, match='no checkpoint'):
        reproduce(schedule)
    with pytest.raises(BearingTwinError, match='is not overwritten'):
        run_offline(schedule, run)
    with pytest.raises(BearingTwinError, match='there is no parameter'):
        run_offline(schedule, tmp_path / 'a', twin={'color': 'red'})
    with pytest.raises(BearingTwinError, match='must be of type'):
        run_offline(schedule, tmp_path / 'a', twin={'seed': 'x'})
    with pytest.raises(BearingTwinError, match=r'window=0.1 is outside 1..60 s'):
        run_offline(schedule, tmp_path / 'a', diagnosis={'window': 0.1})
    assert main(['verify', str(schedule)]) == 1
    only_vibration = tmp_path / 'only'
    rewritten(run, only_vibration, lambda m, cdr: cdr if m.topic == '/vibration' else None)
    with pytest.raises(BearingTwinError, match=r'holds no sensor_msgs/msg/Temperature'):
        run_offline(only_vibration, tmp_path / 'a')


def test_an_interrupted_run_is_a_sound_recording(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    source, target = tmp_path / 'long.mcap', tmp_path / 'cut'
    write_temperature_recording(source, *paper_schedule(3600.0), source='test')

    def interrupt() -> None:
        while not target.exists() or sum(p.stat().st_size for p in target.iterdir()) < 1e6:
            time.sleep(0.01)
        signal.raise_signal(signal.SIGINT)

    threading.Thread(target=interrupt, daemon=True).start()
    assert main(['replay', '--offline', str(source), '-o', str(target)]) == 130
    said = capsys.readouterr()
    assert 'of 3600.0 s, where it was stopped' in said.out
    assert 'stopping' in said.err
    assert examine(target)[1].problems == []
    assert reproduce(target).identical


def test_no_calibration_at_all_is_a_figure_that_misses_its_target(run: Path) -> None:
    with_calibration = punctuality(run, 0, 2**63, calibrate=True)
    assert with_calibration['blocks'] == 12 * 25
    assert with_calibration['fits'] == 0.0 and FIGURES['fits'].target == '> 0'
    assert with_calibration.keys() - punctuality(run, 0, 2**63, calibrate=False) == {'fits'}


@pytest.mark.ros
def test_a_live_run_is_reproduced_offline(ros_domain: int, tmp_path: Path, schedule: Path) -> None:
    with ForkedNodes(tmp_path / 'logs', os.environ) as nodes, Source() as source:
        nodes.start('recorder', {'output': str(tmp_path / 'bag')})
        # What one of them is held up for, the other shall not have alone.
        deep = {'qos_overrides./vibration.subscription.depth': 1000}
        renamed = ('-r', 'diagnosis:=verdict', '-r', 'diagnosis_checkpoint:=/plant/states')
        nodes.start('diagnosis', {'bearing': '6307', 'update_interval': 0.5, **deep}, ros=renamed)
        source.wait_for_recorder(recorders=2)
        source.wait_for('diagnosis: vibration input')
        source.wait_for('recorder: recording')
        own = {
            'defect': 'outer:angle=-1.3,width=0.001+ball:ball=2',
            'lubricant.viscosity_40': 46e-6,
            'beta0.expansion': False,
            'resonance_hz': 4500.0,
        }
        # No verdict of a block that the diagnosis had and the recorder had not.
        deep = {f'qos_overrides./{t}.publisher.depth': 1000 for t in ('vibration', 'twin_state')}
        nodes.start(
            'twin',
            {'bearing': '6307', 'wait_for_subscribers': 2, **own, **deep},
            ros=('-r', 'twin_checkpoint:=/plant/states'),
        )
        source.wait_for('twin: real time')
        # Blocks before the recorder had found the twin are lost; a reset gives a checkpoint now.
        assert source.call(Trigger, '/twin/reset').success
        verdicts: list[Diagnosis] = []
        source.node.create_subscription(Diagnosis, 'verdict', verdicts.append, RESULT)
        replay = {'recording': str(schedule), 'rate': 2.0}
        nodes.start('replay', {**replay, 'subscriber_timeout': TIMEOUT})
        assert nodes.wait('replay', TIMEOUT) == 0
        source.until(lambda: len(verdicts) > 10, 'verdicts')
        for name in ('twin', 'diagnosis', 'recorder'):
            assert nodes.end(name) == 0
    result = reproduce(tmp_path / 'bag')
    assert result.identical, result
    # Fewer where a machine that is busy with something else makes the twin give up blocks.
    assert result.topics['/vibration'].identical > 100
    assert result.topics['/verdict'].identical > 3
    assert result.topics['/verdict'].skipped == 0
    checkpoints = [m.decode() for m in read_messages(tmp_path / 'bag', topics=['/plant/states'])]
    kept = [configuration_values(made) for made in checkpoints if made.kind == 'twin']
    assert own.items() <= kept[-1].items()


@pytest.mark.ros
def test_a_fleet_is_reproduced_offline(ros_domain: int, tmp_path: Path) -> None:
    assets = tmp_path / 'assets.yaml'
    # Not in the order of the alphabet, one of another bearing, one without a diagnosis.
    assets.write_text(
        """
        assets:
          pump/right:
            twin: {defect: inner, seed: 3}
            diagnosis: {window: 1.0}
          pump/left:
            twin: {seed: 1, shaft_hz: 29.0}
          fan:
            twin: {bearing: '6205', seed: 2, thermal_mode: physical}
        """
    )
    bag = tmp_path / 'bag'
    with ForkedNodes(tmp_path / 'logs', os.environ) as nodes, Source() as source:
        nodes.start('recorder', {'output': str(bag)}, ros=('-r', '__ns:=/p1'))
        nodes.start(
            'fleet',
            {'assets_file': str(assets), 'block_size': 2048, 'checkpoint_period': 1.0},
            ros=('-r', '__ns:=/p1'),
        )
        source.wait_for('p1/fleet: real time')
        source.wait_for('p1/recorder: recording')
        blocks: list[Vibration] = []
        source.node.create_subscription(Vibration, '/p1/fan/vibration', blocks.append, STREAM)
        source.until(lambda: len(blocks) > 25, 'blocks')
        assert source.call(Trigger, '/p1/fleet/reset').success
        assert source.call(Trigger, '/p1/pump/left/twin/reset').success
        until = len(blocks) + 60
        source.until(lambda: len(blocks) > until, 'blocks after the reset')
        assert nodes.end('fleet') == 0
        assert nodes.end('recorder') == 0
    result = reproduce(bag)
    vibration = {f'/p1/{name}/vibration' for name in ('pump/right', 'pump/left', 'fan')}
    states = {name.replace('vibration', 'twin_state') for name in vibration}
    assert result.topics.keys() == vibration | states | {'/p1/pump/right/diagnosis'}
    assert result.identical, result
    assert all(result.topics[name].identical > 25 for name in vibration)

    # A checkpoint may follow one of them at once, so that nothing is skipped for it; not both.
    fan = contents(bag, '/p1/fan/vibration')
    lost = {fan[-20], fan[-16]}

    def drop(message: Any, cdr: bytes) -> bytes | None:
        return None if cdr in lost else cdr

    lossy = reproduce(rewritten(bag, tmp_path / 'lossy', drop))
    assert lossy.identical, lossy
    assert any('a block of /p1/fan/vibration is missing' in note for note in lossy.notes)
    skipped = {
        name: lossy.topics[name].skipped - result.topics[name].skipped for name in vibration
    }
    # Of the 18 blocks until the end, those before the next checkpoint: one comes each 12.5 blocks.
    assert 0 < skipped.pop('/p1/fan/vibration') <= 13
    assert not any(skipped.values())
