"""Sentences about how far a body sags, by how it is held: the panel and the page say the same."""

from typing import NamedTuple

from sandbox.app.base.sentences import capitalised
from sandbox.physics.softness.settling import Support

SAG_TIP = "Part of its height by which a body sags where it stands, or of its length where it is held; 0 is rigid"
# What one sees of a body under its weight: the part that moves, how, and of what that is a share.
_SEEN = {
    Support.FLOOR: ("", "sags by", "height"),
    Support.ENDS: ("'s middle", "drops by", "length"),
    Support.HANGING: ("", "stretches by", "height"),
    Support.SPANNED: ("'s middle", "drops by", "length"),
    Support.ARM: ("'s end", "drops by", "length"),
    Support.HUB: ("'s rim", "drops by", "height"),
}


class SagSentence(NamedTuple):
    """What is said of a body: `sag` has {} where the share stands, `flat` is said where that says nothing any more."""

    sag: str
    flat: str


def subject_words(name: str, support: Support) -> str:
    """What of a body sags, as it stands in a sentence: "the girder's end"."""
    article = "" if name[-1:].isdigit() else "the "
    return f"{article}{name}{_SEEN[support][0]}"


def size_word(support: Support) -> str:
    """Of what a sag is a share: "height"."""
    return _SEEN[support][2]


def sag_sentence(name: str, support: Support) -> SagSentence:
    """How far a body sags that is held so."""
    _, verb, of = _SEEN[support]
    subject = capitalised(subject_words(name, support))
    flat = "lies flat under its own weight" if support is Support.FLOOR else f"{verb} more than half its {of}"
    return SagSentence(f"{subject} {verb} {{}} of its {of}", f"{subject} {flat}")
