# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""One bearing: its steps, parted by what changes how fast, and the simulator around them."""
