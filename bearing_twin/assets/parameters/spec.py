# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Declare parameters of nodes and offline runs, and read and check given values."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
import contextlib
from dataclasses import dataclass, replace
import difflib
import functools
from typing import Any

from bearing_twin.errors import BearingTwinError
from bearing_twin.quantity import quantities, Quantity

Value = bool | int | float | str | list[str]


@dataclass(frozen=True, kw_only=True)
class Spec(Quantity):
    """One parameter of a node."""

    name: str
    default: Value
    read_only: bool = False
    """Whether it can be set at start only."""
    implied: bool = False
    """Whether a configuration without this parameter means its default."""
    optional: bool = False
    """Whether with the default the preset or the geometry sets the field."""

    def read(self, value: Any) -> Value:
        """
        Return a given value in the type of the parameter.

        An integer is accepted for a float and for a text, because the bearing 6307 is a name.
        A text is accepted for a float: ROS reads ``68e-6`` as a number, YAML 1.1 as a text without
        a decimal point. True is accepted for an axis ``y``: ``ros2 param dump`` writes it without
        quotes, and ROS then reads it as true.
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
            # YAML reads yes, no, on and off as these.
            text = 'no' if value is False else 'on' if value is True else value
            hints = {
                # The shell removes one pair of quotes, YAML the other.
                str: f'quote a text twice: {self.name}:="\'{text}\'"',
                float: 'write a decimal point and no unit',
                int: 'write digits alone',
                bool: 'write true or false',
                list: 'write ["a", "b"]',
            }
            msg = f'{self.name}={value!r} must be of type {wanted}; {hints[kind]}'
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
    """Return a parameter; ``more`` holds further fields of :class:`Spec`."""
    return Spec(
        name=name, default=default, description=description, unit=unit, low=low, high=high, **more
    )


fixed = functools.partial(parameter, running=False)
"""A parameter that can be changed in state 'unconfigured' only."""


def read_values(specs: Iterable[Spec], given: Mapping[str, Any]) -> dict[str, Any]:
    """Return the values of all parameters: those given, and the defaults of the others."""
    table = {spec.name: spec for spec in specs}
    unknown = [no_parameter(name, table) for name in given if name not in table]
    if unknown:
        raise BearingTwinError('; '.join(unknown))
    return {n: s.read(given[n]) if n in given else s.default for n, s in table.items()}


def no_parameter(name: str, names: Iterable[str]) -> str:
    """Return the error text for an unknown parameter name, with similar names."""
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
        A dataclass and the name of its field, which is declared as a quantity.
    name
        Name of the parameter, if it differs from the field.
    absent
        Default that means "not set", and a text on what sets the field then.
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
    """Return the dataclass fields that are set by parameters of :func:`field_spec`."""
    return {
        spec.name.rpartition('.')[2]: values[spec.name]
        for spec in specs
        if not spec.optional or values[spec.name] != spec.default
    }


def configuration(specs: Iterable[Spec], values: Mapping[str, Any]) -> dict[str, Any]:
    """
    Return the parameters for a checkpoint: all except implied ones that have their default.

    This keeps the checkpoint of a fleet small: it has one configuration per asset, and is written
    between two deadlines.
    """
    left_out = {spec.name: spec.default for spec in specs if spec.implied}
    return {n: v for n, v in values.items() if n not in left_out or v != left_out[n]}


def completed(specs: Iterable[Spec], values: Mapping[str, Any]) -> dict[str, Any]:
    """Return the parameters of a checkpoint with those that :func:`configuration` leaves out."""
    return {**{spec.name: spec.default for spec in specs if spec.implied}, **values}
