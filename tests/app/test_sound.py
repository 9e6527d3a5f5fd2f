"""Sound: what is heard of a run, never more than a dozen voices, never a clipped one; and none without a device."""

import itertools
import subprocess
import sys

import numpy as np
import pygame
import pytest

from sandbox.app.settings.chosen import Chosen
from sandbox.app.sound import waves
from sandbox.app.sound.sound_events import SoundEvents
from sandbox.app.sound.sounds import Device, Sounds, may_have_sound
from sandbox.app.sound.voices import SPARE, VOICES, Cue, Mixdown, Voices
from sandbox.app.sound.waves import MAKERS, Bank, Note
from sandbox.level.reading.files import load_level
from sandbox.physics.snapshot import state_hash
from sandbox.session.commands import AddParticle, CutSprings, SetDrive
from sandbox.session.session import Session
from tests.app.conftest import FRAME, small_level

FALLING = {
    "contacts": {"friction": 0.5, "restitution": 0.3},
    "settings": {"solver": "direct"},
    "walls": {"box": [-3, -3, 7, 6]},
    "bodies": [],
    "particles": [
        {"id": "small", "position": [0, -1], "radius": 0.1, "mass": 1},
        {"id": "large", "position": [3, -1], "radius": 0.5, "mass": 25},
    ],
}


@pytest.fixture(scope="module")
def bank():
    return Bank()


def every_wave():
    for step in (0, 9, 18, waves.STEPS - 1):
        for kind, make in MAKERS.items():
            for stuff in waves.STUFFS if kind == "thud" else ("",):
                yield kind, make(Note(kind, step, stuff))


def test_no_wave_clicks_or_clips():
    for kind, wave in every_wave():
        assert np.isfinite(wave).all() and np.abs(wave).max() == pytest.approx(1.0), kind
        if kind == "motor":
            # Where a loop closes it goes on no more steeply than elsewhere.
            assert abs(wave[0] - wave[-1]) <= np.abs(np.diff(wave)).max() + 1e-9
        else:
            assert abs(wave[0]) < 1e-3 and abs(wave[-1]) < 1e-3, kind
            # It swells up, and ends quietly.
            assert np.abs(wave[:8]).max() < 0.5 and np.abs(wave[-200:]).max() < 0.06, kind


def test_waves_sound_at_their_pitch():
    for make in (lambda step: waves.thud(step, "glass"), waves.pluck):
        for step in (8, 12):
            wave = make(step)
            power = np.abs(np.fft.rfft(wave * np.hanning(len(wave)), 1 << 17))
            pitch = np.fft.rfftfreq(1 << 17, 1 / waves.RATE)[np.argmax(power)]
            overtones = pitch / waves.pitch_of(step)
            assert abs(overtones - round(overtones)) < 0.03


def hear(level, ticks, act=lambda session: None):
    """What is heard of a level, tick by tick, and the run's hashes."""
    session, ear, heard, hashes = Session(level), SoundEvents(), [], []
    for _ in range(ticks):
        act(session)
        session.advance()
        ear.hear(session.world)
        heard += [(session.tick, each) for each in ear.heard]
        ear.heard.clear()
        hashes.append(state_hash(session.world))
    return heard, hashes


def test_what_falls_is_heard_when_it_lands_and_the_larger_one_is_lower_and_louder():
    heard, _ = hear(small_level(**FALLING), 60)
    blows = [(tick, each) for tick, each in heard if each.note.kind == "thud"]
    first = {}
    for tick, each in blows:
        first.setdefault(each.source, (tick, each))
    small, large = first[0][1], first[1][1]
    # From 1.9 m and 1.5 m above the ground.
    assert abs(first[0][0] / 60 - np.sqrt(2 * 1.9 / 9.81)) < 0.05
    assert large.note.step < small.note.step and large.loudness > small.loudness
    assert small.place[0] == pytest.approx(0.0, abs=0.1) and large.place[0] == pytest.approx(3.0, abs=0.1)


def test_what_lies_is_not_heard():
    heard, _ = hear(small_level(**FALLING), 480)
    assert heard and max(tick for tick, _ in heard) < 360


def test_what_is_cut_snaps_and_what_is_taken_out_does_not():
    level = load_level("rope")

    def cut(session):
        if session.tick == 10:
            session.submit(CutSprings((5, 6)))

    heard, _ = hear(level, 14, cut)
    assert [each.note.kind for tick, each in heard if tick == 11] == ["snap"]


def test_motors_are_heard_while_they_are_driven():
    session, ear = Session(load_level("suspension_car")), SoundEvents()
    for _ in range(5):
        session.advance()
    assert ear.motors(session.world) == []
    for part in range(len(session.world.actuator_value)):
        session.submit(SetDrive(part, 1.0))
    session.advance()
    slow = ear.motors(session.world)
    for _ in range(60):
        session.advance()
    fast = ear.motors(session.world)
    assert slow and fast and max(each.note.step for each in fast) > max(each.note.step for each in slow)


def test_listening_changes_no_bit_of_a_run():
    level = load_level("jelly_pile")

    def drop(session):
        if session.tick == 5:
            session.submit(AddParticle((0.0, 5.0), mass=5.0, radius=0.2))

    _, heard_hashes = hear(level, 40, drop)
    session = Session(level)
    for expected in heard_hashes:
        drop(session)
        session.advance()
        assert state_hash(session.world) == expected


def play_all(bank, frames, make):
    """Voices that are given what make(frame) says; the mixdown."""
    out = Mixdown()
    voices = Voices(out, bank)
    for frame in range(frames):
        voices.play(make(frame), out.now)
        assert voices.count <= VOICES and voices.total(out.now) <= 1.0 + 1e-9
        out.advance(FRAME)
    return out, voices


