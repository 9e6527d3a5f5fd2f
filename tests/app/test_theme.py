"""The theme of the widgets: the library's lists of names to look a widget up by, without what it keeps beside them."""

import pytest
from pygame_gui.core.ui_appearance_theme import UIAppearanceTheme

from sandbox.app.draw.textures import MOST_SHEETS, MOST_TABLES, laid, skin_table, woven
from sandbox.app.draw.themes import THEMES
from sandbox.app.widgets.theme import Manager
from sandbox.level.reading.files import load_level

BUTTON = (
    [None, None, "button"], ["root_container", "panel", "button"], [None, "@card", None], [None, "#side", "#go"],
)  # fmt: skip


def test_names_of_a_widget_are_those_of_the_library_and_each_has_its_own(open_app):
    open_app()
    theme = Manager((640, 480), 1.0).get_theme()
    library = UIAppearanceTheme.build_all_combined_ids
    for ids in (BUTTON, tuple(part[:2] for part in BUTTON), tuple(part[1:] for part in BUTTON)):
        theme.unique_theming_ids.clear()
        wanted = library(theme, *ids)
        theme.unique_theming_ids.clear()
        assert theme.build_all_combined_ids(*ids) == wanted
        assert theme.build_all_combined_ids(*ids) == wanted
    with pytest.raises(ValueError, match="not equal in length"):
        theme.build_all_combined_ids(["a"], ["b", "c"], [None], [None])


def test_the_theme_keeps_no_megabytes_of_names(open_app):
    driver = open_app(load_level("suspension_car"))
    driver.app.act("settings")
    driver.frames()
    driver.app.documents.edit_level(load_level("suspension_car"))
    driver.frames()
    theme = driver.app.ui.manager.get_theme()
    # It was 23 MB.
    assert sum(map(len, theme.unique_theming_ids)) < 100_000


def test_no_more_than_so_many_colours_of_skins_are_kept():
    theme = next(iter(THEMES.values()))
    for colour in range(max(MOST_TABLES, MOST_SHEETS) + 5):
        skin_table("plain", colour, theme)
        woven(colour, 0)
        laid("brick", colour)
    assert skin_table.cache_info().currsize == MOST_TABLES
    assert woven.cache_info().currsize == laid.cache_info().currsize == MOST_SHEETS
