"""Visibility: what is hidden or locked on the sheet while one works; the level itself says nothing of it."""

from dataclasses import dataclass

from sandbox.editor.items import Item, Selection

NOTHING: Selection = frozenset()


@dataclass(frozen=True)
class Visibility:
    """Items that are not drawn (hidden), and items that a pointer does not pick (locked; hidden ones neither)."""

    hidden: Selection = NOTHING
    locked: Selection = NOTHING

    @property
    def closed(self) -> Selection:
        """What a pointer does not pick."""
        return self.hidden | self.locked if self.locked else self.hidden

    def hide(self, items: Selection, on: bool) -> "Visibility":
        """Hide items, or show them again."""
        return Visibility(self.hidden | items if on else self.hidden - items, self.locked)

    def lock(self, items: Selection, on: bool) -> "Visibility":
        """Lock items, or open them again."""
        return Visibility(self.hidden, self.locked | items if on else self.locked - items)

    def renamed(self, old: Item, new: Item) -> "Visibility":
        """The same, where an item has another name now."""
        return Visibility(_renamed(self.hidden, old, new), _renamed(self.locked, old, new))

    def among(self, items: Selection) -> "Visibility":
        """The part of it that is about some items."""
        return Visibility(self.hidden & items, self.locked & items)


def _renamed(items: Selection, old: Item, new: Item) -> Selection:
    return items - {old} | {new} if old in items else items
