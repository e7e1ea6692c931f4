# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Rigid objects, offline: shapes and mass, cooking, tables of contact formations, examples."""
