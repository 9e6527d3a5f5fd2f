"""JSON Schema of the level format, from the models.

`python -m sandbox.level.document.schema > sandbox/level/level.schema.json` writes the file that is shipped.
"""

import json
from typing import Any

from sandbox.level.document.model import Level
from sandbox.level.format.limits import VERSION
from sandbox.level.kinds.bodies import EXPANSIONS, KINDS
from sandbox.level.kinds.body_def import file_order

# What the schema is called; it needs no address on the web.
SCHEMA_ID = f"urn:spring-sandbox:level:{VERSION}"

# Titles of the definitions, in the order in which the reference explains them.
TITLES = {
    "Settings": "Settings",
    "NissenMaterial": "Material",
    "HookeMaterial": "Hooke material",
    "ContactsDef": "Contacts",
    "WallsDef": "Walls",
    "TerrainDef": "Terrain",
    "ZoneDef": "Zone",
    "WaterDef": "Water",
    "CounterDef": "Counter",
    "RuleDef": "Rule",
    "QuestionDef": "Question",
    "ActionDef": "Action",
    "StarsDef": "Stars",
    "PlayerLimits": "Hands",
    "BudgetDef": "Budget",
    **{
        model.__name__: name.capitalize()
        for kind, each in EXPANSIONS.items()
        for name, model in {kind: each.model, **each.alternatives}.items()
    },
    "FirmnessDef": "Firmness",
    "BendingDef": "Bending",
    "ParticleDef": "Loose particle",
    "SpringDef": "Loose spring",
    "MuscleDef": "Muscle",
    "HydraulicDef": "Hydraulic",
    "MotorDef": "Motor",
    "CheckDef": "Acceptance check",
    "HoldDef": "Key that is held",
    "LevelLook": "Level look",
    "BodyLook": "Body look",
    "ParticleLook": "Particle look",
    "ZoneLook": "Zone look",
}

# Of these fields a definition has one.
_FORMS = {"TerrainDef": ("polyline", "polygon"), "ZoneDef": ("box", "circle", "polygon")}


def described(field: dict[str, Any], null: str) -> str:
    """The description of a field, given its JSON Schema, and what null means, which readers know as the word `null`."""
    text: str = field.get("description", "")
    return f"{text} {null}: {field['empty']}." if "empty" in field else text


def definitions() -> dict[str, Any]:
    """JSON Schema (2020-12) of a level file, as its models declare it.

    `unit` on a property is its unit, and `empty` says what null means. The schema cannot say that a reference leads
    somewhere, or how large a level may become.
    """
    result = Level.model_json_schema()
    for name, definition in result["$defs"].items():
        definition["title"] = TITLES[name]
    for kind in KINDS.values():
        definition = result["$defs"][kind.__name__]
        definition["properties"] = {
            name: definition["properties"][name] for name in file_order(definition["properties"])
        }
    for name, forms in _FORMS.items():
        of_each = [{"required": [form], "properties": {form: {"type": "array"}}} for form in forms]
        result["$defs"][name]["allOf"] = [{"oneOf": of_each}]
    # Water is in boxes.
    with_water = {"required": ["water"], "properties": {"water": {"type": "object"}}}
    result["$defs"]["ZoneDef"]["allOf"].append({"if": with_water, "then": {"required": ["box"]}})
    head = {"$schema": "https://json-schema.org/draft/2020-12/schema", "$id": SCHEMA_ID}
    return {**head, **result, "title": "Spring Sandbox level"}


def schema() -> dict[str, Any]:
    """The schema that is shipped: the descriptions say what null means too."""
    whole = definitions()
    for model in (whole, *whole["$defs"].values()):
        for field in model["properties"].values():
            field["description"] = described(field, "null")
    return whole


def schema_text() -> str:
    """The schema as the text of the file that is shipped."""
    return json.dumps(schema(), indent=2) + "\n"


if __name__ == "__main__":
    print(schema_text(), end="")
