# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Nodes as processes: started, run and ended, from a launch file or from here."""
