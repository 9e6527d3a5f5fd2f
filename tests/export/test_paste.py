"""What is pasted elsewhere has the numbers of the body, in the language of the engine."""

import re
from importlib.util import find_spec

import pytest

from sandbox.export.engines import body_names
from sandbox.export.take_home import ENGINES, PASTED_MASSES, pasted, take_home
from sandbox.level.assembly.build_world import build_world
from sandbox.level.reading.files import load_level
from tests.support.wants import needs


@pytest.fixture(scope="module")
def jelly():
    return take_home(load_level("jelly_pile"), "cube 1")


@pytest.mark.parametrize("engine", ENGINES)
def test_the_lines_hold_the_numbers_that_the_text_says(jelly, engine):
    numbers = jelly.engines[engine]
    found = [float(each) for each in re.findall(r"(?<![\w.])\d+\.\d+", pasted(jelly, engine))]
    by_frequency = engine in ("box2d", "unity")
    mass = numbers.masses[0]
    wanted = [numbers.frequency, numbers.damping_ratio] if by_frequency else [mass.k, mass.c]
    assert found == pytest.approx(wanted, rel=5e-3)


def test_springs_between_different_masses_have_a_line_each_with_a_remark():
    level = load_level("truck_bridge")
    takes = [take_home(level, name) for name in body_names(build_world(level))]
    several = next(
        take for take in takes if len(take.engines["pymunk"].masses) > 1 and not take.engines["pymunk"].rigid
    )
    lines = pasted(several, "pymunk").splitlines()
    count = min(len(several.engines["pymunk"].masses), PASTED_MASSES)
    assert len(lines) == 2 * count and all(line.startswith("# the ") for line in lines[::2])


def test_what_is_too_stiff_for_the_springs_of_an_engine_has_nothing_to_be_pasted(jelly):
    stiff = take_home(load_level("truss_bridge"))
    rigid = [engine for engine in ENGINES if stiff.engines[engine].rigid]
    assert rigid and not any(pasted(stiff, engine) for engine in rigid)


@needs("pymunk", find_spec("pymunk"))
def test_pymunk_takes_its_line(jelly):
    import pymunk

    a, b, rest_length = pymunk.Body(1.0, 1.0), pymunk.Body(1.0, 1.0), 0.4
    spring = eval(pasted(jelly, "pymunk"), {"pymunk": pymunk, "a": a, "b": b, "rest_length": rest_length})
    mass = jelly.engines["pymunk"].masses[0]
    assert (spring.stiffness, spring.damping) == pytest.approx((mass.k, mass.c), rel=5e-3)
