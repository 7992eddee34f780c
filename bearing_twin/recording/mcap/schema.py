# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Message schemas of ROS 2 recordings: text with dependencies, and type hash."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache, lru_cache
import os
from pathlib import Path
import sys
from typing import Any, TYPE_CHECKING

from bearing_twin.errors import BearingTwinError
from rosbags.interfaces import Nodetype
from rosbags.typesys import get_types_from_msg, get_typestore, Stores
from rosbags.typesys.store import Typestore

if TYPE_CHECKING:
    from rosbags.interfaces.typing import Typesdict


SEPARATOR = '=' * 80 + '\n'

OWN = 'bearing_twin_msgs/'
"""Package of the messages of the nodes."""

LONGEST_SCHEMA = 250_000
"""Longest schema text that is parsed, characters."""

LONGEST_SEQUENCE = 64 * 1024 * 1024
"""Longest array that is decoded, elements."""


@dataclass(frozen=True)
class MessageSchema:
    """Schema of one message type."""

    type_name: str
    """``pkg/msg/Type``."""
    text: str
    """The ``.msg`` text, followed by the texts of its dependencies (encoding ``ros2msg``)."""
    type_hash: str
    """``RIHS01_...`` of REP 2016."""
    encoding: str = 'ros2msg'
    """Encoding of the text."""


@cache
def message_schema(type_name: str) -> MessageSchema:
    """
    Return the schema of a message type.

    The text comes from the ``.msg`` files of the installed packages, with comments. Without ROS it
    comes from the files of this project and, for common packages of ROS 2, from rosbags.

    Raises
    ------
    BearingTwinError
        If the type is not installed, or its definition is not understood.
    OSError
        If the definition cannot be read now.

    """
    texts: dict[str, str] = {}
    store = Typestore()
    try:
        _collect(type_name, texts, store)
        type_hash = store.hash_rihs01(type_name)
    except (BearingTwinError, OSError):
        raise
    except Exception as error:
        # rosbags raises exceptions of many types, and it does not know all that ROS allows.
        msg = f'the definition of {type_name} cannot be read ({type(error).__name__}: {error})'
        raise BearingTwinError(msg) from None
    own = texts.pop(type_name)
    parts = [own, *(f'MSG: {name.replace("/msg/", "/")}\n{text}' for name, text in texts.items())]
    text = SEPARATOR.join(part if part.endswith('\n') else f'{part}\n' for part in parts)
    return MessageSchema(type_name, text, type_hash)


@lru_cache(maxsize=256)
def store_from_text(type_name: str, text: str) -> Typestore:
    """Return a type store that decodes ``type_name`` by the embedded schema ``text``."""
    if len(text) > LONGEST_SCHEMA:
        msg = f'the schema of {type_name} has {len(text)} characters; at most {LONGEST_SCHEMA}'
        raise BearingTwinError(msg)
    store = Typestore(max_sequence_length=LONGEST_SEQUENCE)
    try:
        store.register(get_types_from_msg(text, type_name))
        store.get_msgdef(type_name)
    except Exception as error:
        # rosbags raises exceptions of many types if the text is damaged.
        msg = f'the schema of {type_name} cannot be read ({type(error).__name__}: {error})'
        raise BearingTwinError(msg) from None
    return store


@lru_cache(maxsize=256)
def type_conflict(type_name: str, text: str) -> str:
    """
    Return why messages of an embedded schema cannot be read as the known type; '' if they can.

    A type of this package has to have the same fields. Of any other the kinds of its fields have
    to be the same (number, text, list or message), on which readers rely; fields may be missing.
    """
    try:
        known = store_from_text(type_name, message_schema(type_name).text).fielddefs
    except BearingTwinError:
        return ''
    found = store_from_text(type_name, text).fielddefs
    if type_name.startswith(OWN):
        ours, theirs = (dict(fields[type_name][1]) for fields in (known, found))
        if unlike := [name for name in ours | theirs if ours.get(name) != theirs.get(name)]:
            return f'unlike in {", ".join(unlike)}'
    for name in known.keys() & found.keys():
        kinds = {field: _kind(about) for field, about in known[name][1]}
        for field, about in found[name][1]:
            if kinds.get(field, _kind(about)) != _kind(about):
                return f'{field} of {name} is {_kind(about)} instead of {kinds[field]}'
    return ''


def _kind(about: Any) -> str:
    node, inside = about
    if node == Nodetype.NAME:
        return str(inside)
    if node == Nodetype.BASE:
        return 'a text' if inside[0] in ('string', 'wstring') else 'a number'
    return f'a list of {_kind(inside[0])}'


def canonical_cdr(type_name: str, text: str, cdr: bytes) -> bytes:
    """
    Return a serialised message with the padding between its fields set to zero.

    CDR aligns numbers to their size. Fast CDR does not initialise the bytes in between, so equal
    messages may differ there. These bytes have no meaning.
    """
    store = store_from_text(type_name, text)
    try:
        return bytes(store.serialize_cdr(store.deserialize_cdr(cdr, type_name), type_name))
    except Exception as error:
        # rosbags raises exceptions of many types if the bytes are damaged.
        msg = f'a {type_name} is damaged ({type(error).__name__}: {error})'
        raise BearingTwinError(msg) from None


def _collect(type_name: str, texts: dict[str, str], store: Typestore) -> None:
    """Add the texts of a type and its dependencies, each once, in order of first use."""
    if type_name in texts:
        return
    text = _own_text(type_name)
    types: Typesdict = get_types_from_msg(text, type_name)
    texts[type_name] = text
    for _, description in types[type_name][1]:
        dependency: object = description[1]
        if description[0] in (Nodetype.ARRAY, Nodetype.SEQUENCE):
            element = description[1][0]
            dependency = element[1] if element[0] == Nodetype.NAME else None
        elif description[0] != Nodetype.NAME:
            dependency = None
        if isinstance(dependency, str):
            _collect(dependency, texts, store)
    store.register(types)


def _own_text(type_name: str) -> str:
    package, kind, name = _parts(type_name)
    for folder in shared_folders(package):
        path = folder / kind / f'{name}.msg'
        if path.is_file():
            return path.read_text(encoding='utf-8')
    if type_name.startswith(OWN):
        path = Path(__file__).parents[3] / 'msg_defs' / kind / f'{name}.msg'
        if path.is_file():
            return path.read_text(encoding='utf-8')
    store = standard_types()
    if type_name not in store.fielddefs:
        raise BearingTwinError(
            f'the definition of {type_name} is not installed: no share/{package}/{kind}/{name}.msg'
            ' under AMENT_PREFIX_PATH; source the workspace that has it'
        )
    text, _ = store.generate_msgdef(type_name, ros_version=2)
    return text.split(SEPARATOR)[0]


def _parts(type_name: str) -> tuple[str, str, str]:
    parts = type_name.split('/')
    if len(parts) != 3 or not all(part.isidentifier() for part in parts):
        raise BearingTwinError(f'{type_name!r} is no message type; it reads pkg/msg/Type')
    return parts[0], parts[1], parts[2]


def shared_folders(package: str) -> list[Path]:
    """Return the possible share folders of a package, those of the ament index first."""
    # A colcon workspace is not in the Python prefix; only the ament index names it.
    listed = os.environ.get('AMENT_PREFIX_PATH', '').split(os.pathsep)
    return [Path(prefix) / 'share' / package for prefix in (*listed, sys.prefix) if prefix]


@cache
def standard_types() -> Typestore:
    """Return the message types of ROS itself."""
    return get_typestore(Stores.ROS2_KILTED)
