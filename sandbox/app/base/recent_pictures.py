"""RecentPictures: pictures by name, those used last, in this many bytes."""

from collections import OrderedDict
from collections.abc import Hashable
from typing import Generic, TypeVar

import pygame

Name = TypeVar("Name", bound=Hashable)


class RecentPictures(Generic[Name]):
    """Keeps pictures in at most this many bytes, but always the one that came last; bytes: what they take."""

    def __init__(self, most: int) -> None:
        self._most = most
        self._pictures: OrderedDict[Name, pygame.Surface] = OrderedDict()
        self.bytes = 0

    def find(self, name: Name) -> pygame.Surface | None:
        """The picture of that name, which is used now."""
        picture = self._pictures.get(name)
        if picture is not None:
            self._pictures.move_to_end(name)
        return picture

    def keep(self, name: Name, picture: pygame.Surface) -> None:
        """Keep a picture, in place of the one of its name and of those that were not used for longest."""
        self.forget(name)
        self._pictures[name] = picture
        self.bytes += picture.get_buffer().length
        while self.bytes > self._most and len(self._pictures) > 1:
            self.forget(next(iter(self._pictures)))

    def forget(self, name: Name) -> None:
        """Keep the picture of that name no longer, where there is one."""
        picture = self._pictures.pop(name, None)
        if picture is not None:
            self.bytes -= picture.get_buffer().length
