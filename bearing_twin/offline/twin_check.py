# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Re-run recorded twins block by block: single twins, or the twins of a fleet together."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any, NamedTuple, TYPE_CHECKING

from bearing_twin.assets.checkpoints import configuration_values, parameters_of
from bearing_twin.assets.fleet import build_fleet
from bearing_twin.assets.parameters.spec import completed
from bearing_twin.assets.parameters.twin import SPECS
from bearing_twin.assets.twin import Twin, TwinInputs
from bearing_twin.assets.twin_messages import REALTIME, TwinBlock, TwinBytes
from bearing_twin.offline.agreement import Agreement
from bearing_twin.offline.output import output
from bearing_twin.stamps import stamp_ns
from bearing_twin.streams.pacer import Due
from bearing_twin.thermal.gate import GatedTemperature

if TYPE_CHECKING:
    from bearing_twin.dynamics.fleet.fleet import Fleet
    from bearing_twin.offline.agreement import Reproduction
    from bearing_twin.recording.mcap.catalogue import RecordedMessage


_TOGETHER = 25
"""Blocks of one twin that are computed at a time."""


class Recorded(NamedTuple):
    """A recorded block, and its inputs from the twin state."""

    message: RecordedMessage
    due: Due
    """Index, time and number of the block."""
    length: int
    inputs: TwinInputs
    state: tuple[RecordedMessage, Any] | None = None
    """The twin state after the block, if it was published, and its content."""


