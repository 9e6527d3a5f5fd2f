"""How much does a bridge carry? A check that no bar breaks is run under more and more load, until one does.

```sh
python docs/examples/bridge_breaks.py
```
"""

from sandbox import Level, run_checks
from sandbox.bodies import FORMAT, VERSION, BridgeDef, CheckDef, NissenMaterial, ParticleDef, SpringDef

IRON = NissenMaterial(stiffness=0.9, damping=0.99, tension_limit=0.01, compression_limit=0.01)


def bridge(load: float) -> Level:
    """A truss of 10 m, held at both ends, with a load [kg] on a cable under its middle."""
    return Level(
        format=FORMAT,
        version=VERSION,
        name=f"A bridge that carries {load:g} kg",
        materials={"iron": IRON},
        bodies=(
            BridgeDef(
                type="bridge", id="deck", start=(-5.0, 4.0), end=(5.0, 4.0), segments=10, pin=("start", "end"),
                particle_mass=4.0, material="iron",
            ),
        ),
        particles=(ParticleDef(id="load", position=(0.0, 2.0), mass=load),),
        springs=(SpringDef(a="deck.16", b="load"),),
        checks=(CheckDef(name="no bar breaks", metric="broken_springs", after=2.0, at_most=0.0),),
    )  # fmt: skip


def holds(load: float) -> bool:
    """Whether the bridge keeps its check, which it says."""
    (result,) = run_checks(bridge(load))
    print(f"{load:6.0f} kg: {result.text}")
    return result.passed


def main() -> None:
    """Load the bridge until it breaks, then look closer."""
    carried, broke = 0.0, 100.0
    while holds(broke):
        carried, broke = broke, 2.0 * broke
    while broke - carried > 0.05 * broke:
        middle = 0.5 * (carried + broke)
        carried, broke = (middle, broke) if holds(middle) else (carried, middle)
    print(f"The bridge carries {carried:.0f} kg and breaks under {broke:.0f} kg.")


if __name__ == "__main__":
    main()
