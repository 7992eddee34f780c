# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""What every node loads, and the kernels: imported by the process that nodes are forked from."""

import importlib

from bearing_twin.cli.run import NODES
from bearing_twin.diagnosis import compilation as diagnosis
from bearing_twin.dynamics import compilation as dynamics
from bearing_twin.ros.processes import running  # noqa: F401

for node in NODES:
    importlib.import_module(f'bearing_twin.nodes.{node}')
dynamics.warm_up(fleet=True)
diagnosis.warm_up()
