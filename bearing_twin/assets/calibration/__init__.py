# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""A twin that is fitted to its machine while both run: on what, when, and what the twin takes."""
