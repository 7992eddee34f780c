# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Number of bearings at 25.6 kHz that one core runs live, with and without DDS."""

from __future__ import annotations

from collections.abc import Callable
import math
import os
from pathlib import Path
import tempfile
import time
from typing import NamedTuple

from bearing_twin.bench.end_to_end import cpu_seconds, wait_for
from bearing_twin.diagnosis import compilation as diagnosis_kernels
from bearing_twin.dynamics import compilation as kernels
from bearing_twin.dynamics import Fleet, preset
from bearing_twin.errors import BearingTwinError
from bearing_twin.nodes.fleet import BLOCK
from bearing_twin.recording.reader import read_messages
from bearing_twin.ros.processes.domain import own_domain
from bearing_twin.ros.processes.launching import local_environment, NodeProcesses

FEW = 16
"""Bearings of the first run."""
PROVED = 0.5
"""Fraction of the claimed bearings that must run to prove the claim."""
GROWTH = 4
"""Largest ratio of a run's bearings to the largest number that kept time."""
CLOSE = 1.25
"""A search ends if the smallest late fleet is less than this times the largest in time."""
MORE = 1.05
"""Least ratio of a run's bearings to the largest number that kept time."""
MOST_RUNS = 6
"""Largest number of runs of a search, with repeated ones."""
START_TIMEOUT = 120.0
"""Time limit for the start of a fleet with compiled kernels, s; one of 150 takes 15 s."""
SETTLE, SETTLE_DIAGNOSIS = 4.0, 14.0
"""Time before the measurement, s; with diagnosis, until all windows have grown to 8 s."""
MEASURED = 20.0
UPDATE = 25600
"""Samples from one verdict to the next, 1 s."""
BLOCKS = 50
"""Blocks over which the equations alone are timed, 10 s of each bearing."""


class FleetRun(NamedTuple):
    """Processor time of a live fleet, and its late and missing messages."""

    bearings: int
    share: float
    """Share of a core."""
    late: int
    """Blocks published more than `late_after` behind their deadline."""
    missing: int
    """Blocks that were dropped, and blocks and verdicts that the recorder does not have."""

    @property
    def kept_time(self) -> bool:
        """Whether every block and every verdict came in time."""
        return not (self.late or self.missing)


class Search:
    """
    Search with growing fleets, until half of what their cost allows has kept time.

    A fleet that is late runs again, since another process may have had the core for a moment. What
    a bearing costs is its part of the largest run that kept time. The share of the process as such
    is in it, so a small run claims less. The claim is at most twice the largest number that kept
    time.
    """

    def __init__(self) -> None:
        self._runs: list[FleetRun] = []
        self._late: list[int] = []

    def add(self, run: FleetRun) -> None:
        """Add a run."""
        if run.kept_time:
            self._runs.append(run)
        elif self._runs or not self._late:
            self._late.append(run.bearings)
        else:
            raise BearingTwinError(
                f'of {run.bearings} bearings {run.late} blocks were late and {run.missing} were '
                'missing; leave more of the machine to it'
            )

    @property
    def following(self) -> int:
        """Return the number of bearings of the next run; 0 if the search has ended."""
        if not self._runs:
            return FEW
        if self.made == MOST_RUNS:
            return 0
        most, late = self.proved, self.late
        if late and self._late.count(late) == 1:
            return late
        wanted = min(math.ceil(PROVED * self._affordable), GROWTH * most)
        if late and wanted >= late:
            wanted = round(math.sqrt(most * late))
            if late < CLOSE * most:
                return 0
        return wanted if wanted >= MORE * most else 0

    @property
    def made(self) -> int:
        """Return the number of runs so far."""
        return len(self._runs) + len(self._late)

    @property
    def claim(self) -> float:
        """Return the number of bearings that one core can run."""
        return min(self._affordable, self.proved / PROVED)

    @property
    def proved(self) -> int:
        """Largest number of bearings that kept time."""
        return self._runs[-1].bearings

    @property
    def late(self) -> int:
        """Smallest larger number that did not keep time; 0 if all did."""
        return min((late for late in self._late if late > self.proved), default=0)

    @property
    def _affordable(self) -> float:
        return self.proved / self._runs[-1].share


