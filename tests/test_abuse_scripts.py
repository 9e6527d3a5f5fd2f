"""The long figures run by one command: each script takes the same option and ends with whether its limits hold."""

import importlib

import pytest

from tests.abuse.__main__ import main, names
from tests.support.limits import Limits


def test_every_script_runs_whole_when_asked(capsys):
    for name in names():
        with pytest.raises(SystemExit) as ended:
            importlib.import_module(f"tests.abuse.{name}").main(["--help"])
        assert ended.value.code == 0
        assert "--all" in capsys.readouterr().out


def test_an_unknown_script_is_refused_before_any_runs(capsys):
    with pytest.raises(SystemExit):
        main(["no_such_script"])
    assert "no_such_script" in capsys.readouterr().err


@pytest.mark.parametrize(("value", "least", "most", "broken"), [(1, 0, 2, 0), (3, 0, 2, 1), (-1, 0, 2, 1)])
def test_a_figure_beyond_its_limit_is_told(value, least, most, broken, capsys):
    limits = Limits()
    limits.at_least("figure", value, least)
    limits.at_most("figure", value, most)
    assert limits.broken == bool(broken) and capsys.readouterr().out.count("BROKEN") == broken


def test_what_is_no_number_breaks_a_limit():
    limits = Limits()
    limits.at_most("figure", float("nan"), 1.0)
    assert limits.broken
