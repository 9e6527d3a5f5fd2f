"""The profile of a run: figures of its last frames, and no more memory however long it lasts."""

import time

from sandbox.app.base.loop import REMEMBERED, Profile


def test_a_long_run_is_counted_whole_and_told_by_its_last_frames():
    profile, began = Profile(), time.perf_counter()
    for frame in range(REMEMBERED + 100):
        with profile.part("ticks"):
            pass
        profile.end_frame(1.0 if frame < 100 else 0.002)
    assert {name: len(times) for name, times in profile.milliseconds.items()} == {
        "ticks": REMEMBERED,
        "frame": REMEMBERED,
    }
    lines = profile.table(began).splitlines()
    assert any(line.split() == ["frame", "2.00", "2.00", "2.00"] for line in lines)
    assert any(line.startswith(f"{REMEMBERED + 100} frames in ") for line in lines)
