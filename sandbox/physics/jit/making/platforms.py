"""The platforms that libraries are made for: a generic processor each."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Platform:
    """One of them.

    name: of its library, before the suffix. triple, processor, features: for LLVM. target: for zig. options: for the
    linker. entries: names of the only kernels that are called there; empty: all.
    """

    name: str
    suffix: str
    triple: str
    processor: str
    target: str
    features: str = ""
    options: tuple[str, ...] = ()
    entries: tuple[str, ...] = ()

    @property
    def file(self) -> str:
        """The name of its library."""
        return f"{self.name}.{self.suffix}"


# The system's loader takes no library that does not name this one.
_MACHO = ("-lc", "-install_name", "@rpath/kernels.dylib")
# What a browser of 2023 has. No SIMD: it makes nothing faster, and the module larger.
_WASM = "+bulk-memory,+bulk-memory-opt,+nontrapping-fptoint,+sign-ext,+mutable-globals"

LIBRARIES = (
    Platform("linux-x86_64", "so", "x86_64-unknown-linux-gnu", "x86-64", "x86_64-linux-none"),
    Platform("linux-arm64", "so", "aarch64-unknown-linux-gnu", "generic", "aarch64-linux-none"),
    Platform("macos-x86_64", "dylib", "x86_64-apple-macosx11.0.0", "x86-64", "x86_64-macos.11.0", options=_MACHO),
    Platform("macos-arm64", "dylib", "arm64-apple-macosx11.0.0", "apple-m1", "aarch64-macos.11.0", options=_MACHO),
    Platform("windows-x86_64", "dll", "x86_64-pc-windows-gnu", "x86-64", "x86_64-windows-gnu"),
    Platform("windows-arm64", "dll", "aarch64-pc-windows-gnu", "generic", "aarch64-windows-gnu"),
)
# What a page calls: it draws by itself.
_CALLED_BY_PAGES = (
    "sandbox.physics.pipeline.tick.tick",
    "sandbox.physics.pipeline.tick.find_broken",
    "sandbox.physics.pipeline.derive.derive_topology",
    "sandbox.physics.pipeline.derive.derive_hands",
    "sandbox.physics.pipeline.derive.make_room",
    "sandbox.physics.command.command",
)
WEB = Platform(
    "kernels", "wasm", "wasm32-unknown-unknown", "mvp", "wasm32-freestanding", _WASM, entries=_CALLED_BY_PAGES
)
