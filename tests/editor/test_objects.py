"""The list of everything in a level: its lines, finding by words, and its order."""

import pytest

from sandbox.editor.document import Document, EditError, empty_level
from sandbox.editor.edits.copying import place_part
from sandbox.editor.edits.grouping import group, groups_of, rename_group, shift
from sandbox.editor.items import Item, definitions, items_of
from sandbox.editor.objects import object_lines
from sandbox.editor.storage.level_file import catalogue
from tests.support.zoo import zoo

PARTS = {part.path.stem: part.level for part in catalogue() if not part.is_own}


def two_parts():
    """Two ready parts, each a group, on one sheet."""
    document = Document(empty_level())
    for number, name in enumerate(["car", "crane"]):
        document = place_part(document, PARTS[name], (8.0 * number, 0.0))
    return document


def test_every_item_has_one_line_and_a_group_has_one_above_its_members():
    level = two_parts().level
    lines = object_lines(level)
    single = [line for line in lines if line.kind[:8] != "group of"]
    assert sorted(item for line in single for item in line.items) == sorted(items_of(level))
    heads = {line.name: line.items for line in lines if line not in single}
    assert set(heads) == {part.group for part in definitions(level)} - {None}
    for name, items in heads.items():
        assert items == frozenset(item for line in single if line.group == name for item in line.items)


@pytest.mark.parametrize("words", ["wheel", "WHEEL rubber", "steel"])
def test_words_find_lines_that_have_all_of_them_in_name_kind_material_or_group(words):
    level = zoo()
    found = {line for line in object_lines(level, words) if line.kind[:8] != "group of"}
    every = [line for line in object_lines(level) if line.kind[:8] != "group of"]
    words = words.lower().split()
    texts = {line: f"{line.name} {line.kind} {line.material} {line.group}".lower() for line in every}
    assert found == {line for line in every if all(word in texts[line] for word in words)}


def test_words_that_are_nowhere_find_nothing():
    assert object_lines(zoo(), "no such thing") == []


def order(level, kind="body"):
    return [str(item.key) for item in items_of(level) if item.kind == kind]


@pytest.mark.parametrize("later", [True, False])
def test_a_thing_goes_past_one_other_of_its_kind_and_stops_at_the_end(later):
    level = zoo()
    names = order(level)
    middle = len(names) // 2
    document = Document(level, frozenset([Item("body", names[middle])]))
    moved = order(shift(document, later).level)
    step = 1 if later else -1
    names[middle], names[middle + step] = names[middle + step], names[middle]
    assert moved == names
    for _ in names:
        document = shift(document, later)
    assert order(document.level)[-1 if later else 0] == names[middle + step]
    assert shift(document, later).level is document.level


def test_a_thing_goes_past_a_whole_group_and_a_member_stays_in_its_own():
    document = two_parts()
    first, second = dict.fromkeys(part.group for part in document.level.bodies)
    of = {name: [body.id for body in document.level.bodies if body.group == name] for name in (first, second)}
    whole = frozenset(item for item, name in groups_of(document.level).items() if name == first)
    swapped = shift(Document(document.level, whole), True)
    assert order(swapped.level) == of[second] + of[first]
    last = shift(Document(document.level, frozenset([Item("body", of[first][-1])])), True)
    assert order(last.level) == order(document.level)


def test_loose_springs_in_another_order_stay_selected():
    level = zoo()
    spring = level.springs[0]
    moved = shift(Document(level, frozenset([Item("spring", 0)])), True)
    assert moved.level.springs[1] == spring and moved.selection == {Item("spring", 1)}


def test_a_group_takes_another_name_but_not_that_of_another_group():
    document = two_parts()
    first, second = dict.fromkeys(part.group for part in document.level.bodies)
    renamed = rename_group(document, first, "racer").level
    assert {part.group for part in definitions(renamed)} - {None} == {"racer", second}
    with pytest.raises(EditError, match="there is a group"):
        rename_group(document, first, second)


def test_a_new_group_stands_where_its_first_member_stood():
    level = zoo()
    names = order(level)
    level = group(Document(level, frozenset(Item("body", name) for name in (names[1], names[-1])))).level
    lines = [line.name for line in object_lines(level)]
    assert lines.index("group") + 1 == lines.index(names[1]) == lines.index(names[-1]) - 1
