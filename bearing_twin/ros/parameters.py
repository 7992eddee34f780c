# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""
Declare, check and apply the parameters of a node from its table.

``docs/nodes.md`` is generated from the same tables.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from typing import Any, TYPE_CHECKING

from bearing_twin.assets.parameters.spec import configuration, no_parameter, read_values
from bearing_twin.errors import BearingTwinError
from rcl_interfaces.msg import (
    FloatingPointRange,
    IntegerRange,
    ParameterDescriptor,
    ParameterType,
    SetParametersResult,
)
from rcl_interfaces.srv import SetParametersAtomically
from rclpy.parameter import Parameter, parameter_value_to_python
import yaml

if TYPE_CHECKING:
    from bearing_twin.assets.parameters.spec import Spec
    from rclpy.node import Node


TYPES = {kind.value for kind in Parameter.Type}
"""Numbers of the valid parameter types."""


def unknown_at_start(node: Node) -> list[str]:
    """Return a sentence on each parameter given at start that the node does not have."""
    names = node.list_parameters([], 0).names
    return [no_parameter(name, names) for name in node._parameter_overrides if name not in names]


def read_as_at_start(node: Node, callback: Callable[[Any, Any], Any]) -> Callable[[Any, Any], Any]:
    """
    Return a callback of the services that set parameters, which reads values as at start.

    ``ros2 param set NODE bearing 6205`` sends a whole number for a text. rclpy refuses it, and
    says no more than the numbers of both types.
    """

    def answer(request: Any, response: Any) -> Any:
        problems = [_ParameterCallbacks.of(node).read(each) for each in request.parameters]
        response = callback(request, response)
        if isinstance(response, SetParametersAtomically.Response):
            results, problems = [response.result], ['; '.join(filter(None, problems))]
        else:
            results = response.results
        for result, problem in zip(results, problems, strict=True):
            if problem:
                result.reason = problem
        return response

    return answer


def descriptor(spec: Spec) -> ParameterDescriptor:
    """Return the description that ``ros2 param describe`` shows."""
    text = spec.description
    if spec.unit:
        text += f' [{spec.unit}]'
    if spec.choices:
        text += f' One of: {", ".join(spec.choices)}.'
    if not spec.running and not spec.read_only:
        text += ' Can be changed only while the node is not configured.'
    descriptor = ParameterDescriptor(description=text, read_only=spec.read_only)
    if spec.low is None or spec.high is None:
        return descriptor
    low, high = spec.low, spec.high
    if spec.special is not None:
        low = min(low, spec.special[0])
        descriptor.additional_constraints = (
            f'{spec.low:g}..{spec.high:g} {spec.unit} ({spec.special_text})'
        )
    if isinstance(spec.default, float):
        descriptor.floating_point_range = [
            FloatingPointRange(from_value=float(low), to_value=float(high))
        ]
    else:
        descriptor.integer_range = [IntegerRange(from_value=int(low), to_value=int(high), step=1)]
    return descriptor


class ParameterSet:
    """
    Declare the parameters of a node; check each change as a whole, then apply it.

    Parameters
    ----------
    node
        The node.
    specs
        Table of the parameters.
    check
        Called with all values including a change; raises BearingTwinError to refuse the change.
    apply
        Called with all values after an accepted change.
    locked
        Returns whether parameters with ``running=False`` are locked now.
    prefix
        Prefix of the names: '', or ``ASSET.`` if a node hosts several assets.
    given
        Defaults that replace those of the table, such as those in a file of assets.
    inherited
        Values that are not parameters here but are included in :attr:`values`.

    """

    def __init__(
        self,
        node: Node,
        specs: Iterable[Spec],
        *,
        check: Callable[[Mapping[str, Any]], None],
        apply: Callable[[Mapping[str, Any]], None],
        locked: Callable[[], bool],
        prefix: str = '',
        given: Mapping[str, Any] | None = None,
        inherited: Mapping[str, Any] | None = None,
    ) -> None:
        self._node = node
        self._specs = {spec.name: spec for spec in specs}
        self._check = check
        self._apply = apply
        self.locked = locked
        self._prefix = prefix
        self._text = ''
        # Values given at start, by a launch file or after --ros-args.
        at_start = {n: p.value for n, p in node._parameter_overrides.items()}
        ours = {n.removeprefix(prefix): v for n, v in at_start.items() if n.startswith(prefix)}
        if not prefix:
            # Others may be for another node; `unknown_at_start` reports them.
            ours = {n: v for n, v in ours.items() if n in self._specs}
        values = read_values(self._specs.values(), {**(given or {}), **ours})
        for name, value in values.items():
            node.declare_parameter(
                prefix + name, value, descriptor(self._specs[name]), ignore_override=True
            )
        self._values = {**(inherited or {}), **values}
        self._check(self._values)
        _ParameterCallbacks.of(node).take(self)

    def __getitem__(self, name: str) -> Any:
        """Return the value in force."""
        return self._values[name]

    @property
    def values(self) -> dict[str, Any]:
        """All values in force."""
        return dict(self._values)

    @property
    def text(self) -> str:
        """Return the configuration for a checkpoint, as YAML."""
        if not self._text:
            self._text = yaml.safe_dump(configuration(self._specs.values(), self._values))
        return self._text

    @property
    def specs(self) -> tuple[Spec, ...]:
        """Return the table of the parameters."""
        return tuple(self._specs.values())

    @property
    def names(self) -> list[str]:
        """Names of the parameters on the node, with prefix."""
        return [self._prefix + name for name in self._specs]

    def _ours(self, parameters: list[Parameter[Any]]) -> dict[str, Any]:
        return {p.name.removeprefix(self._prefix): p.value for p in parameters}

    def read(self, name: str, value: Any) -> Any:
        """Return a value that a parameter of this set is to have, in the type of the parameter."""
        return self._specs[name.removeprefix(self._prefix)].read(value)

    def on_set(self, parameters: list[Parameter[Any]]) -> SetParametersResult:
        """Check a change of parameters of this set."""
        ours = self._ours(parameters)
        fixed = [
            name
            for name, value in ours.items()
            if not self._specs[name].running and value != self._values[name]
        ]
        if fixed and self.locked():
            reason = (
                f'{", ".join(fixed)} cannot change while the node runs: deactivate and clean it '
                "up first ('ros2 lifecycle set NODE deactivate', then 'cleanup')"
            )
            return SetParametersResult(successful=False, reason=reason)
        try:
            for name, value in ours.items():
                self._specs[name].check(name, value)
            self._check({**self._values, **ours})
        except BearingTwinError as error:
            return SetParametersResult(successful=False, reason=str(error))
        return SetParametersResult(successful=True)

    def after_set(self, parameters: list[Parameter[Any]]) -> None:
        """Apply an accepted change of parameters of this set."""
        ours = self._ours(parameters)
        self._text = ''
        self._values.update(ours)
        self._apply(self._values)


