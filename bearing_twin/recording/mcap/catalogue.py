# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Channels and messages of a recording, and the search for lost channel descriptions."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from functools import cached_property
from typing import Any, NamedTuple, TYPE_CHECKING

from bearing_twin.errors import BearingTwinError
from bearing_twin.recording.mcap.chunks import NEW_DESCRIPTION, ReadLimitExceeded
from bearing_twin.recording.mcap.mcapfile import BrokenRecording, parse
from bearing_twin.recording.mcap.salvage import sound_records
from bearing_twin.recording.mcap.schema import MessageSchema, store_from_text, type_conflict
from bearing_twin.recording.mcap.summary import summary_records
from mcap.opcode import Opcode
from mcap.records import Channel, Schema

if TYPE_CHECKING:
    from bearing_twin.recording.mcap.chunks import Chunks


DEFINITIONS = (Opcode.SCHEMA, Opcode.CHANNEL)
MOST_HELD = 64 * 1024 * 1024
"""Most bytes of schemas and channels of a file."""
MOST_DESCRIBED = 2 * 65_536
"""Most schemas and channels of a file without repetitions: MCAP can number 65 535 of each."""


@dataclass(frozen=True)
class RecordedChannel:
    """A topic as one file describes it."""

    topic: str
    type_name: str
    """``pkg/msg/Type``."""
    encoding: str
    """Encoding of the messages: ``cdr`` in ROS 2."""
    schema_encoding: str
    """Encoding of the schema: ``ros2msg`` in ROS 2."""
    schema: str
    qos: str
    """Offered QoS profiles in the YAML of rosbag2; '' if the file has none."""
    type_hash: str
    """``RIHS01_...``; '' if the file has none."""

    @cached_property
    def message_schema(self) -> MessageSchema:
        """Return the schema to write with its messages; all of them share one object."""
        return MessageSchema(self.type_name, self.schema, self.type_hash, self.schema_encoding)


class RecordedMessage(NamedTuple):
    """One recorded message."""

    channel: RecordedChannel
    log_time: int
    """Time of reception, ns."""
    publish_time: int
    """Time of sending, ns."""
    cdr: bytes

    @property
    def topic(self) -> str:
        """Topic it was recorded on."""
        return self.channel.topic

    @property
    def type_name(self) -> str:
        """Type, ``pkg/msg/Type``."""
        return self.channel.type_name

    def decode(self) -> Any:
        """Return an object with the fields of the ROS message, number arrays as numpy arrays."""
        channel = self.channel
        if channel.encoding != 'cdr' or channel.schema_encoding != 'ros2msg':
            raise BearingTwinError(
                f'{channel.topic} holds {channel.encoding or "unknown"} messages with a '
                f'{channel.schema_encoding or "missing"} schema; cdr with ros2msg is read'
            )
        store = store_from_text(channel.type_name, channel.schema)
        if conflict := type_conflict(channel.type_name, channel.schema):
            raise BearingTwinError(
                f'{channel.topic} has another {channel.type_name} than this version knows: '
                f'{conflict}; use the version that recorded it'
            )
        try:
            return store.deserialize_cdr(self.cdr, channel.type_name)
        except Exception as error:
            # rosbags raises exceptions of many types if the bytes are damaged.
            msg = f'a message on {channel.topic} is damaged ({type(error).__name__}: {error})'
            raise BearingTwinError(msg) from None


@contextmanager
def known_fields(topic: str, type_name: str) -> Iterator[None]:
    """
    Turn errors in the access to fields of a decoded message into a BearingTwinError.

    A recording contains its own definition of a type. There, fields of a type that is not of this
    package may be missing.
    """
    try:
        yield
    except (AttributeError, TypeError, ValueError, OverflowError, IndexError) as error:
        msg = f'{topic} has another {type_name} than this version knows ({error})'
        raise BearingTwinError(msg) from None


