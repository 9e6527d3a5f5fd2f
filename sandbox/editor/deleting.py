"""Taking things out of a level, and taking bodies apart."""

from sandbox.editor.document import Document


def delete(document: Document) -> Document:
    raise NotImplementedError


def break_apart(document: Document) -> Document:
    raise NotImplementedError
