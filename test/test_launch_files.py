# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""The launch files load, and what they name exists; needs an installed ROS 2."""

import importlib.util
import inspect
from pathlib import Path

from bearing_twin.nodes.fleet_config import SPECS as FLEET
from bearing_twin.nodes.recorder_config import SPECS as RECORDER
from bearing_twin.nodes.replay_config import SPECS as REPLAY
from bearing_twin.nodes.twin_config import SPECS as TWIN
import pytest

launch = pytest.importorskip('launch', reason='launch is part of an installed ROS 2 only')
pytest.importorskip('launch_ros', reason='launch_ros is part of an installed ROS 2 only')

FOLDER = Path(__file__).resolve().parents[1] / 'launch'
PARAMETERS = {spec.name for specs in (FLEET, RECORDER, REPLAY, TWIN) for spec in specs}
NOT_PARAMETERS = {'namespace', 'params_file', 'record', 'use_sim_time'}


@pytest.mark.parametrize('path', sorted(FOLDER.glob('*.launch.py')), ids=lambda p: p.name)
def test_launch_file_describes_itself(path):
    spec = importlib.util.spec_from_file_location(path.name.split('.')[0], path)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    assert inspect.getdoc(module)
    arguments = module.generate_launch_description().get_launch_arguments()
    assert arguments
    for argument in arguments:
        assert argument.description, argument.name
        assert argument.name in PARAMETERS | NOT_PARAMETERS
