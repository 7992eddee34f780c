# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""What takes serialised messages to be kept: checked at the door, finished when it is left."""

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
"""Bytes that a message takes in memory besides its content."""


class Written(NamedTuple):
    """One message to be kept; times in ns."""

    topic: str
    type_name: str
    cdr: bytes
    log_time: int
    publish_time: int
    qos: str
    schema: MessageSchema

    @property
    def memory(self) -> int:
        """Bytes that it takes while it waits."""
        return OVERHEAD + len(self.cdr)


@dataclass(frozen=True)
class Attached:
    """An attachment (``data``) or a metadata record (``values``)."""

    name: str
    media_type: str = ''
    data: bytes = b''
    values: dict[str, str] = field(default_factory=dict)


class MessageSink(ABC):
    """Take messages, attachments and metadata; leaving the context closes it."""

    def __enter__(self) -> Self:
        """Return itself."""
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
        Take one serialised message.

        Parameters
        ----------
        topic, type_name
            Topic, and type as ``pkg/msg/Type``.
        cdr
            The message with its CDR header, as it came off the wire.
        log_time, publish_time
            When it was received and sent, ns.
        qos
            Offered QoS profiles, YAML (:func:`bearing_twin.recording.qos.qos_yaml`); taken from
            the first message of a topic.
        schema
            Its schema; None: that of the installed package.

        Raises
        ------
        BearingTwinError
            If the definition of the type is not known, or a time cannot be stored.

        """
        schema = schema or message_schema(type_name)
        if not (0 <= log_time < LATEST and 0 <= publish_time < LATEST):
            msg = f'{log_time=}, {publish_time=}: times are 0..{LATEST - 1} ns'
            raise BearingTwinError(msg)
        self.take(Written(topic, type_name, cdr, log_time, publish_time, qos, schema))

    def copy(self, message: RecordedMessage) -> None:
        """Take a message as it was recorded; raises what :meth:`write` does."""
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
    def take(self, message: Written) -> None:
        """Take one message that has been checked."""

    def attach(self, name: str, data: bytes, media_type: str) -> None:
        """Attach a small file; it is repeated in every file of a recording."""
        self.add(Attached(name, media_type=media_type, data=data))

    def metadata(self, name: str, values: dict[str, str]) -> None:
        """Add named texts; they are repeated in every file of a recording."""
        self.add(Attached(name, values=values))

    @abstractmethod
    def add(self, attached: Attached) -> None:
        """Take an attachment or a metadata record."""

    @abstractmethod
    def flush(self) -> None:
        """Hand everything that is to be written to the operating system."""

    @abstractmethod
    def close(self) -> None:
        """Finish the recording; a second call does nothing."""
