"""A person who changes a form of the editor by mouse."""

import pygame

from sandbox.level.document.canonical import level_text
from sandbox.level.reading.parse import parse_level


class Maker:
    """A person at a page of the editor's panel with a form, who has a mouse and types."""

    def __init__(self, driver, page):
        self.driver = driver
        driver.editor.side.choose(page)
        driver.frames(2)

    @property
    def page(self):
        return self.driver.editor.side.page

    @property
    def rules(self):
        return self.driver.editor.document.level.rules

    def press(self, name):
        """Scroll to a widget of the form, and click it."""
        widget = self.page.form._named[name]
        self.page.form.area.show_widget(widget)
        self.driver.frames(2)
        self.driver.click_widget(widget)

    def choose(self, name, text):
        """Open a menu of the form, and click the row with that text."""
        self.press(name)
        menu = self.page.form.pickers[name]._menu
        row = next(k for k, row in enumerate(menu.rows) if row.text == text)
        menu._reveal(row)
        self.driver.frames(2)
        self.driver.click((menu.rect.centerx, menu.rect.top + menu._tops[row] - round(menu._offset) + 8))
        self.driver.frames(2)

    def type(self, name, text):
        """Click a line of the form, type into it in place of what is there, and press Enter."""
        self.press(name)
        self.driver.key(pygame.K_a, pygame.KMOD_CTRL)
        self.driver.type(text)
        self.driver.key(pygame.K_RETURN)

    def file(self):
        """The level as its file reads it."""
        text = level_text(self.driver.editor.document.level)
        return parse_level(text.encode(), "file")
