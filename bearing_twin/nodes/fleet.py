# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Fleet node: many twins and diagnoses in one process."""

from __future__ import annotations

import math
import sys
from collections import deque
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING, Any

from std_srvs.srv import Trigger

from bearing_twin.errors import BearingTwinError
from bearing_twin.nodes import realtime
from bearing_twin.nodes.cycle import BlockCycle
from bearing_twin.nodes.diagnosis_asset import DiagnosisAsset
from bearing_twin.nodes.diagnosis_config import build_bearing, build_settings
from bearing_twin.nodes.fleet_config import (
    DIAGNOSIS_SPECS,
    SHARED,
    SPECS,
    TWIN_SPECS,
    read_assets,
)
from bearing_twin.nodes.health import Health
from bearing_twin.nodes.lifecycle import ManagedNode, run
from bearing_twin.nodes.parameters import ParameterSet
from bearing_twin.nodes.twin_asset import TwinAsset
from bearing_twin.nodes.twin_config import build_parameters, build_simulator

if TYPE_CHECKING:
    from collections.abc import Mapping

    from bearing_twin.dynamics import Block, Simulator
    from bearing_twin.nodes.fleet_config import Asset
    from bearing_twin.nodes.pacer import Due
    from bearing_twin.thermal.gate import GatedTemperature

__all__ = ['FleetNode', 'main']


@dataclass
class Member:
    """What the fleet hosts of one asset; None where it does not."""

    name: str
    twin_parameters: ParameterSet | None = None
    diagnosis_parameters: ParameterSet | None = None
    simulator: Simulator | None = None
    twin: TwinAsset | None = None
    diagnosis: DiagnosisAsset | None = None
    wait: int = 0
    """Blocks before the diagnosis begins, so that verdicts do not coincide."""


@dataclass(frozen=True)
class Pending:
    """One block that is computed and waits for its slot."""

    member: Member
    block: Block
    due: Due
    temperature: GatedTemperature


