"""Reads XML of strangers as a tree, within limits: no entities, no depth without end."""

import io
from typing import Any
from xml.etree.ElementTree import Element, ParseError

from sandbox.bring.sketch import Unreadable

ELEMENT_LIMIT = 100_000
DEPTH_LIMIT = 100


def xml_tree(data: bytes) -> Element:
    """The root of an XML text. Raises Unreadable."""
    from defusedxml.common import DefusedXmlException
    from defusedxml.ElementTree import iterparse

    depth = count = 0
    root: Element | None = None
    try:
        events: Any = iterparse(io.BytesIO(data), events=("start", "end"))
        for event, element in events:
            root = element if root is None else root
            depth += 1 if event == "start" else -1
            count += event == "start"
            if depth > DEPTH_LIMIT:
                raise Unreadable(f"nests elements more than {DEPTH_LIMIT} deep; make it flatter")
            if count > ELEMENT_LIMIT:
                raise Unreadable(f"has more than {ELEMENT_LIMIT:,} elements; simplify it")
    except DefusedXmlException:
        raise Unreadable("declares entities of XML; save it without them, as plain XML") from None
    except ParseError as error:
        line, column = error.position
        raise Unreadable(f"line {line}, column {column + 1}: not XML: {str(error).partition(':')[0]}") from None
    except (LookupError, ValueError) as error:
        if isinstance(error, Unreadable):
            raise
        raise Unreadable("has a character set that is not known; save it as UTF-8") from None
    if root is None:
        raise Unreadable("is empty")
    return root


def local_name(element: Element) -> str:
    """The name of an element without its namespace; "" for comments and the like."""
    return element.tag.rpartition("}")[2] if isinstance(element.tag, str) else ""
