# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""
Long operation of the real nodes on a clock that runs fast.

Twin, diagnosis and recorder run as processes with ``use_sim_time``; this process is their clock
and their temperature sensor, listens to what they say, and keeps count of what reaches the disk.
The clock runs at the pace asked for and never more than ``AHEAD`` before the slowest node, so that
a busy machine lowers the pace that is reported and not the number of blocks.

Differences from real operation: blocks of 8192 samples instead of 1024, because a callback of
rclpy costs the same for both, and a verdict each 10 s instead of each second. Publisher and
diagnosis keep as many blocks as pass in two seconds of the machine, as they do every day. Rate,
window, twin, recorder and DDS are those of every day.
"""

from __future__ import annotations

import argparse
from collections.abc import Mapping
from contextlib import nullcontext
from dataclasses import asdict, dataclass, field
import json
import math
import os
from pathlib import Path
import sys
import time

from bearing_twin import cli
from bearing_twin.assets.messages import time_message
from bearing_twin.recording.health import examine
from bearing_twin.recording.reader import recording_info
from bearing_twin.ros.processes.domain import own_domain
from bearing_twin.ros.processes.launching import local_environment, NodeProcesses
from bearing_twin.ros.topics.qos import STREAM
from bearing_twin.stamps import NANO, stamp_ns
from bearing_twin_msgs.msg import Diagnosis, TwinState
from probe import Probe
import psutil
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import Temperature
import yaml

RATE = 25600.0
BLOCK = 8192
UPDATE_INTERVAL = 10.0
START = 1_600_000_000 * NANO
TICK = 0.004
"""Time between two readings of the clock, s of the machine."""
AHEAD = {'twin': 4.0, 'diagnosis': UPDATE_INTERVAL + 4.0, 'recorder': 120.0}
"""Most operated time that the clock may be ahead of a node, s: below what its queues hold."""
LONGEST_WAIT = 0.5
"""Time that a message may wait for the recorder, s of the machine: its queue holds 2.7 s."""
DEPTH = 400
"""Blocks kept for whoever is held up: at 60 times real time, two seconds of the machine."""
MEMORY_PERIOD = 0.5
MIB = 1024 * 1024
NODES = ('twin', 'diagnosis', 'recorder')
STATUSES = ('twin: real time', 'diagnosis: vibration input', 'recorder: recording')
"""What each of them reports once a second."""


@dataclass
class SoakReport:
    """What a soak has shown. Operated time in s."""

    operated: float = 0.0
    pace: float = 0.0
    """Operated seconds per second of the machine."""
    published: int = 0
    """Blocks that the twin says to have published."""
    recorded: int = 0
    """Blocks in the files of the recording, those deleted at the storage limit included."""
    dropped: int = 0
    """Blocks that the twin gave up."""
    samples_missed: int = 0
    """By the diagnosis."""
    messages_missed: int = 0
    """By the recorder, of any topic: results wait ten deep, which is short at this pace."""
    files: int = 0
    megabytes: float = 0.0
    drift: float = 0.0
    """Largest difference of stamp and sample index, s."""
    clock_steps: int = 0
    """Times the twin found its stamps off the clock and set them anew."""
    lag: list[float] = field(default_factory=list)
    """Least time from the end of a block to its state, in each tenth of the run, s."""
    verdicts: dict[str, int] = field(default_factory=dict)
    memory: dict[str, list[tuple[float, float]]] = field(default_factory=dict)
    """Of each node: operated time, and resident memory in MB."""
    cpu: dict[str, float] = field(default_factory=dict)
    """Of each node: processor time per second of the machine."""
    problems: list[str] = field(default_factory=list)
    """Of the part of the recording that is left, as ``bearing-twin info`` finds them."""

    def growth(self, node: str) -> float:
        """Return how much more memory the second half took at most than the first, MB."""
        sizes = [size for _, size in self.memory[node]]
        half = len(sizes) // 2
        return max(sizes[half:]) - max(sizes[:half])


class _Clock(Probe):
    """The clock of the nodes, their temperature sensor, and an ear for what they say."""

    def __init__(self, domain: int, pace: float, swing: float) -> None:
        super().__init__(domain)
        self._pace, self._swing = pace, swing
        # Deep, because they are recorded too, and a busy machine may be seconds late.
        self._clock = self.node.create_publisher(Clock, '/clock', 1000)
        self._temperature = self.node.create_publisher(Temperature, 'temperature', 1000)
        self.node.create_subscription(TwinState, 'twin_state', self._on_state, STREAM)
        self.node.create_subscription(Diagnosis, 'diagnosis', self._on_verdict, STREAM)
        self.watch_diagnostics()
        self.now = 0.0
        self.state: TwinState | None = None
        self.reached = dict.fromkeys(AHEAD, 0.0)
        self.drift = 0.0
        self.lags: list[float] = []
        self.verdicts: dict[str, int] = {}
        self._origin: int | None = None
        self._began = self._ticked = time.monotonic()
        self._told = self._told_at = self._felt = 0.0
        self._readings = 0

    def wait_for(self, statuses: set[str], said: str = '') -> None:
        """Let the clock stand still until each node has reported again, with these words in it."""
        self.statuses.clear()
        self.until(
            lambda: all(n in self.statuses and said in self.status(n).message for n in statuses),
            f'a report of {", ".join(statuses)}',
            every=self._publish,
        )
        self._began = self._ticked = time.monotonic()

    def wait_until_still(self) -> None:
        """Let the clock stand until all that was sent is in, and each has said how it went."""
        end = time.monotonic() + 120.0
        still = 0
        while still < 3:
            self.statuses.clear()
            before = self.state
            while not self.statuses.keys() >= set(STATUSES):
                assert time.monotonic() < end, 'the nodes did not come to rest within 120 s'
                self.tick(advance=False)
            still = still + 1 if self.state is before else 0

    def tick(self, *, advance: bool = True) -> None:
        """Let the time go on for one tick, or wait for a node that is behind."""
        due = self._ticked + TICK
        while (left := due - time.monotonic()) > 0.0:
            self.executor.spin_once(timeout_sec=left)
        # What has come meanwhile, a tick's worth at most.
        self.executor.spin_once(timeout_sec=0.0)
        self._ticked = time.monotonic()
        values = self.status('recorder: recording').values
        if float(values.get('longest_wait_s', math.inf)) < LONGEST_WAIT:
            self.reached['recorder'] = self.clocks['recorder'] - START / NANO
        if advance:
            limit = min(self.reached[name] + AHEAD[name] for name in AHEAD)
            target = (self._ticked - self._began) * self._pace
            self.now = max(self.now, min(target, limit))
        # A node that is behind gets no further by being told the same time 250 times a second.
        if self.now > self._told or self._ticked > self._told_at + 0.1:
            self._publish()

    def _publish(self) -> None:
        stamp = time_message(START + round(self.now * NANO))
        self._clock.publish(Clock(clock=stamp))
        self._told, self._told_at = self.now, time.monotonic()
        self._readings += 1
        if self._readings % 20 == 0 or self.now >= self._felt + 4.0:
            self._felt = self.now
            phase = 2.0 * math.pi * self.now / self._swing
            message = Temperature(temperature=60.0 - 40.0 * math.cos(phase))
            message.header.stamp = stamp
            self._temperature.publish(message)

    def _on_state(self, state: TwinState) -> None:
        stamp = stamp_ns(state.header.stamp)
        if self._origin is None:
            self._origin = stamp - round(state.first_sample * NANO / RATE)
        elapsed = (stamp - self._origin) / NANO
        self.drift = max(self.drift, abs(elapsed - state.first_sample / RATE))
        end = (stamp - START) / NANO + state.sample_count / RATE
        self.lags.append(self.now - end)
        self.reached['twin'] = end
        self.state = state

    def _on_verdict(self, verdict: Diagnosis) -> None:
        self.verdicts[verdict.fault_code] = self.verdicts.get(verdict.fault_code, 0) + 1
        self.reached['diagnosis'] = (stamp_ns(verdict.header.stamp) - START) / NANO + 8.0


class _Files:
    """Blocks in the finished files of a recording, each counted before it may be deleted."""

    def __init__(self, bag: Path) -> None:
        self._bag = bag
        self._counted: set[str] = set()
        self.blocks = 0

    @property
    def count(self) -> int:
        return len(self._counted)

    def look(self) -> None:
        metadata = self._bag / 'metadata.yaml'
        if not metadata.exists():
            return
        bag = yaml.safe_load(metadata.read_text())['rosbag2_bagfile_information']
        for name in bag['relative_file_paths']:
            if name not in self._counted:
                self._counted.add(name)
                topic = recording_info(self._bag / name).topics.get('/vibration')
                self.blocks += topic.count if topic else 0


def soak(
    seconds: float,
    pace: float,
    folder: Path,
    *,
    domain: int,
    longest: float = math.inf,
    show: bool,
) -> SoakReport:
    """
    Operate the nodes for ``seconds`` at ``pace`` times real time; the bag is ``folder/bag``.

    It ends early when it has taken ``longest`` seconds of the machine.
    """
    # A node that compiles when the clock already goes falls behind it by a minute.
    assert cli.main(['compile', '--json']) == 0
    bag = folder / 'bag'
    sim: dict[str, object] = {'use_sim_time': True}
    report = SoakReport()
    files = _Files(bag)
    # Up to 100 degC and back twice a day, faster in a short run.
    with (
        _Clock(domain, pace, min(43200.0, seconds)) as clock,
        NodeProcesses(folder / 'logs', local_environment(domain)) as nodes,
    ):
        recorder = {'output': str(bag), 'max_bag_size': 256, 'storage_limit': 2048}
        nodes.start('recorder', {**sim, **recorder, 'delete_oldest': True})
        diagnosis = {'qos_overrides./vibration.subscription.depth': DEPTH}
        diagnosis |= {'update_interval': UPDATE_INTERVAL}
        nodes.start('diagnosis', {**sim, **diagnosis})
        clock.wait_for({'recorder: recording', 'diagnosis: vibration input'})
        twin = {'defect': 'outer', 'block_size': BLOCK, 'wait_for_subscribers': 2}
        twin |= {'qos_overrides./vibration.publisher.depth': DEPTH}
        nodes.start('twin', {**sim, **twin})
        # Its first block begins with its first reading of the clock, which may come between
        # two reports that it stands.
        for _ in range(2):
            clock.wait_for({'twin: real time'}, 'stands still')
        began = time.monotonic()
        processes = {name: psutil.Process(nodes.pid(name)) for name in NODES}
        spent = {name: sum(p.cpu_times()[:2]) for name, p in processes.items()}
        looked = shown = 0.0
        while clock.now < seconds and time.monotonic() - began < longest:
            clock.tick()
            nodes.check()
            if time.monotonic() - looked > MEMORY_PERIOD:
                looked = time.monotonic()
                _weigh(processes, clock.now, report)
                files.look()
            if show and time.monotonic() - shown > 30.0:
                shown = time.monotonic()
                _show(clock.now, shown - began, report)
        took = time.monotonic() - began
        report.cpu = {
            name: (sum(p.cpu_times()[:2]) - spent[name]) / took for name, p in processes.items()
        }
        clock.wait_until_still()
        _ask(clock, report)
        for name in NODES:
            assert nodes.end(name) == 0, name
    files.look()
    report.operated, report.pace = clock.now, clock.now / took
    report.recorded, report.files = files.blocks, files.count
    report.megabytes = sum(path.stat().st_size for path in bag.iterdir()) / 1e6
    tenth = max(1, len(clock.lags) // 10)
    parts = [clock.lags[k * tenth : (k + 1) * tenth] for k in range(10)]
    report.lag = [min(part) for part in parts if part]
    report.drift, report.verdicts = clock.drift, clock.verdicts
    report.problems = examine(bag)[1].problems
    return report


def _weigh(processes: Mapping[str, psutil.Process], now: float, report: SoakReport) -> None:
    for name, process in processes.items():
        report.memory.setdefault(name, []).append((now, process.memory_info().rss / 1e6))


def _ask(clock: _Clock, report: SoakReport) -> None:
    assert clock.state is not None
    report.published = clock.state.blocks_published
    report.dropped = clock.state.blocks_dropped
    twin, diagnosis, recorder = (clock.status(name).values for name in STATUSES)
    report.clock_steps = int(twin['clock_steps'])
    report.messages_missed = int(recorder['messages_lost_on_the_way'])
    report.samples_missed = int(diagnosis['samples_lost'])


def _show(now: float, took: float, report: SoakReport) -> None:
    sizes = ', '.join(f'{name} {report.memory[name][-1][1]:.0f} MB' for name in NODES)
    print(f'{now / 3600.0:5.2f} h at {now / max(took, 1e-3):3.0f} times; {sizes}', flush=True)


def summary(report: SoakReport) -> str:
    """Return the report in words."""
    lines = [
        f'operated        {report.operated / 3600.0:.2f} h at {report.pace:.1f} times real time',
        f'blocks          {report.published} published, {report.recorded} recorded in '
        f'{report.files} files, {report.dropped} dropped',
        f'missed          {report.samples_missed} samples by the diagnosis, '
        f'{report.messages_missed} messages of all topics by the recorder',
        f'drift           stamp and index differ by {report.drift * 1e9:.0f} ns at most, clock '
        f'set {report.clock_steps} times; behind it by {report.lag[0]:.2f} s in the first tenth, '
        f'{report.lag[-1]:.2f} s in the last (operated time)',
        f'verdicts        {report.verdicts}',
        f'on disk         {report.megabytes:.0f} MB; problems: {report.problems or "none"}',
    ]
    for node in NODES:
        sizes = [size for _, size in report.memory[node]]
        marks = ' '.join(f'{sizes[k * (len(sizes) - 1) // 8]:.0f}' for k in range(9))
        lines.append(
            f'{node:<15} {marks} MB in eighths, grew by {report.growth(node):+.1f} MB, '
            f'{100.0 * report.cpu[node]:.0f} % of a processor'
        )
    return '\n'.join(lines)


def main() -> int:
    """Soak from the command line; the whole report goes to ``FOLDER/soak.json``."""
    parser = argparse.ArgumentParser(description='Long operation of the real nodes.')
    parser.add_argument('folder', type=Path, help='folder to make, for recording, logs, report')
    parser.add_argument('--hours', type=float, default=24.0)
    parser.add_argument('--pace', type=float, default=60.0)
    parser.add_argument('--domain', type=int, default=0, help='ROS domain; 0: a quiet one')
    parser.add_argument('--minutes', type=float, default=math.inf, help='longest time it may take')
    args = parser.parse_args()
    args.folder.mkdir(parents=True)
    with nullcontext(args.domain) if args.domain else own_domain(os.getpid()) as domain:
        report = soak(
            args.hours * 3600.0,
            args.pace,
            args.folder,
            domain=domain,
            longest=args.minutes * 60.0,
            show=True,
        )
    (args.folder / 'soak.json').write_text(json.dumps(asdict(report)))
    print(summary(report))
    return 0


if __name__ == '__main__':
    sys.exit(main())
