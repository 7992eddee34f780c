# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Re-run of recorded twins, block by block: each one alone, or those of a fleet together."""

from __future__ import annotations

from typing import Any, NamedTuple, TYPE_CHECKING

from bearing_twin.assets.checkpoints import configuration_values
from bearing_twin.assets.fleet import build_fleet
from bearing_twin.assets.twin import Twin, vibration_message
from bearing_twin.dynamics.simulator import Block
from bearing_twin.offline.agreement import Agreement
from bearing_twin.offline.output import output
from bearing_twin.stamps import stamp_ns
from bearing_twin.streams.pacer import Due

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from bearing_twin.dynamics.fleet import Fleet
    from bearing_twin.offline.agreement import Reproduction
    from bearing_twin.recording.reader import RecordedMessage

__all__ = ['FleetCheck', 'TwinCheck']


class Recorded(NamedTuple):
    """A recorded block and what its state says of it."""

    message: RecordedMessage
    due: Due
    """Index, time and number of the block."""
    length: int
    temperature: float
    shaft_hz: float


class TwinCheck:
    """Re-run of one twin; blocks of a twin in a fleet are handed to the fleet's re-run."""

    def __init__(self, namespace: str, result: Reproduction) -> None:
        self.topic = f'{namespace}/vibration'
        self._result = result
        self._twin: Twin | None = None
        self._fleet: FleetCheck | None = None
        self._pending: Any = None
        self._recorded: RecordedMessage | None = None
        self._published = -1
        self._of_twin = False

    @property
    def _agreement(self) -> Agreement:
        return self._result.topics.setdefault(self.topic, Agreement())

    def join(self, fleet: FleetCheck) -> None:
        """Let a fleet's re-run make the blocks."""
        self._of_twin = True
        self._fleet = fleet

    def checkpoint(self, checkpoint: Any) -> None:
        """Go on from here, unless that is where the re-run is anyway."""
        self._of_twin = True
        twin = self._twin
        if twin is not None:
            same = twin.values == configuration_values(checkpoint)
            if same and twin.save() == bytes(checkpoint.state):
                return
            what = 'went on from another state' if same else 'was changed'
            self._note(f'the twin {what} at sample {checkpoint.first_sample}')
        self._pending = checkpoint

    def vibration(self, message: RecordedMessage) -> None:
        """Keep a recorded block until its state has come."""
        if self._recorded is not None:
            self._agreement.skipped += 1
        self._recorded = message

    def state(self, state: Any) -> None:
        """Re-run the block that this state belongs to."""
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
        due = Due(first, stamp_ns(vibration.header.stamp), 0.0, number)
        block = Recorded(
            message, due, length, float(state.temperature_used), float(state.shaft_hz)
        )
        if self._fleet is not None:
            self._fleet.take(self, block)
        else:
            self._rerun(block)

    def _rerun(self, block: Recorded) -> None:
        if self._pending is not None and int(self._pending.first_sample) == block.due.first_sample:
            self._twin = Twin(configuration_values(self._pending))
            self._twin.load(bytes(self._pending.state))
            self._pending = None
        elif block.due.number != self._published + 1:
            self._lose()
        self._published = block.due.number
        if self._twin is None:
            self.skip()
            return
        made = self._twin.simulator.advance(block.length, block.temperature, block.shaft_hz)
        self.compare(block, made, self._twin.values)

    def compare(self, block: Recorded, made: Block, values: Mapping[str, Any]) -> None:
        """Compare a recorded block with the one that was made again."""
        again = output('/vibration', vibration_message(made, block.due, values))
        what = f'{self.topic} at sample {block.due.first_sample}'
        self._agreement.compare(block.message, again.cdr, what)

    def skip(self) -> None:
        """Count a block that cannot be re-run."""
        self._agreement.skipped += 1

    def finish(self) -> None:
        """Count the last block, which waits for its state; sensor data cannot be re-run."""
        if self._recorded is not None:
            self._agreement.skipped += 1
        if not self._of_twin and self._result.topics.pop(self.topic, None) is not None:
            self._note('no twin was recorded with it; it is taken as measured')

    def _lose(self) -> None:
        """Wait for the next checkpoint: a block is missing in the recording."""
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

    A block is made when the next one begins, with the temperatures and speeds that its states
    carry. No bearing of a fleet acts on another: where the block of one is missing, the others go
    on, and that one waits for the next checkpoint.
    """

    def __init__(self, node: str, result: Reproduction) -> None:
        self._node = node
        self._result = result
        self._fleet: Fleet | None = None
        self._pending: Any = None
        self._configuration: dict[str, Any] = {}
        self._members: list[TwinCheck] = []
        self._inputs: list[tuple[float, float]] = []
        self._lost: set[int] = set()
        self._blocks: dict[int, Recorded] = {}
        self._published = -1

    def checkpoint(self, checkpoint: Any, twin_of: Callable[[str], TwinCheck]) -> None:
        """Go on from here, unless that is where the re-run is; ``twin_of`` a namespace."""
        self.advance()
        configuration = configuration_values(checkpoint)
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
        if any(other.due.number != block.due.number for other in self._blocks.values()):
            self.advance()
        self._blocks[self._members.index(member)] = block

    def advance(self) -> None:
        """Make the block again that has been collected; compare."""
        blocks, self._blocks = self._blocks, {}
        if not blocks:
            return
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
            self._inputs[index] = block.temperature, block.shaft_hz
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
            again = Block(
                first_sample=made.first_sample,
                x=made.x[index],
                y=made.y[index],
                condition=self._fleet.condition(index),
            )
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
