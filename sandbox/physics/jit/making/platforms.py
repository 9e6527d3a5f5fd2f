"""The platforms that libraries are made for: a generic processor each, and for x86-64 one of 2013 on as well."""

from dataclasses import dataclass, replace

from sandbox.physics.jit.library import WIDE, library_name


@dataclass(frozen=True)
class Platform:
    """A platform that libraries are compiled for.

    name: of its library, before the suffix. target, processor: for zig. options: for its linker. entries: names of the
    only kernels that are called there; empty: all.
    """

    name: str
    suffix: str
    target: str
    processor: str
    options: tuple[str, ...] = ()
    entries: tuple[str, ...] = ()

    @property
    def file(self) -> str:
        """File name of the platform's library."""
        return f"{self.name}.{self.suffix}"

    @property
    def is_web(self) -> bool:
        """Whether the library is a WebAssembly module for pages, not one that Python opens."""
        return self.suffix == "wasm"


# The system's loader takes no library that does not name this one.
_MACHO = ("-lc", "-install_name", "@rpath/kernels.dylib")
# What a browser of 2023 has. No SIMD: it makes nothing faster, and the module larger.
_WASM = "mvp+bulk_memory+bulk_memory_opt+nontrapping_fptoint+sign_ext+mutable_globals"
# Products that melt into sums have other bits: a processor of level v3 could.
_V3 = "x86_64_v3-fma"

LIBRARIES = (
    Platform("linux-x86_64", "so", "x86_64-linux-none", "x86_64"),
    Platform(f"linux-x86_64{WIDE}", "so", "x86_64-linux-none", _V3),
    Platform("linux-arm64", "so", "aarch64-linux-none", "generic"),
    Platform("macos-x86_64", "dylib", "x86_64-macos.11.0", "x86_64", _MACHO),
    Platform(f"macos-x86_64{WIDE}", "dylib", "x86_64-macos.11.0", _V3, _MACHO),
    Platform("macos-arm64", "dylib", "aarch64-macos.11.0", "apple_m1", _MACHO),
    Platform("windows-x86_64", "dll", "x86_64-windows-gnu", "x86_64"),
    Platform(f"windows-x86_64{WIDE}", "dll", "x86_64-windows-gnu", _V3),
    Platform("windows-arm64", "dll", "aarch64-windows-gnu", "generic"),
)


def this_machine() -> Platform:
    """The platform of this machine, with all features of its processor."""
    name = library_name()
    known = next((each for each in LIBRARIES if each.file == name), None)
    if known is None:
        system, _, suffix = name.rpartition(".")
        return Platform(system, suffix, "native", "native")
    return replace(known, processor="native")


# What a page calls: it draws by itself.
_CALLED_BY_PAGES = (
    "sandbox.physics.pipeline.tick.tick",
    "sandbox.physics.pipeline.tick.take_back",
    "sandbox.physics.pipeline.tick.find_broken",
    "sandbox.physics.pipeline.derive.derive_topology",
    "sandbox.physics.pipeline.derive.derive_hands",
    "sandbox.physics.pipeline.derive.make_room",
    "sandbox.physics.pipeline.rule_evaluation.judge",
    "sandbox.physics.commands.command.command",
    "sandbox.physics.commands.command.count_pieces",
    "sandbox.physics.commands.command.form_of_spring",
    "sandbox.physics.meshing.fitting.fill_stroke",
    "sandbox.physics.kits.kit_kernels.join",
    "sandbox.physics.kits.kit_kernels.reserve",
    "sandbox.physics.kits.removing.remove",
    "sandbox.physics.analysis.step_response.choose_pull",
    "sandbox.physics.analysis.step_response.follow_release",
    "sandbox.physics.analysis.step_response.measure_response",
    "sandbox.physics.analysis.step_response.thin_curve",
    "sandbox.physics.analysis.feel_search.seek",
)
WEB = Platform("kernels", "wasm", "wasm32-freestanding", _WASM, entries=_CALLED_BY_PAGES)