class TwinCheck:
    """Re-run of one twin; blocks of a twin in a fleet are passed to the re-run of the fleet."""

    def __init__(self, topic: str, result: Reproduction) -> None:
        self.topic = topic
        self._result = result
        self._twin: Twin | None = None
        self._fleet: FleetCheck | None = None
        self._pending: Any = None
        self._recorded: RecordedMessage | None = None
        self._published = -1
        self._of_twin = False
        self._sparse = False
        self._last: Recorded | None = None
        # Many blocks are computed in one call: the twin waits for the interpreter after each call.
        self._waiting: list[Recorded] = []
        # Serialiser of the blocks, by their length.
        self._bytes: dict[int, TwinBytes] = {}

    @property
    def _agreement(self) -> Agreement:
        return self._result.topics.setdefault(self.topic, Agreement())

    def join(self, fleet: FleetCheck) -> None:
        """Let the re-run of a fleet compute the blocks from now on."""
        self._make()
        self._of_twin = self._sparse = True
        self._fleet = fleet

    def checkpoint(self, checkpoint: Any) -> None:
        """Continue from a checkpoint, unless the re-run already has the same state."""
        self.settle()
        self._make()
        self._of_twin = True
        self._sparse = float(configuration_values(checkpoint).get('state_rate', 0.0)) > 0.0
        twin = self._twin
        if twin is not None:
            same = twin.values == completed(SPECS, configuration_values(checkpoint))
            if same and twin.save() == bytes(checkpoint.state):
                return
            what = 'went on from another state' if same else 'was changed'
            self._note(f'the twin {what} at sample {checkpoint.first_sample}')
        self._pending = checkpoint

    def vibration(self, message: RecordedMessage) -> None:
        """Keep a recorded block until its state or the next block arrives."""
        self.settle()
        self._recorded = message

    def has_block_of(self, state: Any) -> bool:
        """Return whether the waiting block, or an earlier one, belongs to the twin of a state."""
        return self._last is not None or self.waits_for(state)

    def waits_for(self, state: Any) -> bool:
        """Return whether the first block, still without a state, belongs to a state's twin."""
        if self._last is not None or self._recorded is None:
            return False
        block = self._recorded.decode()
        same_time = stamp_ns(block.header.stamp) == stamp_ns(state.header.stamp)
        return same_time and int(block.first_sample) == int(state.first_sample)

    def take_over(self, other: TwinCheck) -> None:
        """Take the blocks of another topic, to which the vibration of the twin was remapped."""
        self.topic, self._recorded = other.topic, other._recorded

    def state(self, recorded: RecordedMessage, state: Any) -> None:
        """Re-run the block to which this state belongs."""
        self._of_twin = True
        message, self._recorded = self._recorded, None
        if message is None:
            self._lose()
            return
        vibration = message.decode()
        first, length = int(state.first_sample), int(state.sample_count)
        if first != int(vibration.first_sample) or length != len(vibration.y):
            self._agreement.skipped += 1
            self._lose()
            return
        number = int(state.blocks_published)
        # Vibration and state have one stamp.
        due = Due(first, stamp_ns(state.header.stamp), 0.0, number)
        measured, used = float(state.temperature_measured), float(state.temperature_used)
        temperature = GatedTemperature(
            used, measured, measured, float(state.temperature_age), state.temperature_status
        )
        inputs = TwinInputs(temperature, float(state.shaft_hz))
        self._take(Recorded(message, due, length, inputs, (recorded, state)))

    def settle(self) -> None:
        """
        Re-run the waiting block, whose state was not published.

        A twin with ``state_rate`` does not publish every state, but it publishes each state whose
        inputs have changed. So the inputs of the last state still apply.
        """
        message, self._recorded = self._recorded, None
        if message is None:
            return
        last, vibration = self._last, message.decode()
        first, length = int(vibration.first_sample), len(vibration.y)
        if not self._sparse or last is None or vibration.shaft_hz != last.inputs.shaft_hz:
            self._agreement.skipped += 1
            return
        number = last.due.number + (first - last.due.first_sample) // last.length
        due = Due(first, stamp_ns(vibration.header.stamp), 0.0, number)
        self._take(last._replace(message=message, due=due, length=length, state=None))

    def _take(self, block: Recorded) -> None:
        self._last = block
        if self._fleet is not None:
            self._fleet.take(self, block)
        else:
            self._rerun(block)

    def _rerun(self, block: Recorded) -> None:
        if self._pending is not None and int(self._pending.first_sample) == block.due.first_sample:
            self._make()
            self._twin = Twin(completed(SPECS, configuration_values(self._pending)))
            self._twin.load(bytes(self._pending.state))
            self._pending = None
        elif block.due.number != self._published + 1:
            self._lose()
        self._published = block.due.number
        if self._twin is None:
            self.skip()
            return
        if self._waiting and block.length != self._waiting[0].length:
            self._make()
        self._waiting.append(block)
        if len(self._waiting) == _TOGETHER:
            self._make()

    def _make(self) -> None:
        """Compute the waiting blocks again and compare them."""
        waiting, self._waiting = self._waiting, []
        if waiting and self._twin is not None:
            inputs = [block.inputs for block in waiting]
            made = self._twin.advance_all(inputs, waiting[0].length)
            for block, again in zip(waiting, made, strict=True):
                self.compare(block, again, self._twin.values)

    def compare(self, block: Recorded, made: TwinBlock, values: Mapping[str, Any]) -> None:
        """Compare a recorded block with the block of the re-run."""
        if block.length not in self._bytes:
            self._bytes = {block.length: TwinBytes(lambda message: output('', message).cdr)}
        twin_bytes, due, at = self._bytes[block.length], block.due, f'at sample {block.due[0]}'
        again = twin_bytes.vibration(made, due, values)
        self._agreement.compare(block.message, again, f'{self.topic} {at}')
        if block.state is not None:
            message, state = block.state
            again = twin_bytes.state(made, due, values, {n: getattr(state, n) for n in REALTIME})
            states = self._result.topics.setdefault(message.topic, Agreement())
            states.compare(message, again, f'{message.topic} {at}')

    def skip(self) -> None:
        """Count a block that cannot be re-run."""
        self._agreement.skipped += 1

    def finish(self) -> None:
        """Process the waiting blocks; drop the topic if no twin made it, as for sensor data."""
        self.settle()
        self._make()
        if not self._of_twin and self._result.topics.pop(self.topic, None) is not None:
            self._note('no twin was recorded with it; it is taken as measured')

    def _lose(self) -> None:
        """Stop until the next checkpoint, because a block is missing in the recording."""
        self._make()
        if self._twin is not None:
            self._note(
                f'blocks are missing after block {self._published}; '
                'the re-run goes on at the next checkpoint'
            )
        self._twin = None

    def _note(self, text: str) -> None:
        self._result.notes.append(f'{self.topic}: {text}')


