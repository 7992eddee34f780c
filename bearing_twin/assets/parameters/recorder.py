# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Parameters of the recorder node."""

from __future__ import annotations

from bearing_twin.assets.parameters.spec import field_spec, fixed
from bearing_twin.recording.writer import WriterOptions

SPECS = (
    fixed('output', '', 'Bag folder to make, or one file if it ends in .mcap. If the name is '
          "taken, NAME_2 is made, then NAME_3. '': bearing_twin_DATE-TIME in the working "
          'directory.'),
    fixed('topics', [''], 'Topics to record; relative names are resolved. None given, and no '
          'regex: all.'),
    fixed('regex', '', 'Record also the topics whose whole name matches this regular expression; '
          '{namespace} stands for that of the recorder.'),
    fixed('exclude', '', 'Do not record topics whose whole name matches this regular expression.'),
    fixed('include_hidden', False, 'Record hidden topics too (a part of the name begins with _).'),
    fixed('max_bag_size', 0, 'Size after which a new file is begun; 0: never.',
          'MiB', 0, 1_000_000),
    field_spec(WriterOptions, 'split_duration', name='max_bag_duration'),
    field_spec(WriterOptions, 'compression'),
    fixed('max_cache_size', 64, 'Memory for messages that wait for the disk.',
          'MiB', 1, 100_000),
    field_spec(WriterOptions, 'flush_period'),
    field_spec(WriterOptions, 'sync_period'),
    fixed('storage_limit', 0, 'Most space of the recording, which stops at this limit; 0: no '
          'limit. NAME_2, NAME_3, ... of later starts each have their own limit.',
          'MiB', 0, 100_000_000),
    field_spec(WriterOptions, 'delete_oldest'),
    fixed('snapshot', False, 'Keep the last seconds in memory and write them only when the '
          'diagnosis turns to fault or ~/snapshot is called.'),
    fixed('snapshot_before', 30.0, 'Length of a snapshot before the event.', 's', 0.0, 3600.0),
    fixed('snapshot_after', 10.0, 'Length of a snapshot after the event.', 's', 0.0, 3600.0),
    fixed('snapshot_memory', 256, 'Most memory for the time before the event.', 'MiB', 1, 100_000),
    fixed('rerun_file', '', 'Rerun recording (.rrd) to write too; NAME_2 if the name is taken. '
          "'': none."),
    fixed('rerun_port', 0, 'Port of a Rerun server for live viewers; 0: none (usual: 9876).',
          '', 0, 65535),
    fixed('rerun_address', '127.0.0.1', 'Address the Rerun server binds to; 0.0.0.0 lets other '
          'machines in.'),
)  # fmt: skip
