# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Fleet node: many twins and diagnoses in one process."""

from __future__ import annotations

from collections import deque
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import partial
import math
from textwrap import indent
import time
from typing import Any, TYPE_CHECKING

from bearing_twin.assets.checkpoints import Checkpoints
from bearing_twin.assets.fleet import build_fleet, read_assets, SHARED
from bearing_twin.assets.parameters import realtime as realtime_parameters
from bearing_twin.assets.parameters import twin as twin_parameters
from bearing_twin.assets.parameters.shared import STATE_RATE, SUBSCRIBERS
from bearing_twin.assets.parameters.spec import fixed
from bearing_twin.assets.parameters.twin import build_parameters, build_simulator
from bearing_twin.assets.twin import TwinChannel, TwinInputs
from bearing_twin.assets.twin_messages import StateSchedule, TwinBlock, vibration_block
from bearing_twin.diagnosis import compilation as diagnosis
from bearing_twin.dynamics import compilation as dynamics
from bearing_twin.nodes.diagnosis_topics import DiagnosisTopics
from bearing_twin.nodes.fleet_member import Member
from bearing_twin.nodes.twin_services import TwinServices
from bearing_twin.nodes.twin_topics import LONGEST_WAIT, TwinTopics
from bearing_twin.ros import realtime
from bearing_twin.ros.cycle import BlockCycle
from bearing_twin.ros.health import Health
from bearing_twin.ros.lifecycle import ManagedNode
from bearing_twin.ros.topics.qos import CHECKPOINT
from bearing_twin.ros.topics.subscribing import receiver_clock
from bearing_twin.streams.pacer import Due
from bearing_twin_msgs.msg import Checkpoint

if TYPE_CHECKING:
    from bearing_twin.dynamics.fleet.fleet import Fleet, FleetBlock
    from bearing_twin.dynamics.single.simulator import Simulator


BLOCK = 5120
"""Samples per block, 200 ms: each block has one of five states a second."""

CROWDED = 60.0
"""Time after a late block for which each slot has its own verdicts, s."""

GOLDEN = (math.sqrt(5.0) - 1.0) / 2.0
"""Inverse golden ratio: fractional parts of its consecutive multiples are spread evenly."""

SPECS = (
    fixed('assets_file', '', 'YAML file of the assets; see config/fleet.yaml.', read_only=True),
    fixed('names', [''], 'Namespaces of assets with a twin and a diagnosis each, where no file '
          'is.', read_only=True),
    *(
        replace(spec, read_only=True, default=BLOCK if spec.name == 'block_size' else spec.default)
        for spec in twin_parameters.SPECS
        if spec.name in SHARED
    ),
    fixed('slots', 4, 'Wake-ups a block period over which the publishing is spread.', '', 1, 40),
    fixed('threads', 1, 'Cores that share the equations, sixteen bearings at a time; no sample '
          'depends on it.', '', 1, 64),
    *realtime_parameters.SPECS,
    SUBSCRIBERS,
    replace(STATE_RATE, default=5.0),
)  # fmt: skip


def _verdicts_until(phase: float, slots: int, *, crowded: bool) -> int:
    """
    Return the slot before which a wake-up at a phase of the block period (0..1) ends its verdicts.

    In a row verdicts take less time than after a sleep. But on a ``crowded`` processor, who has
    used it in a row waits for it, and the next block is late.

    Examples
    --------
    >>> [_verdicts_until(phase, 4, crowded=False) for phase in (0.0, 0.25, 0.5, 0.75)]
    [3, 3, 3, 4]
    >>> [_verdicts_until(phase, 4, crowded=True) for phase in (0.0, 0.25, 0.5, 0.75)]
    [1, 2, 3, 4]

    """
    own = math.floor(phase * slots + 1e-6) + 1
    return own if crowded else max(own, slots - 1)


@dataclass(frozen=True)
class Pending:
    """A computed block of one bearing that waits for its publishing slot."""

    index: int
    block: FleetBlock
    due: Due
    inputs: TwinInputs
    took: float
    """Time to compute the blocks of all bearings, s."""


