# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Read the file that lists the assets of a fleet, and build the fleet of their twins."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
import re
from typing import Any

from bearing_twin.assets.checkpoints import parameters_of
from bearing_twin.assets.parameters import diagnosis as diagnosis_parameters
from bearing_twin.assets.parameters import twin as twin_parameters
from bearing_twin.dynamics.fleet.fleet import Fleet
from bearing_twin.errors import BearingTwinError, FileError
from bearing_twin.recording.mcap.mcapfile import refuse_special
from bearing_twin.wholefile import given_path
import yaml

SHARED = ('sample_rate', 'block_size', 'checkpoint_period')
"""Parameters that are common to all twins of a fleet: their blocks are computed together."""

TWIN_SPECS = tuple(spec for spec in twin_parameters.SPECS if spec.name not in SHARED)
DIAGNOSIS_SPECS = diagnosis_parameters.SPECS

NAME = re.compile(r'[A-Za-z]\w*(/[A-Za-z]\w*)*', re.ASCII)
PARTS = ('twin', 'diagnosis')


@dataclass(frozen=True)
class Asset:
    """One bearing of a fleet."""

    name: str
    """Namespace of its topics, relative to the namespace of the node."""
    twin: dict[str, Any] | None = field(default_factory=dict)
    """Parameters of its twin that differ from the defaults; None: no twin is hosted."""
    diagnosis: dict[str, Any] | None = field(default_factory=dict)


def read_assets(path: str, names: list[str]) -> list[Asset]:
    """
    Return the assets of a file, or of a list of names if ``path`` is ''.

    In the file, each asset has a twin, a diagnosis, or both::

        assets:
          line3/pump_7:
            twin: {bearing: '6307', defect: inner}
            diagnosis: {bearing: '6307'}

    Raises
    ------
    FileError
        If the file cannot be read.
    BearingTwinError
        If there are no assets, a name is used twice or is not a ROS namespace, or two diagnoses
        share a saved state.

    """
    if not path:
        assets = [Asset(name) for name in names if name]
    else:
        assets = [_asset(path, name, parts) for name, parts in _table(path).items()]
    if not assets:
        msg = 'no assets: give a file (assets_file:=FILE) or names (names:="[bearing_1]")'
        raise BearingTwinError(msg)
    states: dict[tuple[Any, Any], str] = {}
    for name, count in Counter(asset.name for asset in assets).items():
        if count > 1:
            raise BearingTwinError(f"two assets have the name '{name}'; give each its own")
    for asset in assets:
        if not NAME.fullmatch(asset.name):
            msg = f"asset '{asset.name}' is no ROS namespace: letters, digits, _, parts split by /"
            raise BearingTwinError(msg)
        kept = asset.diagnosis or {}
        state = kept.get('state_directory') or '', kept.get('state_name')
        if state[1] and (other := states.setdefault(state, asset.name)) != asset.name:
            msg = f'{other} and {asset.name} have one state_name; give each its own'
            raise BearingTwinError(msg)
    return assets


class _EachOnce(yaml.SafeLoader):
    """YAML loader that refuses duplicate keys; PyYAML itself silently keeps the last one."""

    def construct_mapping(self, node: yaml.MappingNode, deep: bool = False) -> dict[Any, Any]:
        lines: dict[str, int] = {}
        for key, _ in node.value:
            name, line = str(key.value), key.start_mark.line + 1
            if name in lines:
                raise yaml.YAMLError(f'duplicate key {name} (lines {lines[name]} and {line})')
            lines[name] = line
        return super().construct_mapping(node, deep)


def _table(path: str) -> dict[Any, Any]:
    try:
        file = given_path(path)
        refuse_special(file)
        content = yaml.load(file.read_text(encoding='utf-8'), _EachOnce)
    except OSError as error:
        raise FileError(f'{path} cannot be read: {error.strerror}') from None
    except (yaml.YAMLError, ValueError, RecursionError) as error:
        # Other bytes than UTF-8 and a date that does not exist are a ValueError.
        raise BearingTwinError(f'{path} is no YAML: {error}') from None
    table = content.get('assets') if isinstance(content, dict) else None
    if not isinstance(table, dict):
        msg = f"{path} has no table 'assets' of names and their twin and diagnosis"
        raise BearingTwinError(msg)
    return table


def _asset(path: str, name: Any, parts: Any) -> Asset:
    if isinstance(name, bool):
        msg = f'{path}: YAML takes the name of an asset for {str(name).lower()}: quote it'
        raise BearingTwinError(msg)
    parts = {part: {} for part in PARTS} if parts is None else parts
    known = isinstance(parts, dict) and parts
    unknown = sorted({str(part) for part in parts} - set(PARTS)) if known else ['no table']
    if unknown:
        msg = f"{path}: asset '{name}' may have twin and diagnosis, not {', '.join(unknown)}"
        raise BearingTwinError(msg)
    chosen: dict[str, dict[str, Any] | None] = dict.fromkeys(PARTS)
    for part, values in parts.items():
        if not isinstance(values or {}, dict):
            raise BearingTwinError(f"{path}: asset '{name}': {part} must be a table of parameters")
        try:
            chosen[part] = _flat(values or {})
        except RecursionError:
            msg = f"{path}: asset '{name}': a table in {part} holds itself; write its values"
            raise BearingTwinError(msg) from None
    if common := ' and '.join(sorted((chosen['twin'] or {}).keys() & set(SHARED))):
        msg = f"{path}: asset '{name}': {common} is one for all twins: give it to the fleet, as -p"
        raise BearingTwinError(msg)
    return Asset(str(name), chosen['twin'], chosen['diagnosis'])


def _flat(values: dict[Any, Any]) -> dict[str, Any]:
    """Return parameters of nested tables by dotted names, as in ROS parameter files."""
    flat: dict[str, Any] = {}
    for name, value in values.items():
        if isinstance(value, dict):
            flat.update({f'{name}.{inner}': v for inner, v in _flat(value).items()})
        else:
            flat[str(name)] = value
    return flat


def build_fleet(values: Iterable[Mapping[str, Any]], *, threads: int = 1) -> Fleet:
    """
    Return a fleet of twins in their initial state.

    Common parameters are taken from the first twin. ``threads`` is the number of cores that
    compute the equations.
    """
    values = list(values)
    with parameters_of('fleet'):
        return Fleet(
            [twin_parameters.build_parameters(v) for v in values],
            sample_rate=values[0]['sample_rate'],
            seeds=[v['seed'] for v in values],
            temperatures=[v['start_temperature'] for v in values],
            shaft_hz=[v['shaft_hz'] for v in values],
            threads=threads,
        )