class _ParameterCallbacks:
    """
    Parameter callbacks of a node; they call the one set that owns a name.

    A fleet of 300 assets declares 600 sets. Calling each set for each name would make its start
    take half a minute.
    """

    def __init__(self, node: Node) -> None:
        self._node = node
        self._owners: dict[str, ParameterSet] = {}
        node.add_on_set_parameters_callback(self._on_set)
        node.add_post_set_parameters_callback(self._after_set)

    @classmethod
    def of(cls, node: Node) -> _ParameterCallbacks:
        """Return the callbacks of a node; create them at the first call."""
        asked: _ParameterCallbacks | None = vars(node).get('_asked')
        if asked is None:
            asked = vars(node)['_asked'] = cls(node)
        return asked

    def take(self, of: ParameterSet) -> None:
        """Register a set as owner of its names."""
        self._owners.update(dict.fromkeys(of.names, of))

    def read(self, asked: Any) -> str:
        """
        Bring a ``rcl_interfaces/Parameter`` into the declared type; return why it is refused.

        It is '' if the value is not refused, or if rclpy or the whole change decides.
        """
        name, value = asked.name, asked.value
        if value.type not in TYPES:
            # It would end the node. rclpy refuses what is not set.
            value.type = ParameterType.PARAMETER_NOT_SET
        if not self._node.has_parameter(name):
            node = self._node.get_fully_qualified_name()
            return f"there is no parameter {name!r}; 'ros2 param list {node}' shows all"
        if name not in self._owners or value.type == ParameterType.PARAMETER_NOT_SET:
            return ''
        try:
            read = self._owners[name].read(name, parameter_value_to_python(value))
        except BearingTwinError as error:
            return str(error)
        kind = self._node.get_parameter(name).type_
        asked.value = Parameter(name, kind, read).get_parameter_value()
        return ''

    def _parted(self, parameters: list[Parameter[Any]]) -> dict[ParameterSet, list[Any]]:
        parted: dict[ParameterSet, list[Any]] = {}
        for parameter in parameters:
            if parameter.name in self._owners:
                parted.setdefault(self._owners[parameter.name], []).append(parameter)
        return parted

    def _on_set(self, parameters: list[Parameter[Any]]) -> SetParametersResult:
        wanted = [p.value for p in parameters if p.name == 'use_sim_time']
        locked = bool(wanted) and any(of.locked() for of in self._owners.values())
        if locked and wanted != [self._node.get_parameter('use_sim_time').value]:
            reason = (
                'use_sim_time cannot change while the node runs: its stamps would jump; start the '
                "node anew with '-p use_sim_time:=true'"
            )
            return SetParametersResult(successful=False, reason=reason)
        for of, ours in self._parted(parameters).items():
            result = of.on_set(ours)
            if not result.successful:
                return result
        return SetParametersResult(successful=True)

    def _after_set(self, parameters: list[Parameter[Any]]) -> None:
        for of, ours in self._parted(parameters).items():
            of.after_set(ours)