class FleetNode(ManagedNode):
    """
    Host many twins and diagnoses, each with topics and parameters of its own.

    The equations of all twins are advanced in one call at the end of a block period. The blocks
    are published and diagnosed over the next period. A diagnosis whose twin runs in the same node
    receives the blocks directly, and its verdicts wait if they would delay a block. Any other
    diagnosis subscribes to its vibration topic.
    """

    fleet = True

    def __init__(self) -> None:
        super().__init__('fleet', SPECS)
        p = self.parameters
        self._assets = read_assets(p['assets_file'], p['names'])
        self._members: list[Member] = []

    def bring_up(self) -> None:
        """Declare the parameters of the assets; then configure and activate the node."""
        self.refused = True
        self._declare()
        self.refused = False
        super().bring_up()

    def _declare(self) -> None:
        # Only after the functions that check them are compiled.
        self._members = self._members or [
            Member(self, asset, self._apply_twin, self._apply_diagnosis) for asset in self._assets
        ]

    def check(self, values: Mapping[str, Any]) -> None:
        """Refuse a warning threshold above its error threshold."""
        realtime.check_thresholds(values)

    def prepare(self) -> None:
        """Compile the numerical functions of the hosted twins and diagnoses."""
        if any(asset.twin is not None for asset in self._assets):
            dynamics.warm_up(fleet=True)
        if any(asset.diagnosis is not None for asset in self._assets):
            diagnosis.warm_up()

    def setup(self) -> None:
        """Create twins, diagnoses, topics and statuses of the assets; compute a trial block."""
        p = self.parameters
        self._declare()
        # First, because it may be refused: then there is nothing to clean up.
        self._cycle = BlockCycle(
            self, p, self._compute, slots=p['slots'], between=self._spend_slot
        )
        self._pending: deque[Pending] = deque()
        self._verdicts: deque[DiagnosisTopics] = deque()
        self._verdict_took = 0.0
        self._twins = [m for m in self._members if m.twin_parameters is not None]
        self._fleet = self._build_fleet()
        node = self.get_fully_qualified_name()
        self._checkpoints = Checkpoints('fleet', node, p['checkpoint_period'])
        self._checkpoint = self.create_lifecycle_publisher(Checkpoint, '~/checkpoint', CHECKPOINT)
        self.health = Health(self, self.get_namespace())
        for index, member in enumerate(self._members):
            self._set_up_twin(member)
            # Verdicts of neighbouring assets fall on different blocks, as they are published
            # directly after each other.
            self._set_up_diagnosis(member, stagger=index * GOLDEN % 1.0)
        self.health.add('real time', self._cycle.status)
        self._warm()
        self.offer('~/reset', self._reset_all)

    def _warm(self) -> None:
        """Compute a block and its messages and undo it, as the first real block has a deadline."""
        if self._fleet is None:
            return
        start, due = self._fleet.save(), Due(0, 0, 0.0)
        inputs = self._inputs()
        block = self._advance(inputs)
        fields = self._cycle.fields(due)
        for index, (member, each) in enumerate(zip(self._twins, inputs, strict=True)):
            assert member.twin is not None
            member.twin.warm_up(
                TwinBlock(self._fleet.of_bearing(block, index), *each), due, fields
            )
        self._fleet.load(start)

    def _build_fleet(self) -> Fleet | None:
        """Return all twins in their initial state; None if only diagnoses are hosted."""
        values = [self._start(m) for m in self._twins]
        return build_fleet(values, threads=self.parameters['threads']) if values else None

    def _start(self, member: Member) -> dict[str, Any]:
        """Return the parameters of a twin, with the temperature for a restart."""
        assert member.twin_parameters is not None
        values = dict(member.twin_parameters.values)
        if member.channel is not None:
            values['start_temperature'] = member.channel.start_temperature
        return values

    def _set_up_twin(self, member: Member) -> None:
        p = member.twin_parameters
        if p is None:
            return
        member.channel = TwinChannel(
            p.values, settle=partial(self._settle_twin, member), clock=receiver_clock(self)
        )
        shared = self.parameters
        period = shared['block_size'] / shared['sample_rate']
        member.twin = TwinTopics(
            self,
            member.channel,
            schedule=StateSchedule(shared['state_rate'], period, self._twins.index(member)),
            prefix=f'{member.name}/',
            checkpoints=False,
        )
        TwinServices(
            self,
            p,
            reset=partial(self._reset_twin, member),
            save=lambda: self._simulator(member).save(),
            load=partial(self._load_twin, member),
            path=f'{member.name}/twin',
            prefix=f'{member.prefix}.twin.',
        )
        hardware_id = p['hardware_id'] or member.name
        for part, status in (
            ('temperature input', member.twin.status),
            ('validity', member.twin.validity),
        ):
            self.health.add(f'{member.name} {part}', status, hardware_id=hardware_id)

    def _set_up_diagnosis(self, member: Member, *, stagger: float) -> None:
        p = member.diagnosis_parameters
        if p is None:
            return
        member.diagnosis = DiagnosisTopics(self, p, prefix=f'{member.name}/')
        self.offer(f'{member.name}/diagnosis/reset', member.diagnosis.reset)
        blocks = p['update_interval'] * self.parameters['sample_rate']
        member.wait = int(stagger * blocks / self.parameters['block_size'])
        hardware_id = p['hardware_id'] or member.name
        for part, status in (
            ('vibration input', member.diagnosis.input_status),
            ('bearing', member.diagnosis.verdict_status),
        ):
            self.health.add(f'{member.name} {part}', status, hardware_id=hardware_id)

    def start(self) -> None:
        """Subscribe to the inputs and start the block cycle."""
        for member in self._members:
            if member.diagnosis is not None:
                member.diagnosis.listen(sensors=member.twin is None)
        deadline = time.monotonic() + LONGEST_WAIT
        for member in self._twins:
            assert member.twin is not None
            member.twin.await_subscribers(self.parameters['wait_for_subscribers'], deadline)
        self._checkpoints.ask()
        self._cycle.start()
        diagnoses = sum(m.diagnosis is not None for m in self._members)
        self.get_logger().info(f'{len(self._twins)} twins and {diagnoses} diagnoses')

    def stop(self) -> None:
        """Stop the block cycle; publish the waiting blocks and save the states."""
        self._cycle.stop()
        try:
            # The waiting blocks have already been counted as published.
            self._publish_share(1.0)
            while self._verdicts:
                self._verdicts.popleft().judge()
        finally:
            # After Ctrl-C publishing fails, as the context is shut down: still save the states.
            for member in self._members:
                if member.diagnosis is not None:
                    member.diagnosis.keep_state()

    def teardown(self) -> None:
        """Release twins and diagnoses of all members."""
        for member in self._members:
            member.release()

    def _apply_twin(self, member: Member, values: Mapping[str, Any]) -> None:
        if member.channel is not None and self._fleet is not None:
            # The waiting blocks were computed with the former parameters.
            self._publish_share(1.0)
            member.channel.apply(values)
            self._fleet.reconfigure(self._twins.index(member), build_parameters(values))
            self._checkpoints.ask()

    def _apply_diagnosis(self, member: Member, values: Mapping[str, Any]) -> None:
        if member.diagnosis is not None:
            member.diagnosis.apply(values)

    def _compute(self, due: Due) -> None:
        self._publish_share(1.0)
        if self._fleet is None:
            return
        if self._checkpoints.is_due(due.first_sample):
            self._publish_checkpoint(due)
        inputs = self._inputs()
        began = time.perf_counter()
        block = self._advance(inputs)
        took = time.perf_counter() - began
        for index, each in enumerate(inputs):
            self._pending.append(Pending(index, block, due, each, took))

    def _inputs(self) -> list[TwinInputs]:
        """Return temperature (degC) and speed (Hz) of each twin for the next block."""
        return [member.channel.inputs for member in self._twins if member.channel]

    def _advance(self, inputs: list[TwinInputs]) -> FleetBlock:
        assert self._fleet is not None
        return self._fleet.advance(
            self.parameters['block_size'],
            [temperature.used for temperature, _ in inputs],
            [shaft_hz for _, shaft_hz in inputs],
        )

    def _spend_slot(self, phase: float) -> None:
        """Publish the blocks of this slot; use the time that is left for verdicts."""
        began, slots = time.perf_counter(), self.parameters['slots']
        self._publish_share(phase)
        slot = self._cycle.period / slots
        crowded = self._cycle.punctual <= CROWDED
        # A verdict can wait for a later slot; the next block cannot.
        end = began + (_verdicts_until(phase, slots, crowded=crowded) - phase * slots) * slot
        while self._verdicts and (begins := time.perf_counter()) + self._verdict_took < end:
            self._verdicts.popleft().judge()
            # Expect the slowest recent verdict, but at most half a slot, so that one always fits.
            now = time.perf_counter()
            self._verdict_took = min(max(now - begins, 0.9 * self._verdict_took), 0.5 * slot)
            self._publish_share(phase + (now - began) / self._cycle.period)

    def _publish_share(self, phase: float) -> None:
        """Publish the blocks that are due at a phase of the period (0..1)."""
        after = max(0.0, 1.0 - phase - 1.0 / self.parameters['slots'])
        remaining = math.floor(len(self._twins) * after + 1e-6)
        while len(self._pending) > remaining:
            self._publish(self._pending.popleft())

    def _publish(self, item: Pending) -> None:
        member = self._twins[item.index]
        assert self._fleet is not None
        assert member.twin is not None and member.channel is not None
        began = time.perf_counter() - item.took
        made = TwinBlock(self._fleet.of_bearing(item.block, item.index), *item.inputs)
        topics, values = member.twin, member.channel.values
        topics.vibration.publish(topics.bytes.vibration(made, item.due, values))
        # The time that the block waited for its slot does not count.
        took = {'execution_time': time.perf_counter() - began}
        topics.publish_state(made, item.due, self._cycle.fields(item.due) | took)
        if member.wait:
            member.wait -= 1
        elif (diagnosis := member.diagnosis) is not None:
            block = vibration_block(made, item.due, values, diagnosis.parameters['axis'])
            if diagnosis.hold(block, temperature=made.temperature.taken):
                self._verdicts.append(diagnosis)

    def _publish_checkpoint(self, due: Due) -> None:
        assert self._fleet is not None
        # In the order of the fleet, as the state is. A name such as `on` needs its quotes.
        configuration = (
            f'"{member.name}":\n{indent(member.twin_parameters.text, "  ")}'
            for member in self._twins
            if member.twin_parameters
        )
        self._checkpoint.publish(
            self._checkpoints.make(
                due.first_sample,
                stamp=due.stamp,
                sample_rate=self.parameters['sample_rate'],
                configuration=''.join(configuration),
                state=self._fleet.save(),
            )
        )

    def _simulator(self, member: Member) -> Simulator:
        assert self._fleet is not None
        return self._fleet.extract(self._twins.index(member))

    def _reset_twin(self, member: Member) -> None:
        self._place(member, build_simulator(self._start(member)))

    def _settle_twin(self, member: Member, temperature: float) -> None:
        assert self._fleet is not None
        self._publish_share(1.0)
        self._fleet.settle(self._twins.index(member), temperature)
        self._checkpoints.ask()

    def _load_twin(self, member: Member, state: bytes) -> None:
        simulator = self._simulator(member)
        simulator.load(state)
        self._place(member, simulator)
        if member.channel is not None:
            member.channel.settled = True

    def _place(self, member: Member, simulator: Simulator) -> None:
        assert self._fleet is not None
        self._publish_share(1.0)
        self._fleet.place(self._twins.index(member), simulator)
        self._checkpoints.ask()

    async def _reset_all(self) -> str:
        # The waiting blocks have already been counted as published.
        self._publish_share(1.0)
        self._fleet = self._build_fleet()
        self._checkpoints.ask()
        for answer in [m.diagnosis.reset() for m in self._members if m.diagnosis is not None]:
            await answer
        return f'{len(self._members)} assets start anew'


NODE = FleetNode