def measure(say: Callable[[str], None] = lambda _: None) -> dict[str, float]:
    """
    Run fleets until half of what a core can run has run without late or missing blocks.

    Parameters
    ----------
    say
        Called with a sentence before and after each run.

    Raises
    ------
    BearingTwinError
        If a fleet of 16 does not keep time.

    """
    say('the kernels are compiled where they are not yet')
    kernels.warm_up(fleet=True)
    diagnosis_kernels.warm_up()
    plain = _search(say, diagnosis=False)
    # Directly after the fleet of the same size, as the speed of the machine varies.
    without = 1.0 / _advance_share(plain.proved)
    diagnosed = _search(say, diagnosis=True)
    return {
        'live_bearings_per_core': plain.claim,
        'live_bearings_run': float(plain.proved),
        'live_bearings_late': float(plain.late),
        'live_bearings_per_core_with_diagnosis': diagnosed.claim,
        'live_bearings_run_with_diagnosis': float(diagnosed.proved),
        'live_bearings_late_with_diagnosis': float(diagnosed.late),
        'live_bearings_per_core_without_dds': without,
        'live_ratio': plain.claim / without,
        'live_ratio_with_diagnosis': diagnosed.claim / without,
    }


def _search(say: Callable[[str], None], *, diagnosis: bool) -> Search:
    search = Search()
    with_what = ' with a diagnosis each' if diagnosis else ''
    while count := search.following:
        say(f'run {search.made + 1} of at most {MOST_RUNS}: {count} bearings{with_what} ...')
        began = time.monotonic()
        run = _run_fleet(count, diagnosis=diagnosis)
        search.add(run)
        say(
            f'{run.share:.2f} of a core, {run.late} blocks late, {run.missing} missing, '
            f'after {time.monotonic() - began:.0f} s'
        )
    return search


def _advance_share(count: int) -> float:
    """Return the share of a core of equations and state of one twin in a fleet of ``count``."""
    fleet = Fleet([preset('incipient', defect='inner')] * count)
    fleet.advance(BLOCK, 20.0, 25.4)
    fleet.condition(0)
    began = time.process_time()
    for _ in range(BLOCKS):
        fleet.advance(BLOCK, 20.0, 25.4)
        for index in range(count):
            fleet.condition(index)
    spent = time.process_time() - began
    return spent * fleet.sample_rate / (BLOCKS * BLOCK * count)


def _run_fleet(count: int, *, diagnosis: bool) -> FleetRun:
    """Run a fleet of ``count`` bearings and a recorder."""
    with tempfile.TemporaryDirectory() as name, own_domain(os.getpid()) as domain:
        folder = Path(name)
        parts = 'twin: {defect: inner}' + (', diagnosis: {}' if diagnosis else '')
        assets = '\n'.join(f'  bearing_{k}: {{{parts}}}' for k in range(count))
        (folder / 'assets.yaml').write_text(f'assets:\n{assets}\n')
        environment = local_environment(domain)
        with NodeProcesses(folder / 'logs', environment) as nodes:
            nodes.start('recorder', {'output': str(folder / 'bag')})
            nodes.start('fleet', {'assets_file': str(folder / 'assets.yaml')})
            wait_for(folder / 'bag', nodes, bearings=count, within=START_TIMEOUT)
            time.sleep(SETTLE_DIAGNOSIS if diagnosis else SETTLE)
            began, cpu = time.time_ns(), cpu_seconds(nodes.pid('fleet'))
            time.sleep(MEASURED)
            ended = time.time_ns()
            share = (cpu_seconds(nodes.pid('fleet')) - cpu) / (ended - began) * 1e9
            nodes.check()
            nodes.end('fleet')
            nodes.end('recorder')
        late, missing = _blocks(folder / 'bag', count, began, ended)
        if diagnosis:
            missing += _missing(folder / 'bag', count, 'diagnosis', UPDATE, began, ended)
        return FleetRun(count, share, late, missing)


def _blocks(bag: Path, count: int, began: int, ended: int) -> tuple[int, int]:
    """Count late and missing blocks of all bearings between two times, ns."""
    # A block is late for all bearings at once.
    ((first, *_, last),) = _recorded(
        bag, ['/bearing_0/twin_state'], 'blocks_late', began, ended
    ).values()
    return last - first, _missing(bag, count, 'vibration', BLOCK, began, ended)


def _missing(bag: Path, count: int, name: str, step: int, began: int, ended: int) -> int:
    """Count the missing messages of all bearings; one is due each ``step`` samples."""
    topics = [f'/bearing_{k}/{name}' for k in range(count)]
    firsts = _recorded(bag, topics, 'first_sample', began, ended)
    if not all(firsts.values()):
        msg = f'{sum(not f for f in firsts.values())} of {count} bearings were not recorded'
        raise BearingTwinError(msg)
    return sum((max(f) - min(f)) // step + 1 - len(f) for f in firsts.values())


def _recorded(
    bag: Path, topics: list[str], field: str, began: int, ended: int
) -> dict[str, list[int]]:
    """Return the integers in a field of the messages between two times, ns, by topic."""
    found: dict[str, list[int]] = {topic: [] for topic in topics}
    for message in read_messages(bag, topics=topics):
        if began <= message.log_time <= ended:
            found[message.topic].append(int(getattr(message.decode(), field)))
    return found
