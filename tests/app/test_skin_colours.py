"""Colours of skins: how many are kept; and of materials, by their looks."""

from sandbox.app.draw.colours import THEMES, unpacked
from sandbox.app.draw.looks import material_colours
from sandbox.app.draw.textures import MOST_SHEETS, MOST_TABLES, laid, skin_table, woven
from sandbox.level.document.model import NissenMaterial
from sandbox.level.format.look import PALETTE, BodyLook
from sandbox.level.format.quantities import replaced


def test_no_more_than_so_many_colours_of_skins_are_kept():
    theme = next(iter(THEMES.values()))
    for colour in range(max(MOST_TABLES, MOST_SHEETS) + 5):
        skin_table("plain", colour, theme)
        woven(colour, 0)
        laid("brick", colour)
    assert skin_table.cache_info().currsize == MOST_TABLES
    assert woven.cache_info().currsize == laid.cache_info().currsize == MOST_SHEETS


def test_a_material_is_listed_and_drawn_in_the_colour_of_its_look():
    material = NissenMaterial(stiffness=0.5, damping=0.5)
    plain = material_colours({"steel": material, "jelly": material})
    sky = replaced(material, look=BodyLook(colour="sky"))
    assert tuple(material_colours({"steel": material, "jelly": sky})["jelly"]) == tuple(unpacked(PALETTE["sky"]))
    assert material_colours({"steel": material, "jelly": sky})["steel"] is plain["steel"]
    faceless = replaced(material, look=BodyLook(face=False))
    assert material_colours({"steel": material, "jelly": faceless}) == plain
    assert tuple(material_colours({"default": sky})["default"]) == tuple(unpacked(PALETTE["sky"]))
