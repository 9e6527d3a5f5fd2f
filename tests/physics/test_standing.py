"""The sag of a definition is what the body shows in a run, standing alone on a floor: slabs, discs and beds."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

from sandbox.level.document.canonical import level_text
from sandbox.level.format.level_error import LevelError
from sandbox.level.format.limits import VERSION
from sandbox.level.reading.parse import parse_level
from sandbox.level.reading.salvage import salvage
from sandbox.physics.jit import COMPILED
from sandbox.physics.keeping.equipment import Firmness
from sandbox.physics.snapshot import state_hash
from sandbox.physics.softness.body_motion import common_pair, read_body
from sandbox.physics.softness.firmness import FirmnessRange, lowest_mode_of
from sandbox.physics.softness.kernels.reach import STANDING
from sandbox.physics.softness.sag_meter import SagMeter
from sandbox.physics.softness.settling import supported_body
from sandbox.physics.softness.standing import StandingForm
from sandbox.physics.step import step
from sandbox.session.commands import SetFirmness, apply
from sandbox.session.session import Session
from tests.support.wobbles import firm_level, firm_world, height

pytestmark = pytest.mark.skipif(not COMPILED, reason="interpreted kernels take minutes")

SAGS = (0.003, 0.02, 0.1, 0.25)
FORMS = {f"slab {wide}:1": {"shape": {"box": [0.5 * wide, 0.5]}, "spacing": 0.125} for wide in (1, 2, 3, 5, 8)} | {
    "disc": {"shape": {"circle": 0.5}, "spacing": 0.05},
    "fitted disc": {"shape": {"circle": 1.0}, "mesh": "fitted", "spacing": 0.125},
    "bed": {"shape": {"box": [4.4, 1.32]}, "mesh": "fitted", "spacing": 0.44},
    "flat bed": {"shape": {"box": [3.0, 1.0]}, "spacing": 0.25},
}
GRAVITY = {"gravity": [0, -9.81]}
RULE = b'"rules": [{"id": "r", "when": {"time": 0.0}, "then": [{"sag": 0.1, "body": "body"}]}], "bodies"'


def stands(world):
    """The sag of a world's one body, from a run of it alone on a floor."""
    body = world.forms[0]
    pair = common_pair(world, body)
    meter = SagMeter(supported_body(world, body), world.settings, lowest_mode_of(body.shape))
    meter.sag(pair)
    while meter.is_busy:
        meter.advance(1.0)
    return meter.sag_known(pair)


@pytest.mark.parametrize("name", FORMS)
def test_a_body_sags_by_the_number_of_its_definition_to_a_twentieth(name):
    found = [stands(firm_world({"sag": sag}, GRAVITY, **FORMS[name])) for sag in SAGS]
    print(name, *(f"{sag:g}: {100 * one:.3g} %" for sag, one in zip(SAGS, found, strict=True)))
    assert found == pytest.approx(SAGS, rel=0.05)


def test_a_slab_in_a_level_stands_on_the_ground_as_much_lower_as_it_says():
    world = firm_world({"sag": 0.1}, floor=True, shape={"box": [2.5, 0.5]}, position=[0, 0.31], spacing=0.125)
    for _ in range(900):
        step(world)
    assert height(world) / 0.5 == pytest.approx(0.9, abs=0.005)


def test_a_square_keeps_its_number_and_says_what_it_has():
    for cells in (8, 16):
        world = firm_world({"hz": 1.0}, GRAVITY, shape={"box": [1, 1]}, spacing=1 / cells)
        reach = FirmnessRange.of(world.forms[0].shape, (0.0, -9.81), 60)
        assert reach.form.constant(0.02) == pytest.approx(STANDING, rel=0.04)


@pytest.mark.parametrize("sag", [1e-4, 0.003, 0.0331, 0.1, 0.2, 0.39])
@pytest.mark.parametrize("name", ["slab 5:1", "disc", "bed"])
def test_what_is_asked_is_what_is_read_again(name, sag):
    world = firm_world({"sag": sag}, GRAVITY, **FORMS[name])
    reach = FirmnessRange.of(world.forms[0].shape, (0.0, -9.81), 60)
    assert reach.reading(*reach.coefficients(Firmness(sag=sag)))[0] == pytest.approx(sag, rel=1e-6)
    assert read_body(world, world.forms[0], reach.lowest_mode).sag == pytest.approx(sag, rel=1e-6)
    wobble = reach.as_wobble(Firmness(sag=sag))
    assert reach.reading(*reach.coefficients(wobble))[0] == pytest.approx(sag, rel=1e-3)


def test_a_form_is_told_alike_in_whatever_order_it_is_asked():
    shape = firm_world({"hz": 1.0}, GRAVITY, **FORMS["disc"]).forms[0].shape
    forms = [StandingForm(shape, (0.0, -9.81), lowest_mode_of(shape)) for _ in range(2)]
    up, down = ([form.constant(sag) for sag in order] for form, order in zip(forms, (SAGS, SAGS[::-1]), strict=True))
    assert up == down[::-1]


