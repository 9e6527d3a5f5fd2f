"""Wheel with compiled kernels for any processor of its platform: built with SANDBOX_SHIP_KERNELS=1.

It is built without isolation (pip wheel --no-build-isolation), since that needs numba. The kernels are of use to
installations with the same versions of Python, numba and numpy; all others compile their own.
"""

import os
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any

from hatchling.builders.hooks.plugin.interface import BuildHookInterface

WISH = "SANDBOX_SHIP_KERNELS"


class KernelBuildHook(BuildHookInterface):
    """Adds what `sandbox prepare` puts into an empty cache."""

    def initialize(self, version: str, build_data: dict[str, Any]) -> None:
        """Compile before the wheel is put together, where that is wished for."""
        if self.target_name != "wheel" or os.environ.get(WISH, "0") in ("", "0"):
            return
        self._folder = tempfile.TemporaryDirectory()
        compile_kernels(Path(self.root), Path(self._folder.name))
        build_data["force_include"][str(Path(self._folder.name) / "kernels")] = "sandbox/_shipped/kernels"
        build_data["pure_python"] = False
        build_data["infer_tag"] = True

    def finalize(self, version: str, build_data: dict[str, Any], artifact_path: str) -> None:
        """Remove what was copied into the wheel."""
        if hasattr(self, "_folder"):
            self._folder.cleanup()


def compile_kernels(root: Path, cache: Path) -> None:
    """Compile all kernels of the sources below root into a cache folder, with instructions that every processor has."""
    choice = {"NUMBA_CPU_NAME": "generic", "NUMBA_CPU_FEATURES": "", "NUMBA_CACHE_DIR": str(cache)}
    path = {"PYTHONPATH": str(root), "XDG_CACHE_HOME": str(cache / "user")}
    subprocess.run(
        [sys.executable, "-m", "sandbox", "prepare"], cwd=root, env={**os.environ, **choice, **path}, check=True
    )
