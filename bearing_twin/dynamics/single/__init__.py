# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""One bearing: kinematics, integrator, compiled kernel and `Simulator`."""
