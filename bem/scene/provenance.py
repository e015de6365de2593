"""Provenance of a result: versions, platform and date of the computation, and the digest of the scene."""

from __future__ import annotations

import platform
from collections.abc import Mapping
from datetime import UTC, datetime
from functools import cache
from importlib import metadata
from typing import Any

import numpy as np

from bem.scene.digest import digest

FACTS = ("linecontact", "python", "platform", "numpy", "scipy", "date", "scene_sha256")  # of every provenance


@cache
def installed_version() -> str:
    """Return the version of this package, as it is installed: `bem.__version__`."""
    try:
        return metadata.version("linecontact")
    except metadata.PackageNotFoundError:
        return "not installed"


def provenance(resolved_scene: Mapping[str, Any]) -> dict[str, str]:
    """Return versions, Python, platform, date (UTC) and digest of the scene; no path, no host name."""
    import scipy  # which reading a result does without

    return {
        "linecontact": installed_version(),
        "python": platform.python_version(),
        "platform": f"{platform.system()} {platform.machine()}",
        "numpy": np.__version__,
        "scipy": scipy.__version__,
        "date": datetime.now(UTC).isoformat(timespec="seconds"),
        "scene_sha256": digest(resolved_scene),
    }
