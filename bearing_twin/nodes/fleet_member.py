# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""One asset of a fleet node: its parameters, twin and diagnosis."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import partial
from typing import Any, TYPE_CHECKING

from bearing_twin.assets.fleet import DIAGNOSIS_SPECS, SHARED, TWIN_SPECS
from bearing_twin.assets.parameters.diagnosis import check_diagnosis
from bearing_twin.assets.parameters.twin import build_parameters
from bearing_twin.dynamics.equations.stability import steps
from bearing_twin.errors import BearingTwinError
from bearing_twin.ros.parameters import ParameterSet

if TYPE_CHECKING:
    from bearing_twin.assets.fleet import Asset
    from bearing_twin.assets.twin import TwinChannel
    from bearing_twin.nodes.diagnosis_topics import DiagnosisTopics
    from bearing_twin.nodes.twin_topics import TwinTopics
    from bearing_twin.ros.lifecycle import ManagedNode


class Member:
    """
    Parameters of one asset, and its twin and diagnosis while the node is configured.

    Raises
    ------
    BearingTwinError
        If a parameter is refused; the text names the asset.

    """

    def __init__(
        self,
        node: ManagedNode,
        asset: Asset,
        apply_twin: Callable[[Member, Mapping[str, Any]], None],
        apply_diagnosis: Callable[[Member, Mapping[str, Any]], None],
    ) -> None:
        self.name = asset.name
        self.twin_parameters: ParameterSet | None = None
        self.diagnosis_parameters: ParameterSet | None = None
        self.channel: TwinChannel | None = None
        """Inputs of its twin."""
        self.twin: TwinTopics | None = None
        self.diagnosis: DiagnosisTopics | None = None
        self.wait = 0
        """Blocks to skip before the diagnosis begins, so that verdicts do not coincide."""
        self.prefix = prefix = asset.name.replace('/', '.')
        """Prefix of its parameter names."""
        try:
            if asset.twin is not None:
                self.twin_parameters = ParameterSet(
                    node,
                    TWIN_SPECS,
                    check=_check_twin,
                    apply=partial(apply_twin, self),
                    locked=lambda: node.configured,
                    prefix=f'{prefix}.twin.',
                    given=asset.twin,
                    inherited={name: node.parameters[name] for name in SHARED},
                )
            if asset.diagnosis is not None:
                self.diagnosis_parameters = ParameterSet(
                    node,
                    DIAGNOSIS_SPECS,
                    check=check_diagnosis,
                    apply=partial(apply_diagnosis, self),
                    locked=lambda: node.configured,
                    prefix=f'{prefix}.diagnosis.',
                    given=asset.diagnosis,
                )
        except BearingTwinError as error:
            raise BearingTwinError(f'asset {asset.name}: {error}') from None

    def release(self) -> None:
        """Release twin and diagnosis."""
        self.channel = self.twin = self.diagnosis = None


def _check_twin(values: Mapping[str, Any]) -> None:
    steps(build_parameters(values), values['sample_rate'])
