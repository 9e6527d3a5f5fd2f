"""A sample of the soak: random mouse and keyboard on several screens; nothing fails, and what was done is replayed."""

import os

from tests.abuse.soak import HOMES, hide_home, soak


def test_random_mouse_and_keyboard_fail_nowhere_and_stay_in_a_folder(tmp_path, monkeypatch, capsys):
    for name in (*HOMES, "PATH"):
        monkeypatch.setenv(name, os.environ.get(name, ""))
    monkeypatch.chdir(tmp_path)
    hide_home(tmp_path)
    assert soak(3, 120, tmp_path, stretch=20) == []
    begun = capsys.readouterr().out
    assert all(f"begun: {screen} 1" in begun for screen in ("gallery", "palette", "edit", "settings", "share", "help"))
    assert list(tmp_path.glob("soak-*.replay"))
