# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Interface of classes that store serialised messages; it checks the messages."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass, field
from typing import NamedTuple, TYPE_CHECKING

from bearing_twin.errors import BearingTwinError
from bearing_twin.recording.mcap.schema import message_schema, MessageSchema

if TYPE_CHECKING:
    from bearing_twin.recording.mcap.catalogue import RecordedMessage
    from typing_extensions import Self


LATEST = 2**63
OVERHEAD = 250
"""Bytes of memory that a message takes in addition to its content."""


class MessageToStore(NamedTuple):
    """One message to store; times in ns."""

    topic: str
    type_name: str
    cdr: bytes
    log_time: int
    publish_time: int
    qos: str
    schema: MessageSchema

    @property
    def memory(self) -> int:
        """Bytes of memory that the message takes while it waits."""
        return OVERHEAD + len(self.cdr)


@dataclass(frozen=True)
class Attachment:
    """An attachment (``data``) or a metadata record (``values``)."""

    name: str
    media_type: str = ''
    data: bytes = b''
    values: dict[str, str] = field(default_factory=dict)


class MessageSink(ABC):
    """Store messages, attachments and metadata; leaving the context closes the sink."""

    def __enter__(self) -> Self:
        """Return the sink."""
        return self

    def __exit__(self, *_: object) -> None:
        """Finish the recording."""
        self.close()

    def write(
        self,
        topic: str,
        type_name: str,
        cdr: bytes,
        *,
        log_time: int,
        publish_time: int,
        qos: str = '',
        schema: MessageSchema | None = None,
    ) -> None:
        """
        Check and store one serialised message.

        Parameters
        ----------
        topic, type_name
            Topic, and type as ``pkg/msg/Type``.
        cdr
            The message with its CDR header, as received.
        log_time, publish_time
            Time of reception and time of sending, ns.
        qos
            Offered QoS profiles, YAML (:func:`bearing_twin.recording.qos.qos_yaml`). Those of the
            first message of a topic are stored.
        schema
            Schema of the message. With None the installed package provides it.

        Raises
        ------
        BearingTwinError
            If the definition of the type is unknown, or a time is out of range.

        """
        schema = schema or message_schema(type_name)
        if not (0 <= log_time < LATEST and 0 <= publish_time < LATEST):
            raise BearingTwinError(f'{log_time=}, {publish_time=}: times are 0..{LATEST - 1} ns')
        self.take(MessageToStore(topic, type_name, cdr, log_time, publish_time, qos, schema))

    def copy(self, message: RecordedMessage) -> None:
        """Store a message from a recording unchanged; raises as :meth:`write`."""
        channel = message.channel
        self.write(
            channel.topic,
            channel.type_name,
            message.cdr,
            log_time=message.log_time,
            publish_time=message.publish_time,
            qos=channel.qos,
            schema=channel.message_schema,
        )

    @abstractmethod
    def take(self, message: MessageToStore) -> None:
        """Store one checked message."""

    def attach(self, name: str, data: bytes, media_type: str) -> None:
        """Attach a small file to every file of the recording."""
        self.add(Attachment(name, media_type=media_type, data=data))

    def metadata(self, name: str, values: dict[str, str]) -> None:
        """Add named texts to every file of the recording; what is not UTF-8 is escaped."""
        known = {
            key: text.encode(errors='backslashreplace').decode() for key, text in values.items()
        }
        self.add(Attachment(name, values=known))

    @abstractmethod
    def add(self, attached: Attachment) -> None:
        """Add an attachment or a metadata record."""

    @abstractmethod
    def flush(self) -> None:
        """Write all pending messages to the operating system."""

    @abstractmethod
    def close(self) -> None:
        """Finish the recording; a second call does nothing."""