class Catalogue:
    """
    Catalogue of the channels that a file has described so far.

    Parameters
    ----------
    chunks
        The file. Each new description counts as work.
    elsewhere
        Catalogues to search for a channel that is not described yet; evaluated when needed.

    """

    def __init__(self, chunks: Chunks, elsewhere: Iterable[Catalogue] = ()) -> None:
        self._chunks = chunks
        self._schemas: dict[int, tuple[str, str, str]] = {}
        # The last description of each schema and channel: files repeat them many times.
        self._said: dict[int, dict[bytes, bytes]] = {kind: {} for kind in DEFINITIONS}
        self._held = self._described = 0
        self.channels: dict[int, RecordedChannel] = {}
        self._elsewhere = iter(elsewhere)
        self._others: list[Catalogue] = []
        self._unknown: set[int] = set()

    def learn(self, opcode: int, content: bytes, offset: int) -> None:
        """Add a schema or channel from a record of the file."""
        identity, said = content[:2], self._said[opcode]
        known = said.get(identity, b'')
        if known == content:
            return
        self._chunks.work(offset, NEW_DESCRIPTION)
        self._described += 1
        if self._described > MOST_DESCRIBED:
            self._chunks.refuse(offset, f'more than {MOST_DESCRIBED} schemas and channels')
        self._held += len(content) - len(known)
        if self._held > MOST_HELD:
            self._chunks.refuse(offset, f'schemas and channels of more than {MOST_HELD} bytes')
        record = parse(opcode, content, offset)
        said[identity] = content
        if isinstance(record, Schema):
            # Channels with this schema have another type from now on: read them again.
            self._said[Opcode.CHANNEL].clear()
            text = record.data.decode('utf-8', 'replace')
            self._schemas[record.id] = (record.name, record.encoding, text)
        elif isinstance(record, Channel):
            schema = self._schemas.get(record.schema_id)
            if schema is None and record.schema_id != 0:
                # It cannot be decoded without its schema; another part of the file may have both.
                return
            name, encoding, text = schema or ('', '', '')
            channel = RecordedChannel(
                topic=record.topic,
                type_name=name,
                encoding=record.message_encoding,
                schema_encoding=encoding,
                schema=text,
                qos=record.metadata.get('offered_qos_profiles', ''),
                type_hash=record.metadata.get('topic_type_hash', ''),
            )
            # Keep the first object when a description is repeated: all messages share it.
            if self.channels.get(record.id) != channel:
                self.channels[record.id] = channel

    def channel(self, identity: int) -> RecordedChannel | None:
        """Return a channel by its number; None if it cannot be found."""
        found = self.channels.get(identity)
        if found is None and identity not in self._unknown:
            found = self._found_elsewhere(identity)
            if found is None:
                self._unknown.add(identity)
            else:
                self.channels[identity] = found
        return found

    def _found_elsewhere(self, identity: int) -> RecordedChannel | None:
        for other in self._others:
            if identity in other.channels:
                return other.channels[identity]
        for other in self._elsewhere:
            self._others.append(other)
            if identity in other.channels:
                return other.channels[identity]
        return None


def own_definitions(chunks: Chunks) -> Iterator[Catalogue]:
    """
    Yield catalogues of the channels of a file: from its summary, then from the whole file.

    The work for this reduces the limit that is left for the messages.
    """
    catalogue = Catalogue(chunks)
    try:
        for raw, data in summary_records(chunks.file, chunks.size, DEFINITIONS):
            catalogue.learn(raw.opcode, data, raw.offset)
    except BrokenRecording:
        # Use the part of the summary that could be read.
        pass
    yield catalogue
    catalogue = Catalogue(chunks)
    wanted = (*DEFINITIONS, Opcode.CHUNK)
    for raw, data in sound_records(chunks, wanted, lambda _: None):
        try:
            if raw.opcode != Opcode.CHUNK:
                catalogue.learn(raw.opcode, data, raw.offset)
                continue
            for opcode, at, length in chunks.records(data, raw.offset):
                if opcode in DEFINITIONS:
                    catalogue.learn(opcode, data[at : at + length], raw.offset)
        except ReadLimitExceeded:
            break
        except BrokenRecording:
            # Damage is reported when the messages are read.
            continue
    yield catalogue