class FleetCheck:
    """
    Re-run of the twins of a fleet, which are advanced together.

    A block is computed when the block after the next one begins, with the temperatures and speeds
    of its states or, without a state, the last ones before it. The bearings of a fleet do not
    influence each other. If the block of one bearing is missing, the others continue, and this one
    waits for the next checkpoint.
    """

    def __init__(self, node: str, result: Reproduction) -> None:
        self._node = node
        self._result = result
        self._fleet: Fleet | None = None
        self._pending: Any = None
        self._configuration: dict[str, Any] = {}
        self._members: list[TwinCheck] = []
        self._inputs: list[tuple[float, float]] = []
        """Temperature (degC) and speed (Hz) of each twin."""
        self._lost: set[int] = set()
        self._blocks: dict[int, dict[int, Recorded]] = {}
        self._published = -1

    def checkpoint(self, checkpoint: Any, twin_of: Callable[[str], TwinCheck]) -> None:
        """
        Continue from a checkpoint, unless the re-run already has the same state.

        ``twin_of`` returns the re-run of the twin in a namespace.
        """
        self.finish()
        configured = configuration_values(checkpoint).items()
        with parameters_of('fleet'):
            configuration = {name: completed(SPECS, values) for name, values in configured}
        if self._fleet is not None:
            same = configuration == self._configuration
            if same and not self._lost and self._fleet.save() == bytes(checkpoint.state):
                return
            what = 'goes on from another state' if same else 'was changed'
            if not self._lost:
                self._note(f'the fleet {what} at sample {checkpoint.first_sample}')
        namespace = self._node.rpartition('/')[0]
        self._members = [twin_of(f'{namespace}/{name}') for name in configuration]
        for member in self._members:
            member.join(self)
        self._configuration = configuration
        self._fleet, self._pending = None, checkpoint

    def take(self, member: TwinCheck, block: Recorded) -> None:
        """Take the recorded block of a twin."""
        if member not in self._members:
            member.skip()
            return
        self._blocks.setdefault(block.due.number, {})[self._members.index(member)] = block
        # Only when the next block begins is it known that a block has no state.
        while block.due.number > min(self._blocks) + 1:
            self._advance()

    def finish(self) -> None:
        """Compute all collected blocks."""
        for member in self._members:
            member.settle()
        while self._blocks:
            self._advance()

    def _advance(self) -> None:
        """Compute the first of the collected blocks and compare it."""
        blocks = self._blocks.pop(min(self._blocks))
        due, length = next((block.due, block.length) for block in blocks.values())
        if self._pending is not None and int(self._pending.first_sample) == due.first_sample:
            self._resume()
        elif self._fleet is not None and due.number != self._published + 1:
            self._note(f'blocks are missing after block {self._published}')
            self._fleet = None
        self._published = due.number
        if self._fleet is None:
            for index in blocks:
                self._members[index].skip()
            return
        for index, block in blocks.items():
            self._inputs[index] = block.inputs.temperature.used, block.inputs.shaft_hz
        for index in set(range(len(self._members))) - blocks.keys() - self._lost:
            self._lost.add(index)
            self._note(f'a block of {self._members[index].topic} is missing')
        temperatures, speeds = zip(*self._inputs, strict=True)
        made = self._fleet.advance(length, temperatures, speeds)
        values = list(self._configuration.values())
        for index, block in blocks.items():
            if index in self._lost:
                self._members[index].skip()
                continue
            again = TwinBlock(self._fleet.of_bearing(made, index), *block.inputs)
            self._members[index].compare(block, again, values[index])

    def _resume(self) -> None:
        values = list(self._configuration.values())
        self._fleet = build_fleet(values)
        self._fleet.load(bytes(self._pending.state))
        self._inputs = [(float(v['start_temperature']), float(v['shaft_hz'])) for v in values]
        self._lost.clear()
        self._pending = None

    def _note(self, text: str) -> None:
        self._result.notes.append(f'{self._node}: {text}')
