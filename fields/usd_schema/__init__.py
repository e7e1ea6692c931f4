# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""The codeless USD schema that ships with palpate.

An asset reads and writes the same without it; registering adds the documentation, range and unit of every
attribute to the host.  USD builds its schema registry once per process, on first use of a prim definition;
a schema that comes later is never seen.  So call `register()` first thing, or put `schema_path()` into the
environment variable PXR_PLUGINPATH_NAME before the host starts.
"""

from __future__ import annotations

from pathlib import Path

__all__ = ["register", "schema_path"]


def schema_path() -> Path:
    """Folder with plugInfo.json and generatedSchema.usda; needs no `pxr`."""
    return Path(__file__).resolve().parent


def register() -> None:
    """Register the schema with USD in this process; may be repeated.

    Raises:
        FieldError: USD's schema registry was built before, so the schema would not be seen in this process.
    """
    from pxr import Plug, Usd

    from palpate.fields.field_error import FieldError
    from palpate.fields.usd_schema.attributes import APIS

    Plug.Registry().RegisterPlugins(str(schema_path()))
    missing = [api for api in APIS if not Usd.SchemaRegistry().FindAppliedAPIPrimDefinition(api)]
    if missing:
        raise FieldError(
            f"USD built its schema registry before palpate's schema was registered: {missing[0]} is unknown; "
            f"call register() before the first stage, or set PXR_PLUGINPATH_NAME={schema_path()}"
        )
