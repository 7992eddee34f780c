# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""
Write ``metadata.yaml`` of a bag folder, and the same content as a record of an MCAP file.

Version, fields and their order follow rosbag2_storage (``metadata_io.cpp``) since Jazzy.
"""

from __future__ import annotations

from collections.abc import Sequence
from copy import deepcopy
from dataclasses import dataclass
import os
from pathlib import Path
from typing import Any, TYPE_CHECKING

from bearing_twin.recording.qos import read_qos
from bearing_twin.wholefile import whole_file
import yaml

if TYPE_CHECKING:
    from bearing_twin.disksync import DiskSync


VERSION = 9
NO_MESSAGE = 2**63 - 1
"""Starting time of a bag without messages, as rosbag2 writes it, ns."""
MOST_LISTED = 5000
"""Most topics that are listed: each takes 70 us as YAML, and the record has at most 4 MiB."""
MOST_FILES = 10_000
"""Most files of a bag in metadata.yaml: each file takes 0.12 ms at each split."""
_DUMPER = getattr(yaml, 'CSafeDumper', yaml.SafeDumper)
"""The dumper of libyaml, if PyYAML has it: closing a recording takes a fraction of the time."""


@dataclass
class BagTopic:
    """One topic of one file."""

    name: str
    type_name: str
    qos: str
    type_hash: str
    count: int = 0


@dataclass(frozen=True)
class BagFile:
    """One file of a bag; times in ns."""

    name: str
    size: int
    count: int
    start: int
    end: int
    topics: list[BagTopic]


def metadata_record(files: Sequence[BagFile]) -> tuple[str, dict[str, str]]:
    """Return name and content of the MCAP metadata record that rosbag2 looks for."""
    return 'rosbag2', {'serialized_metadata': _dump(_information(files))}


class FinishedFiles:
    """
    Finished files of a recording; those of a bag folder are listed in its ``metadata.yaml``.

    It is written in the background: with thousands of files this takes a second.
    """

    def __init__(self, folder: Path, disk: DiskSync) -> None:
        self.files: list[BagFile] = []
        """The oldest first, without those that are left out."""
        self.folder = folder
        self._disk = disk
        # Messages and bytes of the files that are left out.
        self._earlier_count = self._earlier_size = 0
        # The files that metadata.yaml should list, those that it lists, and why it does not.
        self._to_list = self._listed = list[BagFile]()
        self._problem = ''

    @property
    def size(self) -> int:
        """Bytes of all finished files."""
        return self._earlier_size + sum(file.size for file in self.files)

    @property
    def too_many(self) -> bool:
        """Whether there are more files than can be listed."""
        return len(self.files) > MOST_FILES

    @property
    def unlisted(self) -> str:
        """Why ``metadata.yaml`` does not list all files; '' if it does."""
        waits = self._listed is not self._to_list
        return 'metadata.yaml waits for the disk' if waits else self._problem

    def leave_out_oldest(self) -> None:
        """Keep the oldest file, but list it no longer."""
        oldest = self.files.pop(0)
        self._earlier_count += oldest.count
        self._earlier_size += oldest.size

    def delete_oldest(self) -> str:
        """Delete the oldest file; return the error, '' if there is none."""
        oldest = self.files[0]
        try:
            (self.folder / oldest.name).unlink(missing_ok=True)
        except OSError as error:
            return f'{oldest.name} cannot be deleted: {error.strerror}'
        del self.files[0]
        return ''

    def forget_removed(self) -> int:
        """Forget the files that somebody removed; return the number of their messages."""
        lost = 0
        if self._earlier_count and not (self.folder / f'{self.folder.name}_0.mcap').exists():
            lost = self._earlier_count
            self._earlier_count = self._earlier_size = 0
        for file in list(self.files):
            if not (self.folder / file.name).exists():
                lost += file.count
                self.files.remove(file)
        return lost

    def write_list(self) -> None:
        """Write ``metadata.yaml`` in the background."""
        self._to_list = list(self.files)
        self._disk.do(self._write_list)

    def _write_list(self) -> None:
        files = self._to_list
        if files is not self._listed:
            self._problem = _write_metadata_file(self.folder, files)
            self._listed = files


def _write_metadata_file(folder: Path, files: Sequence[BagFile]) -> str:
    """Write ``metadata.yaml`` atomically; return the error, '' if there is none."""
    text = _dump({'rosbag2_bagfile_information': _information(files)})
    try:
        with whole_file(folder / 'metadata.yaml') as file:
            file.write(text.encode())
    except OSError as error:
        return f'{folder / "metadata.yaml"}: {error.strerror}'
    return ''


def _dump(value: dict[str, Any]) -> str:
    return str(yaml.dump(value, Dumper=_DUMPER, sort_keys=False, default_flow_style=False))


def _information(files: Sequence[BagFile]) -> dict[str, Any]:
    start, duration = _span(files)
    return {
        'version': VERSION,
        'storage_identifier': 'mcap',
        'duration': {'nanoseconds': duration},
        'starting_time': {'nanoseconds_since_epoch': start},
        'message_count': sum(file.count for file in files),
        'topics_with_message_count': _topics(files),
        'compression_format': '',
        'compression_mode': '',
        'relative_file_paths': [file.name for file in files],
        'files': [_file(file) for file in files],
        'custom_data': None,
        'ros_distro': os.environ.get('ROS_DISTRO', 'unknown'),
    }


def _span(files: Sequence[BagFile]) -> tuple[int, int]:
    filled = [file for file in files if file.count]
    if not filled:
        return NO_MESSAGE, 0
    start = min(file.start for file in filled)
    return start, max(file.end for file in filled) - start


def _file(file: BagFile) -> dict[str, Any]:
    start, duration = _span([file])
    return {
        'path': file.name,
        'starting_time': {'nanoseconds_since_epoch': start},
        'duration': {'nanoseconds': duration},
        'message_count': file.count,
    }


def _topics(files: Sequence[BagFile]) -> list[dict[str, Any]]:
    merged: dict[tuple[str, str], BagTopic] = {}
    for topic in (topic for file in files for topic in file.topics):
        if len(merged) < MOST_LISTED or (topic.name, topic.type_name) in merged:
            known = merged.setdefault(
                (topic.name, topic.type_name),
                BagTopic(topic.name, topic.type_name, topic.qos, topic.type_hash),
            )
            known.count += topic.count
    # Most topics offer the same profiles, and YAML is slow to read.
    profiles = {text: read_qos(text) for text in {topic.qos for topic in merged.values()}}
    return [
        {
            'topic_metadata': {
                'name': topic.name,
                'type': topic.type_name,
                'serialization_format': 'cdr',
                # A copy for each topic: YAML writes an object that appears twice as a reference.
                'offered_qos_profiles': deepcopy(profiles[topic.qos]),
                'type_description_hash': topic.type_hash,
            },
            'message_count': topic.count,
        }
        for topic in merged.values()
    ]
