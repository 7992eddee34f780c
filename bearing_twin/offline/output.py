# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Serialise messages to the bytes that a node publishes."""

from __future__ import annotations

import array
from typing import Any, NamedTuple

from bearing_twin.recording.mcap.schema import message_schema, store_from_text
import numpy as np


class Output(NamedTuple):
    """One serialised message to publish or record."""

    topic: str
    type_name: str
    cdr: bytes


def output(topic: str, message: Any) -> Output:
    """Return a message as the bytes that :func:`canonical_cdr` makes from those of rclpy."""
    kind = type(message)
    type_name = f'{kind.__module__.split(".")[0]}/msg/{kind.__name__}'
    store = store_from_text(type_name, message_schema(type_name).text)
    # Read each field once into the plain object that rosbags serialises: rosbags reads some fields
    # twice, and those of rclpy are slow properties. It needs number sequences as NumPy arrays.
    values = [getattr(message, name) for name, _ in store.fielddefs[type_name][1]]
    plain = store.types[type_name](
        *[np.asarray(value) if isinstance(value, array.array) else value for value in values]
    )
    return Output(topic, type_name, bytes(store.serialize_cdr(plain, type_name)))


def decode(made: Output) -> Any:
    """Return an object with the fields of an output message."""
    store = store_from_text(made.type_name, message_schema(made.type_name).text)
    return store.deserialize_cdr(made.cdr, made.type_name)
