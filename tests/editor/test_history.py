"""History: steps with labels, undo without end, drags as one step, and what is saved."""

import pytest

from sandbox.editor.document import Document, empty_level
from sandbox.editor.edits.fields import set_level_field
from sandbox.editor.history import History
from sandbox.editor.items import Item
from tests.support.zoo import zoo


def named(history, name):
    return set_level_field(history.document, "name", name)


def test_undo_brings_back_the_very_level_and_redo_the_other():
    history = History(Document(zoo()))
    first = history.document.level
    history.apply("Rename", named(history, "A"))
    second = history.document.level
    history.undo()
    assert history.document.level is first
    history.redo()
    assert history.document.level is second
    assert history.labels == ["Open", "Rename"]


def test_a_new_step_forgets_what_was_undone():
    history = History(Document(zoo()), "New")
    history.apply("A", named(history, "A"))
    history.undo()
    history.apply("B", named(history, "B"))
    assert history.labels == ["New", "B"]
    assert not history.can_redo


def test_a_drag_is_one_step_until_it_ends():
    history = History(Document(zoo()))
    for name in ("a", "ab", "abc"):
        history.apply("Name", named(history, name), merge="name")
    history.end_merge()
    history.apply("Name", named(history, "d"), merge="name")
    assert history.labels == ["Open", "Name", "Name"]
    history.undo()
    assert history.document.level.name == "abc"
    history.undo()
    assert history.document.level.name == "Zoo"


def test_after_an_undo_the_same_key_begins_a_new_step():
    history = History(Document(zoo()))
    history.apply("Name", named(history, "a"), merge="name")
    history.apply("Other", named(history, "b"))
    history.undo()
    history.apply("Name", named(history, "c"), merge="name")
    assert history.labels == ["Open", "Name", "Name"]


def test_selecting_is_no_step_and_comes_back_with_its_state():
    history = History(Document(zoo()))
    history.select(frozenset([Item("body", "rope"), Item("body", "nobody")]))
    assert history.document.selection == {Item("body", "rope")}
    history.apply("Rename", Document(named(history, "A").level))
    assert history.document.selection == frozenset()
    history.undo()
    assert history.document.selection == {Item("body", "rope")}
    assert history.labels == ["Open", "Rename"]


def test_an_edit_that_changes_nothing_is_no_step():
    history = History(Document(zoo()))
    history.apply("Rename", named(history, "Zoo"))
    assert history.labels == ["Open"]


def test_saved_is_the_level_that_was_saved_wherever_one_goes():
    history = History(Document(empty_level()))
    assert history.is_saved
    history.apply("A", named(history, "A"))
    assert not history.is_saved
    history.mark_saved()
    history.apply("B", named(history, "B"), merge="x")
    assert not history.is_saved
    history.undo()
    assert history.is_saved
    history.go_to(0)
    assert not history.is_saved


def test_a_drag_that_goes_on_after_saving_is_a_step_of_its_own():
    history = History(Document(zoo()))
    history.apply("Name", named(history, "a"), merge="name")
    history.mark_saved()
    history.apply("Name", named(history, "b"), merge="name")
    history.undo()
    assert history.is_saved


def test_there_is_no_step_before_the_first_and_none_after_the_last():
    history = History(Document(zoo()))
    history.undo()
    history.redo()
    assert (history.index, history.can_undo, history.can_redo) == (0, False, False)
    with pytest.raises(IndexError):
        history.go_to(1)