def test_a_crowd_of_loud_sounds_takes_a_dozen_voices_and_never_clips(bank):
    notes = [Note("thud", step, "metal") for step in range(26)] + [Note("pluck", step) for step in range(5, 20)]
    sources = itertools.count()
    out, _ = play_all(bank, 60, lambda k: [Cue(notes[(7 * k + j) % 41], 1.0, 0.0, next(sources)) for j in range(6)])
    assert VOICES - SPARE <= out.most <= VOICES
    assert 0.5 < np.abs(out.mixed).max() <= 1.0
    # A voice that makes room for another fades: nothing jumps by more than the loudest waves do themselves.
    assert np.abs(np.diff(out.mixed, axis=0)).max() < 0.6


def test_a_thing_that_rattles_does_not_drone(bank):
    note = Note("thud", 10, "wood")
    out, _ = play_all(bank, 60, lambda k: [Cue(note, 0.5, 0.0, 7)] * 3)
    assert 5 <= len(out.played) <= 12


def test_sounds_come_from_where_they_are(bank):
    out, _ = play_all(bank, 1, lambda k: [Cue(Note("thud", 12, "wood"), 0.5, -1.0, 1)])
    (_, _, (left, right)) = out.played[0]
    assert left > 2.5 * right > 0.0


def test_motors_rise_and_fall_without_a_jump(bank):
    out = Mixdown()
    voices = Voices(out, bank)
    for frame in range(60):
        wanted = [Cue(Note("motor", 6 + frame // 10), 0.8, 0.0, 3)] if frame < 40 else []
        voices.hum(wanted, out.now)
        out.advance(FRAME)
    steepest = max(np.abs(np.diff(bank[Note("motor", step)].pcm / 32767.0)).max() for step in range(6, 10))
    assert np.abs(out.mixed).max() > 0.05
    assert np.abs(np.diff(out.mixed, axis=0)).max() < 2.0 * 0.25 * steepest
    assert np.abs(out.mixed[-2000:]).max() == 0.0


@pytest.fixture
def heard_app(open_app):
    driver = open_app(small_level(**FALLING))
    driver.app.sounds.device.wait()
    yield driver
    driver.app.sounds.close()


def test_the_app_plays_what_lands_and_m_turns_it_off(heard_app):
    driver, device = heard_app, heard_app.app.sounds.device
    assert device.is_open and pygame.mixer.get_init() is not None
    heard = False
    for _ in range(45):
        driver.frames()
        heard |= any(device.is_busy(channel) for channel in range(VOICES))
    assert heard
    driver.key(pygame.K_m)
    assert driver.app.chosen["sound"] == "off" and driver.playback.listener is None
    driver.key(pygame.K_m)
    driver.frames(1)
    assert driver.app.chosen["sound"] == "on" and driver.playback.listener is not None


def test_paused_and_covered_runs_are_quiet(heard_app):
    driver = heard_app
    driver.frames(1)
    assert driver.playback.listener is not None
    driver.playback.toggle_pause()
    driver.frames(1)
    assert driver.playback.listener is None and driver.app.sounds.voices.count <= VOICES
    driver.playback.toggle_pause()
    driver.app.act("help")
    driver.frames(1)
    assert driver.playback.listener is None


def test_a_device_that_is_lost_is_looked_for_again(heard_app):
    driver, device = heard_app, heard_app.app.sounds.device
    pygame.mixer.quit()
    driver.frames(60)
    assert not device.is_open
    driver.post(pygame.AUDIODEVICEREMOVED, which=0, iscapture=0)
    driver.frames(2)
    device.wait()
    assert device.is_open


def test_without_a_device_all_is_silent_and_nothing_is_said(monkeypatch, open_app):
    monkeypatch.setenv("SDL_AUDIODRIVER", "there is no such driver")
    driver = open_app(small_level(**FALLING))
    driver.app.sounds.device.wait()
    driver.frames(60)
    assert not driver.app.sounds.device.is_open
    assert not driver.notices and driver.app.sounds.voices.count == 0


def test_on_linux_no_device_is_looked_for_where_there_is_neither_a_card_nor_a_server(monkeypatch, tmp_path):
    monkeypatch.setattr("sandbox.app.sound.sounds.CARD", tmp_path / "card")
    monkeypatch.setattr("sys.platform", "linux")
    monkeypatch.setenv("XDG_RUNTIME_DIR", str(tmp_path))
    for name in ("SDL_AUDIODRIVER", "PULSE_SERVER"):
        monkeypatch.delenv(name, raising=False)
    assert not may_have_sound()
    (tmp_path / "pipewire-0").touch()
    assert may_have_sound()


def test_a_device_that_is_closed_does_nothing(bank):
    device = Device()
    note = Note("snap", 10)
    device.play(0, note, bank[note], (1.0, 1.0), False)
    assert not device.is_busy(0)
    sounds = Sounds(Chosen(), lambda: 0.0, device)
    sounds.update(None, True)
    sounds.close()


def test_headless_commands_load_no_sound(tmp_path):
    script = (
        "import sys\nfrom sandbox.cli import main\n"
        f"assert main(['render', 'rope', '--seconds', '0', '-o', r'{tmp_path / 'rope.png'}']) == 0\n"
        "import pygame\nassert pygame.mixer.get_init() is None\n"
        "assert not [name for name in sys.modules if name.startswith('sandbox.app.sound')]"
    )
    ended = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=False)
    assert ended.returncode == 0, ended.stderr
