"""Pages go by the values and the tables that the window goes by, and their types say what Python gives them."""

import re
from typing import Any

import pytest

from sandbox.app.site.shared_values import MODULE, as_module, shared_values
from sandbox.page.bundle import TYPES, table_types
from sandbox.page.page import WEB
from tests.page.levels import level_page
from tests.page.packed import data_of


def test_the_module_of_shared_values_is_that_of_the_window() -> None:
    assert MODULE.read_text(encoding="utf-8") == as_module(shared_values()), "values were changed: run `make bundle`"


def test_pages_go_by_every_value_that_is_shared() -> None:
    whole = "".join(path.read_text(encoding="utf-8") for path in WEB.glob("*.js") if path != MODULE)
    unused = [
        f"{subject}.{name}"
        for subject, values in shared_values().items()
        for name in values
        if not re.search(rf"\b{subject}\.{name}\b|\b{name}\b[^;]*\}} = {subject}\b", whole)
    ]
    assert unused == []


def test_types_of_tables_are_those_of_the_tables() -> None:
    assert TYPES.read_text(encoding="utf-8") == table_types(), "tables were changed: run `make bundle`"


def declared(name: str) -> dict[str, bool]:
    """The fields of an interface of types.d.ts, with those of what it extends, and whether each may be left out."""
    text = (WEB / "types.d.ts").read_text(encoding="utf-8")
    found = re.search(rf"^export interface {name}(?: extends (\w+))? {{\n(.*?)^}}", text, re.MULTILINE | re.DOTALL)
    assert found is not None
    fields = re.findall(r"^  (\w+)(\??):", found[2], re.MULTILINE)
    return (declared(found[1]) if found[1] else {}) | {field: bool(optional) for field, optional in fields}


@pytest.mark.parametrize("level", ["suspension_car", "jelly_wheel", "pinball", "newtons_cradle"])
def test_types_have_every_field_that_python_gives_a_page(level: str) -> None:
    data = data_of(level_page(level))
    scene, about = data["scene"], data["about"]
    given: list[tuple[str, Any]] = [("Level", data), ("About", about), ("Scene", scene), ("Sounds", data["sounds"])]
    given += [(name, each) for name in ("Column",) for each in about["columns"]]
    given += [("CommandEntry", each) for each in about["commands"].values() if each]
    given += [("Kind", each) for each in about["kinds"].values()]
    given += [("Check", each) for each in data["checks"]] + [("MaterialRow", each) for each in data["materials"]]
    given += [("SceneBody", each) for each in scene["bodies"]] + [("Ground", each) for each in scene["ground"]]
    given += [("SceneShape", shape) for body in scene["bodies"] for shape in body["shapes"]]
    given += [("Wheel", body["wheel"]) for body in scene["bodies"] if "wheel" in body]
    given += [("Join", each) for each in scene["joins"]] + [("Ball", each) for each in scene["balls"]]
    given += [("SagMapData", each["map"]) for each in data["materials"] if "map" in each]
    for name, value in given:
        fields = declared(name)
        assert value.keys() <= fields.keys(), name
        assert {field for field, is_optional in fields.items() if not is_optional} <= value.keys(), name