def test_gravity_from_the_side_lays_a_slab_on_its_other_side():
    slab = firm_world({"hz": 1.0}, **FORMS["slab 5:1"]).forms[0].shape
    mode = lowest_mode_of(slab)
    upright, aside = (StandingForm(slab, gravity, mode) for gravity in ((0.0, -2.0), (3.0, 0.0)))
    assert upright.length == pytest.approx(0.5) and aside.length == pytest.approx(2.5)
    assert aside.constant(0.003) > 10.0 * upright.constant(0.003)


@pytest.mark.parametrize(
    "body",
    [
        {"type": "rope", "start": [0, 0], "end": [0, 2], "segments": 8, "bending": {}},
        {"type": "mesh", "particles": [[0, 0], [1, 0], [1, 1], [0, 1]], "springs": [[0, 1], [1, 2], [2, 3], [3, 0],
         [0, 2]]},
        {"type": "wheel", "radius": 0.5, "thickness": 0.125, "segments": 16},
        {"type": "girder", "start": [0, 0], "end": [4, 1], "segments": 6, "height": 0.5},
    ],
    ids=lambda body: body["type"],
)  # fmt: skip
def test_what_has_no_area_or_tips_over_is_given_a_firmness_too(body):
    world = firm_world({"sag": 0.02}, GRAVITY, **body)
    assert 0.0 < world.stiffness[0] <= world.damping[0] < 1.0


def test_a_rule_makes_a_slab_sag_as_its_definition_would():
    slab = {"shape": {"box": [2.5, 0.5]}, "position": [0, 5], "spacing": 0.125}
    level = firm_level({"sag": 0.02}, floor=True, **slab)
    ruled = Session(parse_level(level.replace(b'"bodies"', RULE), "ruled"))
    for _ in range(3):
        ruled.advance()
    asked = firm_world({"sag": 0.1}, floor=True, **slab)
    assert common_pair(ruled.world, ruled.world.forms[0]) == common_pair(asked, asked.forms[0])


def test_a_level_of_an_older_version_keeps_every_bit_of_its_motion():
    slab = {"shape": {"box": [2.0, 0.5]}, "position": [0, 1], "spacing": 0.125}
    old = firm_level({"sag": 0.1}, floor=True, **slab).replace(b'"version": 4', b'"version": 3')
    level = parse_level(old, "old.json")
    assert level.bodies[0].firmness.sag is None
    commanded = Session(parse_level(firm_level({"hz": 1.0}, floor=True, **slab), "new.json")).world
    # The command takes a sag as older levels did.
    apply(commanded, SetFirmness(0, sag=0.1))
    assert state_hash(Session(level).world) == state_hash(commanded)
    saved = parse_level(level_text(level).encode(), "saved.json")
    assert saved == level and saved.version == VERSION


def test_an_older_rule_makes_the_sag_that_it_made():
    slab = {"shape": {"box": [2.0, 0.5]}, "position": [0, 1], "spacing": 0.125}
    text = firm_level({"hz": 1.0}, floor=True, **slab).replace(b'"version": 4', b'"version": 3')
    level = parse_level(text.replace(b'"bodies"', RULE), "old.json")
    assert 0.0 < level.rules[0].then[0].sag < 0.005
    with pytest.raises(LevelError, match="spacing"):
        parse_level(text.replace(b'"spacing": 0.125', b'"spacing": -1').replace(b'"bodies"', RULE), "bad.json")


@pytest.mark.parametrize("version", [3, VERSION])
def test_what_is_left_of_a_damaged_level_has_the_firmness_that_it_had(version):
    text = firm_level({"sag": 0.1}, floor=True, shape={"box": [2.0, 0.5]}, spacing=0.125)
    text = text.replace(b'"version": 4', f'"version": {version}'.encode())
    left, faults = salvage(text.replace(b'"bodies"', b'"particles": [7], "bodies"'), "bad.json")
    assert faults and left.bodies == parse_level(text, "good.json").bodies


def test_the_same_bits_are_found_by_compiled_and_by_interpreted_kernels():
    script = (
        "from tests.support.wobbles import firm_world\n"
        "from sandbox.physics.softness.firmness import lowest_mode_of\n"
        "from sandbox.physics.softness.standing import StandingForm\n"
        "for body in ({'shape': {'box': [1, 0.5]}}, {'shape': {'circle': 0.5}, 'mesh': 'fitted'}):\n"
        "    shape = firm_world({'hz': 1.0}, spacing=0.25, **body).forms[0].shape\n"
        "    form = StandingForm(shape, (0.3, -9.0), lowest_mode_of(shape))\n"
        "    print([form.constant(sag).hex() for sag in (0.003, 0.1, 0.25)])\n"
    )
    root = Path(__file__).resolve().parents[2]
    found = {
        subprocess.run(
            [sys.executable, "-c", script], cwd=root, capture_output=True, check=True, text=True,
            env={**os.environ, "PYTHONPATH": str(root), "SANDBOX_KERNELS": way},
        ).stdout
        for way in ("library", "generic", "interpreted")
    }  # fmt: skip
    assert len(found) == 1
