# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""One machine over time: its baseline, the dependence of its level, and the onset of a rise."""
