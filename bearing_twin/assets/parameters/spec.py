# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""One parameter of a node or an offline run; how given values are read, and what they set."""

from __future__ import annotations

import contextlib
from dataclasses import dataclass, replace
import difflib
import functools
from typing import Any, TYPE_CHECKING

from bearing_twin.errors import BearingTwinError
from bearing_twin.quantity import quantities, Quantity

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping


Value = bool | int | float | str | list[str]


@dataclass(frozen=True, kw_only=True)
class Spec(Quantity):
    """One parameter of a node."""

    name: str
    default: Value
    read_only: bool = False
    """Whether it can be set at start only."""
    implied: bool = False
    """Whether a configuration that does not name it means the default."""
    optional: bool = False
    """Whether the default leaves the field to the preset or the geometry."""

    def read(self, value: Any) -> Value:
        """
        Return a given value in the type of the parameter.

        A whole number is taken for a float and, since a bearing called 6307 is a name, for a text.
        ``68e-6`` is a number to ROS but, without a point, a text to YAML 1.1. An axis ``y`` that
        ``ros2 param dump`` has written without quotes is read by ROS as true.
        """
        kind = type(self.default)
        if kind is str and type(value) is int:
            value = str(value)
        elif value is True and 'y' in self.choices:
            value = 'y'
        elif kind is float and type(value) in (int, str):
            with contextlib.suppress(ValueError, OverflowError):
                value = float(value)
        texts = not isinstance(value, list) or all(isinstance(item, str) for item in value)
        if type(value) is not kind or not texts:
            wanted = 'list of str' if kind is list else kind.__name__
            # The shell takes one pair of quotes away, YAML the other.
            hint = f'; quote a text twice: {self.name}:="\'{value}\'"' if kind is str else ''
            msg = f'{self.name}={value!r} must be of type {wanted}{hint}'
            raise BearingTwinError(msg)
        self.check(self.name, value)
        return value


def parameter(
    name: str,
    default: Value,
    description: str,
    unit: str = '',
    low: float | None = None,
    high: float | None = None,
    **more: Any,
) -> Spec:
    """Return a parameter; ``more`` are further fields of :class:`Spec`."""
    return Spec(
        name=name, default=default, description=description, unit=unit, low=low, high=high, **more
    )


fixed = functools.partial(parameter, running=False)
"""A parameter that can be changed in state 'unconfigured' only."""


def read_values(specs: Iterable[Spec], given: Mapping[str, Any]) -> dict[str, Any]:
    """
    Return the values of all parameters: those given, and the defaults of the others.

    Raises
    ------
    BearingTwinError
        If there is no parameter of a name, or a value is of another type or outside its limits.

    """
    table = {spec.name: spec for spec in specs}
    unknown = [no_parameter(name, table) for name in given if name not in table]
    if unknown:
        raise BearingTwinError('; '.join(unknown))
    return {n: s.read(given[n]) if n in given else s.default for n, s in table.items()}


def no_parameter(name: str, names: Iterable[str]) -> str:
    """Return a sentence on a name that no parameter has, with the nearest ones."""
    nearest = difflib.get_close_matches(name, list(names), n=3, cutoff=0.0)
    return f'there is no parameter {name!r}; the nearest are {", ".join(nearest)}'


def field_spec(
    owner: type,
    field: str,
    *,
    name: str = '',
    absent: tuple[Value, str] | None = None,
    implied: bool = False,
) -> Spec:
    """
    Return the parameter that sets a field of a dataclass.

    Parameters
    ----------
    owner, field
        A dataclass, and its field that is declared as a quantity.
    name
        Of the parameter, if it is not that of the field.
    absent
        Default that stands for no value, and who sets the field then.
    implied
        As in :class:`Spec`.

    """
    default, about = quantities(owner)[field]
    spec = Spec(
        **{**vars(about), 'special': absent or about.special},
        name=name or field,
        default=absent[0] if absent else default,
        implied=implied,
        optional=absent is not None,
    )
    if absent and spec.choices:
        spec = replace(spec, choices=('', *spec.choices))
    if spec.special:
        text = spec.description.removesuffix('.')
        spec = replace(spec, description=f'{text}; {spec.special_text}.')
    return spec


def field_values(specs: Iterable[Spec], values: Mapping[str, Any]) -> dict[str, Any]:
    """Return the fields that parameters of :func:`field_spec` set."""
    return {
        spec.name.rpartition('.')[2]: values[spec.name]
        for spec in specs
        if not spec.optional or values[spec.name] != spec.default
    }


def configuration(specs: Iterable[Spec], values: Mapping[str, Any]) -> dict[str, Any]:
    """
    Return what a checkpoint says of ``values``: all but the implied ones that have their default.

    A fleet's checkpoint holds one configuration an asset, and is written between two deadlines.
    """
    left_out = {spec.name: spec.default for spec in specs if spec.implied}
    return {n: v for n, v in values.items() if n not in left_out or v != left_out[n]}