class FleetNode(ManagedNode):
    """Host many twins and diagnoses, each with topics and parameters of its own.

    The blocks of all twins are computed together when a period is over; their publishing, and
    what the diagnoses do with them, is spread over the next one. A diagnosis whose twin is hosted
    too gets the blocks directly; any other one listens to its topic.
    """

    def __init__(self) -> None:
        super().__init__('fleet', SPECS)
        p = self.parameters
        self._members = [
            self._member(asset) for asset in read_assets(p['assets_file'], p['names'])
        ]

    def _member(self, asset: Asset) -> Member:
        member = Member(asset.name)
        prefix = asset.name.replace('/', '.')
        try:
            if asset.twin is not None:
                member.twin_parameters = ParameterSet(
                    self,
                    TWIN_SPECS,
                    check=_check_twin,
                    apply=partial(self._apply_twin, member),
                    locked=self._is_locked,
                    prefix=f'{prefix}.twin.',
                    given=asset.twin,
                    inherited={name: self.parameters[name] for name in SHARED},
                )
            if asset.diagnosis is not None:
                member.diagnosis_parameters = ParameterSet(
                    self,
                    DIAGNOSIS_SPECS,
                    check=_check_diagnosis,
                    apply=partial(self._apply_diagnosis, member),
                    locked=self._is_locked,
                    prefix=f'{prefix}.diagnosis.',
                    given=asset.diagnosis,
                )
        except BearingTwinError as error:
            msg = f'asset {asset.name}: {error}'
            raise BearingTwinError(msg) from None
        return member

    def check(self, values: Mapping[str, Any]) -> None:
        """Refuse parameters that do not fit together."""
        realtime.check_thresholds(values)

    def setup(self) -> None:
        """Compile and warm the kernel; create what the assets need."""
        p = self.parameters
        self._pending: deque[Pending] = deque()
        self._health = Health(self, self.get_namespace())
        count = len(self._members)
        for index, member in enumerate(self._members):
            part = (index + 1) / count
            self._set_up_twin(member, stagger=part)
            self._set_up_diagnosis(member, stagger=part)
        self._twins = [m for m in self._members if m.simulator is not None]
        self._cycle = BlockCycle(
            self, p, self._compute, slots=p['slots'], between=self._publish_share
        )
        self._health.add('real time', self._cycle.status)
        self._reset = self.create_service(Trigger, '~/reset', self._on_reset)

    def _set_up_twin(self, member: Member, *, stagger: float) -> None:
        p = member.twin_parameters
        if p is None:
            return
        member.simulator = build_simulator(p.values)
        member.simulator.advance(p['block_size'], p['start_temperature'], p['shaft_hz'])
        member.simulator.reset()
        member.twin = TwinAsset(self, p, prefix=f'{member.name}/', stagger=stagger)
        self._health.add(
            f'{member.name} temperature input',
            member.twin.status,
            hardware_id=p['hardware_id'] or member.name,
        )

    def _set_up_diagnosis(self, member: Member, *, stagger: float) -> None:
        p = member.diagnosis_parameters
        if p is None:
            return
        member.diagnosis = DiagnosisAsset(self, p, prefix=f'{member.name}/')
        blocks = p['update_interval'] * self.parameters['sample_rate']
        member.wait = int(stagger * blocks / self.parameters['block_size'])
        hardware_id = p['hardware_id'] or member.name
        for part, status in (
            ('vibration input', member.diagnosis.input_status),
            ('bearing', member.diagnosis.verdict_status),
        ):
            self._health.add(f'{member.name} {part}', status, hardware_id=hardware_id)

    def start(self) -> None:
        """Listen and start the clock of the blocks."""
        for member in self._members:
            if member.twin is not None:
                member.twin.ask_checkpoint()
            if member.diagnosis is not None:
                member.diagnosis.listen(sensors=member.twin is None)
        self._cycle.start()
        diagnoses = sum(m.diagnosis is not None for m in self._members)
        self.get_logger().info(f'{len(self._twins)} twins and {diagnoses} diagnoses')

    def stop(self) -> None:
        """Stop the clock of the blocks and listening."""
        self._cycle.stop()
        self._pending.clear()
        for member in self._members:
            if member.diagnosis is not None:
                member.diagnosis.stop()

    def teardown(self) -> None:
        """Destroy what setup created."""
        self._health.destroy()
        self.destroy_service(self._reset)
        for member in self._members:
            if member.twin is not None:
                member.twin.destroy()
            if member.diagnosis is not None:
                member.diagnosis.destroy()
            member.simulator = member.twin = member.diagnosis = None

    def _apply_twin(self, member: Member, values: Mapping[str, Any]) -> None:
        if member.twin is not None and member.simulator is not None:
            member.twin.apply(values)
            member.simulator.reconfigure(build_parameters(values))

    def _apply_diagnosis(self, member: Member, values: Mapping[str, Any]) -> None:
        if member.diagnosis is not None:
            member.diagnosis.apply(values)

    def _compute(self, due: Due) -> None:
        self._publish_share(1.0)
        size = self.parameters['block_size']
        for member in self._twins:
            assert member.twin is not None and member.simulator is not None
            member.twin.checkpoint(due, member.simulator.save)
            temperature, shaft_hz = member.twin.inputs()
            block = member.simulator.advance(size, temperature.used, shaft_hz)
            self._pending.append(Pending(member, block, due, temperature))

    def _publish_share(self, phase: float) -> None:
        """Publish as many of the blocks as the part of the period that is over asks for."""
        after = max(0.0, 1.0 - phase - 1.0 / self.parameters['slots'])
        remaining = math.floor(len(self._twins) * after + 1e-6)
        while len(self._pending) > remaining:
            item = self._pending.popleft()
            member, twin = item.member, item.member.twin
            assert twin is not None
            message = twin.publish_vibration(item.block, item.due)
            twin.publish_state(
                item.block, item.due, item.temperature, **self._cycle.fields(item.due)
            )
            if member.wait:
                member.wait -= 1
            elif member.diagnosis is not None:
                member.diagnosis.take(message, item.temperature.measured)

    def _on_reset(self, _: Trigger.Request, response: Trigger.Response) -> Trigger.Response:
        for member in self._members:
            if member.simulator is not None and member.twin is not None:
                member.simulator.reset()
                member.twin.ask_checkpoint()
            if member.diagnosis is not None:
                member.diagnosis.reset()
        response.success = True
        response.message = f'{len(self._members)} assets start anew'
        return response


def _check_twin(values: Mapping[str, Any]) -> None:
    build_parameters(values)


def _check_diagnosis(values: Mapping[str, Any]) -> None:
    build_bearing(values)
    build_settings(values)


def main(args: list[str] | None = None) -> int:
    """Run the node."""
    return run(FleetNode, args)


if __name__ == '__main__':
    sys.exit(main())
