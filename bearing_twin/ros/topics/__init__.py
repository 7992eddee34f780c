# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Topics of the nodes: their quality of service, what is taken of them, and any type as bytes."""
