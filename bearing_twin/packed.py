# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""A checksummed container for saved state: named arrays and plain values, no pickle."""

from __future__ import annotations

from dataclasses import fields, is_dataclass
import json
import struct
from typing import Any, get_args, get_origin, get_type_hints
import zlib

from bearing_twin.errors import BearingTwinError
import numpy as np

_MAGIC = b'BTDX'
_HEADER = struct.Struct('<4sHIIQ')
_OTHER_VERSION = 'saved state is of another version of this program'
_REMEDY = 'start afresh, or use the program that saved it'
_DTYPES = ('float32', 'float64', 'int64', 'uint8')


def pack(version: int, values: dict[str, Any], arrays: dict[str, np.ndarray[Any, Any]]) -> bytes:
    """
    Return JSON-able ``values`` and numeric ``arrays`` as bytes; :func:`unpack` reads them.

    >>> values, arrays = unpack(pack(2, {'count': 3}, {'x': np.zeros(2)}), 2)
    >>> values, arrays['x'].tolist()
    ({'count': 3}, [0.0, 0.0])

    """
    layout = [(name, str(array.dtype), list(array.shape)) for name, array in arrays.items()]
    text = json.dumps({'values': values, 'arrays': layout}, sort_keys=True).encode()
    body = text + b''.join(np.ascontiguousarray(array).tobytes() for array in arrays.values())
    return _HEADER.pack(_MAGIC, version, zlib.crc32(body), len(text), len(body)) + body


def unpack(data: bytes, version: int) -> tuple[dict[str, Any], dict[str, np.ndarray[Any, Any]]]:
    """
    Return the values and arrays that :func:`pack` wrote.

    >>> unpack(pack(2, {'count': 3}, {}), 2)
    ({'count': 3}, {})

    """
    if len(data) < _HEADER.size or data[:4] != _MAGIC:
        msg = f'{len(data)} bytes are not a saved diagnosis state; give what save() returned'
        raise BearingTwinError(msg)
    _, found, checksum, text_length, length = _HEADER.unpack_from(data)
    body = data[_HEADER.size :]
    if found != version:
        msg = f'{_OTHER_VERSION}: it is {found}, and this one reads {version}; {_REMEDY}'
        raise BearingTwinError(msg)
    if len(body) != length or text_length > length or zlib.crc32(body) != checksum:
        msg = f'saved state is damaged: {len(body)} of {length} bytes; use an intact copy'
        raise BearingTwinError(msg)
    try:
        content = json.loads(body[:text_length])
        arrays = {}
        position = text_length
        for name, dtype, shape in content['arrays']:
            if dtype not in _DTYPES or any(side < 0 for side in shape):
                raise ValueError(f'array {name} of {dtype} {shape}')
            count = int(np.prod(shape, dtype=object)) if shape else 1
            array = np.frombuffer(body, dtype=dtype, count=count, offset=position)
            arrays[name] = array.reshape(shape).copy()
            position += array.nbytes
        return content['values'], arrays
    except (ValueError, KeyError, TypeError, OverflowError, RecursionError) as error:
        msg = f'saved state cannot be read ({error}); use what save() returned'
        raise BearingTwinError(msg) from error


def restored(kind: Any, value: Any) -> Any:
    """
    Return a value of type ``kind`` from the plain values that `dataclasses.asdict` made.

    Parameters
    ----------
    kind
        A dataclass, bool, int, float or str; or a list, dict or optional of these. A dataclass
        checks ranges itself, in its ``__post_init__``.
    value
        The saved value.

    >>> restored(dict[str, list[float]], {'x': [1]})
    {'x': [1.0]}

    """
    inner = get_args(kind)
    if isinstance(kind, type) and is_dataclass(kind) and isinstance(value, dict):
        hints, names = get_type_hints(kind), {field.name for field in fields(kind)}
        if value.keys() == names:
            return kind(**{name: restored(hints[name], each) for name, each in value.items()})
        here, there = (
            ', '.join(sorted(some)) for some in (names - value.keys(), value.keys() - names)
        )
        differs = [
            f'{what} {some:.60}' for what, some in (('lacks', here), ('has', there)) if some
        ]
        msg = f'{_OTHER_VERSION}, whose {kind.__name__} {" and ".join(differs)}; {_REMEDY}'
        raise BearingTwinError(msg)
    if type(None) in inner:
        return None if value is None else restored(inner[0], value)
    if get_origin(kind) is list and isinstance(value, list):
        return [restored(inner[0], each) for each in value]
    if get_origin(kind) is dict and isinstance(value, dict):
        return {restored(inner[0], k): restored(inner[1], each) for k, each in value.items()}
    if kind is float and isinstance(value, int):
        return float(value)
    if kind in (bool, int, float, str) and isinstance(value, kind):
        return value
    raise BearingTwinError(f'saved {value!r:.60} is no {kind}; use what save() returned')
