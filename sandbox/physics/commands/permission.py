"""Permission: whether a level lets hands give a kind of command, touch a thing, and how often; all of it lies in state.

Rules of a level and programs may do everything. A level that says nothing of hands has no rows of the family DEED.
"""

from sandbox.physics.jit import inner_kernel
from sandbox.physics.state import State

# Who gives a command.
HAND, RULE, PROGRAM = range(3)
# Why a kind of command is refused: hands may not give it, its budget is spent, or it is about something that they may
# not touch.
GRANTED, NOT_ALLOWED, SPENT, UNTOUCHED = range(4)
# Kernels beside `command` that ask answer -(reason DENIED + k); k: the place of what it is about.
DENIED = 2**40


@inner_kernel
def refusal(state: State, giver: int, kind: int, needs: int) -> int:
    """GRANTED, or why a kind of command, which takes so many of its budget, is refused."""
    if giver != HAND or state.deed_refused.shape[0] == 0:
        return GRANTED
    if state.deed_refused[kind]:
        return NOT_ALLOWED
    row = state.deed_budget[kind]
    return SPENT if row >= 0 and state.counter[row] < needs else GRANTED


@inner_kernel
def denied(why: int, place: int) -> int:
    """The answer of a kernel that refuses."""
    return -(why * DENIED + place)


@inner_kernel
def spend(state: State, giver: int, kind: int, needs: int) -> None:
    """Take from its budget what a command has needed that was carried out."""
    if giver == HAND and state.deed_refused.shape[0] > 0:
        row = state.deed_budget[kind]
        if row >= 0:
            state.counter[row] -= needs
