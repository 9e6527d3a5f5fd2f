"""The picture of a card that plays while the mouse rests on it."""

import pytest

from sandbox.app.base.loop import LONGEST_FRAME
from sandbox.app.gallery.card import REST, Preview
from sandbox.level.reading.files import write_level
from tests.app.conftest import small_level


@pytest.mark.parametrize("rate", [60, 600])
def test_a_card_plays_its_level_in_real_time_at_any_tick_rate(tmp_path, monkeypatch, rate):
    # A machine on which nothing takes any time.
    monkeypatch.setattr("sandbox.app.gallery.card.time.perf_counter", lambda: 0.0)
    path = tmp_path / "level.json"
    write_level(small_level(settings={"tick_rate": rate}), path)
    preview = Preview(path, (160, 90))
    while preview.picture is None:
        preview.update(REST)
    session = preview._session
    before = session.tick
    frames = 20
    for _ in range(frames):
        preview.update(LONGEST_FRAME / 10)
    assert session.tick - before == pytest.approx(frames * LONGEST_FRAME / 10 * rate, abs=1)
