# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Parameters of a recorder."""

from __future__ import annotations

from bearing_twin.assets.spec import field_spec, fixed
from bearing_twin.recording.writer import WriterOptions

SPECS = (
    fixed('output', '', 'Bag folder to make, or one file if it ends in .mcap. Where there is one '
          "of this name already, NAME_2 is made, then NAME_3. '': bearing_twin_DATE-TIME in the "
          'working directory.'),
    fixed('topics', [''], 'Topics to record, relative names resolved; none given, and no regex: '
          'all.'),
    fixed('regex', '', 'Record the topics whose whole name matches, besides those of topics; '
          '{namespace} stands for that of the recorder.'),
    fixed('exclude', '', 'Do not record topics whose whole name matches this regular expression.'),
    fixed('include_hidden', False, 'Record hidden topics (a part of the name begins with _) too.'),
    fixed('max_bag_size', 0, 'Size after which a new file is begun; 0: never.',
          'MiB', 0, 1_000_000),
    field_spec(WriterOptions, 'split_duration', name='max_bag_duration'),
    field_spec(WriterOptions, 'compression'),
    fixed('max_cache_size', 64, 'Memory for messages that wait while the disk takes none.',
          'MiB', 1, 100_000),
    field_spec(WriterOptions, 'flush_period'),
    field_spec(WriterOptions, 'sync_period'),
    fixed('storage_limit', 0, 'Most space the recording may take; 0: no limit. At the limit it '
          'stops. NAME_2, NAME_3, ... of later starts have each a limit of their own.',
          'MiB', 0, 100_000_000),
    field_spec(WriterOptions, 'delete_oldest'),
    fixed('snapshot', False, 'Keep the last seconds in memory and write them only when the '
          'diagnosis turns to fault or ~/snapshot is called.'),
    fixed('snapshot_before', 30.0, 'Time that a snapshot reaches back.', 's', 0.0, 3600.0),
    fixed('snapshot_after', 10.0, 'Time that a snapshot goes on.', 's', 0.0, 3600.0),
    fixed('snapshot_memory', 256, 'Most memory for the seconds before.', 'MiB', 1, 100_000),
    fixed('rerun_file', '', "Rerun recording (.rrd) to write too, or NAME_2 likewise; '': none."),
    fixed('rerun_port', 0, 'Port of a Rerun server for live viewers; 0: none (usual: 9876).',
          '', 0, 65535),
    fixed('rerun_address', '127.0.0.1', 'Address the Rerun server binds to; 0.0.0.0 lets other '
          'machines in.'),
)  # fmt: skip
