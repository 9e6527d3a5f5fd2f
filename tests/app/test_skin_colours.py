"""Colours of skins: how many are kept."""

from sandbox.app.draw.textures import MOST_SHEETS, MOST_TABLES, laid, skin_table, woven
from sandbox.app.draw.themes import THEMES


def test_no_more_than_so_many_colours_of_skins_are_kept():
    theme = next(iter(THEMES.values()))
    for colour in range(max(MOST_TABLES, MOST_SHEETS) + 5):
        skin_table("plain", colour, theme)
        woven(colour, 0)
        laid("brick", colour)
    assert skin_table.cache_info().currsize == MOST_TABLES
    assert woven.cache_info().currsize == laid.cache_info().currsize == MOST_SHEETS
