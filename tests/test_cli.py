import json
import os
import re
import signal
import subprocess
import sys
from contextlib import suppress
from pathlib import Path

import imageio_ffmpeg
import pytest
from PIL import Image, ImageSequence

from sandbox.cli import main
from sandbox.level.reading.files import shipped_folder
from tests.support.interrupts import interrupts

ROPE = {
    "format": "spring-sandbox/level", "version": 3, "name": "Short rope", "settings": {"solver": "iterative"},
    "bodies": [{"type": "rope", "id": "rope", "start": [0, 0], "end": [1, 0], "segments": 4, "pin": ["start"]}],
    "checks": [{"name": "stays up", "metric": "y", "particle": "rope.4", "after": 1.0, "at_least": -1.5}],
}  # fmt: skip


@pytest.fixture
def rope(tmp_path) -> str:
    path = tmp_path / "rope.json"
    path.write_text(json.dumps(ROPE))
    return str(path)


def _lines(capsys) -> tuple[list[str], list[str]]:
    captured = capsys.readouterr()
    return captured.out.splitlines(), captured.err.splitlines()


def test_run_prints_every_figure_as_json(rope, capsys):
    assert main(["run", rope, "--seconds", "2", "--json"]) == 0
    figures = json.loads(capsys.readouterr().out)
    assert list(figures) == [
        "level", "ticks", "simulated_seconds", "particles", "springs", "solver", "substeps", "max_strain", "rms_strain",
        "kinetic_energy", "potential_energy", "spring_energy", "gravity_energy", "dissipated_energy",
        "energy_tests", "steps_by_mass", "max_speed", "non_finite", "broken_springs", "hash",
        "outcome", "milliseconds_per_tick",
    ]  # fmt: skip
    assert (figures["ticks"], figures["particles"], figures["springs"]) == (120, 5, 4)
    assert figures["max_strain"] >= figures["rms_strain"] > 0.0
    # The rope's own solver has no energy test.
    assert figures["energy_tests"] == {
        "passed": 0, "solved_on": 0, "minimised": 0, "slowed_down": 0
    }  # fmt: skip


def test_run_gives_the_same_hash_every_time_and_another_for_other_settings(rope, capsys):
    hashes = []
    for extra in ([], [], ["--substeps", "2"], ["--solver", "single_pass"]):
        assert main(["run", rope, "--ticks", "50", "--json", *extra]) == 0
        hashes.append(json.loads(capsys.readouterr().out)["hash"])
    assert hashes[0] == hashes[1]
    assert len(set(hashes)) == 3


def test_a_run_whose_ticks_choose_their_substeps_says_so_and_its_recording_verifies(rope, tmp_path, capsys):
    replay = tmp_path / "auto.replay.jsonl"
    moves = tmp_path / "moves.jsonl"
    moves.write_text(
        '{"tick": 5, "gesture": 1, "command": {"type": "grab", "grab": 0, "particle": "rope.4", "target": [4, 4]}}\n'
        '{"tick": 20, "command": {"type": "set_solver", "substeps": 2}}\n'
        '{"tick": 40, "command": {"type": "set_solver", "substeps": "auto"}}\n'
    )
    command = ["run", rope, "--ticks", "130", "--substeps", "auto", "--commands", str(moves), "--record", str(replay)]
    assert main([*command, "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["substeps"] == "auto"
    assert '"substeps": "auto"' in replay.read_text()
    assert main(["replay", str(replay)]) == 0


def test_a_scripted_run_is_recorded_and_verifies(rope, tmp_path, capsys):
    moves, replay = tmp_path / "moves.jsonl", tmp_path / "run.replay.jsonl"
    moves.write_text(
        '{"tick": 5, "gesture": 1, "command": {"type": "grab", "grab": 0, "particle": "rope.4", "target": [1, 1]}}\n'
        '{"tick": 30, "gesture": 1, "command": {"type": "release", "grab": 0}}\n'
        '{"tick": 40, "command": {"type": "cut_springs", "springs": ["rope:2"]}}\n'
    )
    assert main(["run", rope, "--ticks", "60", "--commands", str(moves), "--record", str(replay), "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["broken_springs"] == 1
    assert main(["replay", str(replay)]) == 0
    assert _lines(capsys)[0] == [f"{replay}: equal, 60 ticks"]


def test_a_script_that_names_nothing_is_refused_with_its_line(rope, tmp_path, capsys):
    moves = tmp_path / "moves.jsonl"
    moves.write_text('{"tick": 5, "command": {"type": "pin", "particle": "rope.99"}}\n')
    assert main(["run", rope, "--ticks", "60", "--commands", str(moves)]) == 2
    out, err = _lines(capsys)
    assert out == []
    assert err == [f'{moves}: tick 5: line 1: there is no particle "rope.99"']


def test_commands_after_the_end_of_a_run_are_refused_and_one_at_its_end_is_carried_out(rope, tmp_path, capsys):
    moves = tmp_path / "moves.jsonl"
    cuts = [
        f'{{"tick": {tick}, "command": {{"type": "cut_springs", "springs": ["rope:{tick}"]}}}}\n' for tick in (3, 4, 7)
    ]
    moves.write_text("".join(cuts))
    assert main(["run", rope, "--ticks", "3", "--commands", str(moves)]) == 2
    line = f"{moves}: 2 commands are at ticks 4 to 7, but the run ends at tick 3; run it for longer with --ticks"
    assert _lines(capsys) == ([], [line])
    moves.write_text(cuts[0])
    assert main(["run", rope, "--ticks", "3", "--commands", str(moves), "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["broken_springs"] == 1


def test_a_spring_that_is_cut_twice_is_called_by_the_name_in_the_file(rope, tmp_path, capsys):
    moves = tmp_path / "moves.jsonl"
    line = '{"tick": 1, "command": {"type": "cut_springs", "springs": ["rope:3"]}}\n'
    moves.write_text(line + line.replace('"tick": 1', '"tick": 2'))
    assert main(["run", rope, "--ticks", "3", "--commands", str(moves)]) == 2
    assert _lines(capsys)[1] == [f'{moves}: tick 2: line 2: there is no spring "rope:3"']


def test_a_probe_of_nothing_lists_names_that_are_near(rope, tmp_path, capsys):
    assert main(["run", rope, "--ticks", "1", "--probe", "rpoe.4", "-o", str(tmp_path / "out.csv")]) == 2
    (line,) = _lines(capsys)[1]
    assert line.startswith("--probe: there is no particle 'rpoe.4'; near names: rope.4, rope.")
    assert main(["run", rope, "--ticks", "1", "--probe", "moon", "-o", str(tmp_path / "out.csv")]) == 2
    assert _lines(capsys)[1] == ["--probe: there is no particle 'moon'"]


def test_probe_and_dump_write_what_happened(rope, tmp_path, capsys):
    table, last = tmp_path / "out.csv", tmp_path / "last.json"
    arguments = ["--probe", "rope.4, rope.0", "--every", "10", "-o", str(table), "--dump", str(last)]
    assert main(["run", rope, "--ticks", "30", *arguments]) == 0
    rows = [line.split(",") for line in table.read_text().splitlines()]
    assert rows[0] == ["tick", "seconds", *(f"rope.{k}.{c}" for k in (4, 0) for c in ("x", "y", "vx", "vy"))]
    assert [row[0] for row in rows[1:]] == ["0", "10", "20", "30"]
    dumped = json.loads(last.read_text())
    assert dumped["tick"] == 30
    assert set(dumped["particles"]) == {f"rope.{k}" for k in range(5)}
    assert [repr(value) for value in dumped["particles"]["rope.4"]["position"]] == rows[-1][2:4]


def test_probe_and_dump_say_what_motors_give(tmp_path, capsys):
    table, last = tmp_path / "out.csv", tmp_path / "last.json"
    arguments = ["--probe", "rear wheel, car.0", "-o", str(table), "--dump", str(last)]
    assert main(["run", "truck_bridge", "--ticks", "2", *(text.replace("car", "truck") for text in arguments)]) == 0
    rows = [line.split(",") for line in table.read_text().splitlines()]
    assert rows[0][2:5] == ["rear wheel.torque", "rear wheel.share", "truck.0.x"]
    # The truck starts from rest: its motors give all they have, clockwise.
    assert [float(text) for text in rows[-1][2:4]] == [pytest.approx(-900.0), pytest.approx(1.0)]
    assert json.loads(last.read_text())["motors"]["front wheel"]["share"] == pytest.approx(1.0)


def test_probe_and_dump_say_how_discs_turn(tmp_path, capsys):
    table, last = tmp_path / "out.csv", tmp_path / "last.json"
    assert main(["run", "hourglass", "--ticks", "60", "--probe", "grain 6", "-o", str(table), "--dump", str(last)]) == 0
    rows = [line.split(",") for line in table.read_text().splitlines()]
    assert rows[0][2:] == [f"grain 6.{quantity}" for quantity in ("x", "y", "vx", "vy", "angle", "spin")]
    grain = json.loads(last.read_text())["particles"]["grain 6"]
    assert [float(text) for text in rows[-1][6:]] == [grain["angle"], grain["spin"]] and grain["angle"] != 0.0


def test_replay_tells_equal_refused_and_diverged_apart(rope, tmp_path, capsys, monkeypatch):
    replay = tmp_path / "run.jsonl"
    main(["run", rope, "--ticks", "70", "--record", str(replay)])
    capsys.readouterr()
    broken = tmp_path / "broken.jsonl"
    broken.write_bytes(replay.read_bytes().replace(b'"tick": 33', b'"tick": 34', 1))
    assert main(["replay", str(replay), str(broken)]) == 2
    out, err = _lines(capsys)
    assert (len(out), len(err)) == (1, 1)
    assert "broken.jsonl: line " in err[0]
    monkeypatch.setattr("sandbox.session.session.step", _wrong_step)
    assert main(["replay", str(replay), "--json"]) == 1
    outcome = json.loads(capsys.readouterr().out)
    assert (outcome["result"], outcome["tick"], outcome["array"]) == ("diverged", 41, "position")
    assert outcome["expected"] != outcome["actual"]
    assert "this build steps differently" in outcome["text"]


def _wrong_step(world):
    from sandbox.physics.step import step

    step(world)
    if world.tick == 41:
        world.position[2, 0] += 1e-12


def test_a_recording_runs_on_another_level(rope, tmp_path, capsys):
    replay = tmp_path / "run.jsonl"
    main(["run", rope, "--ticks", "20", "--record", str(replay)])
    assert main(["replay", str(replay), "--against", rope]) == 0
    longer = json.loads(Path(rope).read_text())
    longer["settings"] = {**longer.get("settings", {}), "gravity": [0, -3]}
    (tmp_path / "other.json").write_text(json.dumps(longer))
    capsys.readouterr()
    assert main(["replay", str(replay), "--against", str(tmp_path / "other.json")]) == 1
    assert "diverged at tick 0: settings" in _lines(capsys)[0][0]
    assert main(["replay", str(replay), "--against", "nowhere.json"]) == 2


def test_a_cut_off_replay_is_refused_unless_partial_is_asked_for(rope, tmp_path, capsys):
    replay = tmp_path / "run.jsonl"
    main(["run", rope, "--ticks", "20", "--record", str(replay)])
    replay.write_bytes(b"".join(replay.read_bytes().splitlines(keepends=True)[:-4]))
    capsys.readouterr()
    assert main(["replay", str(replay)]) == 2
    assert "cut off after tick 18; --partial verifies what is there" in _lines(capsys)[1][0]
    assert main(["replay", "--partial", str(replay)]) == 0


def test_check_passes_fails_and_refuses(rope, tmp_path, capsys):
    failing, refused = tmp_path / "failing.json", tmp_path / "refused.json"
    failing.write_text(json.dumps({**ROPE, "checks": [{**ROPE["checks"][0], "at_least": 5.0}]}))
    refused.write_text(json.dumps({**ROPE, "settings": {"tick_rate": 0, "iterations": 0}}))
    assert main(["check", rope]) == 0
    assert any("stays up: holds" in line for line in _lines(capsys)[0])
    assert main(["check", rope, str(failing)]) == 1
    capsys.readouterr()
    assert main(["check", rope, str(failing), str(refused)]) == 2
    err = _lines(capsys)[1]
    assert len(err) == 2
    assert all(line.startswith(f"{refused}: settings.") for line in err)


def test_format_is_idempotent_and_schema_is_a_schema(rope, capsys):
    assert main(["format", rope]) == 0
    once = Path(rope).read_bytes()
    assert main(["format", rope]) == 0
    assert Path(rope).read_bytes() == once
    assert main(["schema"]) == 0
    assert "properties" in json.loads(capsys.readouterr().out)


def test_render_draws_a_picture_of_the_size_asked_for(rope, tmp_path, capsys):
    picture = tmp_path / "out.png"
    assert main(["render", rope, "--seconds", "0.5", "--size", "320x200", "-o", str(picture)]) == 0
    assert capsys.readouterr().out.startswith(f"{picture}: 320x200, ")
    data = picture.read_bytes()
    assert data[:8] == b"\x89PNG\r\n\x1a\n"
    assert (int.from_bytes(data[16:20], "big"), int.from_bytes(data[20:24], "big")) == (320, 200)


@pytest.mark.parametrize(("kind", "size", "fps"), [("gif", (161, 91), 10), ("mp4", (160, 90), 12)])
def test_render_draws_a_film_of_the_length_size_and_rate_asked_for(kind, size, fps, rope, tmp_path, capsys):
    film = tmp_path / f"out.{kind}"
    options = ["--from", "0.5", "--seconds", "1", "--size", "161x91", "--fps", str(fps)]
    assert main(["render", rope, *options, "-o", str(film)]) == 0
    assert capsys.readouterr().out.startswith(f"{film}: {size[0]}x{size[1]}, 1 s of {fps} pictures a second, ")
    assert sorted(path.name for path in tmp_path.iterdir()) == [film.name, "rope.json"]
    if kind == "gif":
        with Image.open(film) as gif:
            frames = [frame.info["duration"] for frame in ImageSequence.Iterator(gif)]
            assert (gif.size, len(frames), sum(frames)) == (size, fps, 1000)
    else:
        assert imageio_ffmpeg.count_frames_and_secs(str(film)) == (fps, 1.0)
        assert next(imageio_ffmpeg.read_frames(str(film)))["source_size"] == size


def test_a_film_that_is_interrupted_leaves_no_file_and_the_one_before_as_it_was(rope, tmp_path, monkeypatch):
    film = tmp_path / "films" / "out.gif"
    film.parent.mkdir()
    film.write_bytes(b"before")
    monkeypatch.setattr("sandbox.app.share.gif.GifWriter.close", interrupt)
    assert main(["render", rope, "--seconds", "0.2", "--size", "64x36", "-o", str(film)]) == 130
    assert [(path, path.read_bytes()) for path in film.parent.iterdir()] == [(film, b"before")]


def interrupt(*_: object) -> None:
    raise KeyboardInterrupt


@pytest.mark.parametrize(("kind", "package"), [("gif", "Pillow"), ("mp4", "imageio-ffmpeg")])
def test_without_the_extra_a_film_is_a_line_that_says_what_to_install_and_a_picture_is_drawn(
    kind, package, rope, tmp_path, monkeypatch, capsys
):
    monkeypatch.setattr("importlib.util.find_spec", lambda name: None)
    assert main(["render", rope, "-o", str(tmp_path / f"x.{kind}")]) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert line.endswith(f'{kind.upper()} needs {package}: pip install "spring-sandbox[export]"')
    assert main(["render", rope, "-o", str(tmp_path / "x.png")]) == 0


@pytest.mark.parametrize(
    "arguments",
    [
        ["run", "nowhere.json"], ["run", "."], ["check", "nowhere.json"], ["replay", "nowhere.jsonl"], ["replay", "."],
        ["format", "nowhere.json"], ["run", "rope", "--solver", "magic"], ["run", "rope", "--substeps", "3"],
        ["run", "rope", "--probe", "rope.1"], ["run", "rope", "--probe", "x.1", "-o", "x.csv"],
        ["run", "rope", "--ticks", "1", "--dump", "/nowhere/x"], ["run", "rope", "--commands", "/nowhere/x"],
        ["run", "rope", "--record", "/nowhere/x"], ["render", "rope", "-o", "x.jpg"],
        ["render", "nowhere.json", "-o", "x.png"], ["render", "rope", "-o", "/nowhere/x.gif", "--seconds", "0.1"],
        ["render", "rope", "-o", "/nowhere/x.mp4", "--seconds", "0.1"], ["render", "rope", "-o", "x.png", "--fps", "9"],
        ["render", "rope", "-o", "x.png", "--from", "1"], ["render", "rope", "-o", "x.gif", "--fps", "55"],
        ["render", "rope", "-o", "x.mp4", "--seconds", "0"],
    ],
)  # fmt: skip
def test_refusals_are_single_lines_and_exit_2(arguments, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    assert main(arguments) == 2
    out, err = _lines(capsys)
    assert len(err) == 1, err
    assert out == []


@pytest.mark.parametrize("arguments", [["fly"],
                                       ["run"], ["run", "rope", "--seconds", "-1"], ["run", "rope", "--ticks", "0"],
                                       ["run", "rope", "--seconds", "nan"], ["run", "rope", "--size"],
                                       ["render", "rope", "--size", "0x9", "-o", "x.png"]])  # fmt: skip
def test_a_wrong_command_line_exits_2_with_its_usage(arguments, capsys):
    with pytest.raises(SystemExit) as leaving:
        main(arguments)
    assert leaving.value.code == 2
    assert "Traceback" not in capsys.readouterr().err


def test_twenty_bad_files_through_the_command_line(tmp_path):
    folder = tmp_path
    good = json.dumps(ROPE)
    texts = [
        "", "nonsense", "[]", "{}", "null", good[:-5], "\0\0", '{"format": "spring-sandbox/level"}',
        good.replace('"segments": 4', '"segments": true'), good.replace('"segments": 4', '"segments": 1000000000000'),
        good.replace('"segments": 4', '"segments": -1'), good.replace("[1, 0]", "[NaN, 0]"),
        good.replace("[1, 0]", "[1e999, 0]"), good.replace('"version": 3', '"version": 99'),
        good.replace('"type": "rope"', '"type": "robe"'), good.replace('"id": "rope"', '"id": ""'),
        "[" * 5000 + "]" * 5000, good.replace('"name"', '"name": "a", "name"', 1),
        good.replace('"settings": {', '"settings": {"solver": "magic", "x": '), "{" * 100,
    ]  # fmt: skip
    paths = []
    for number, text in enumerate(texts):
        paths.append(folder / f"bad{number}.json")
        paths[-1].write_text(text)
    assert len(paths) == 20
    command = [sys.executable, "-m", "sandbox", "check", *map(str, paths)]
    run = subprocess.run(command, capture_output=True, text=True, check=False)
    assert run.returncode == 2
    assert run.stdout == ""
    for path in paths:
        assert any(line.startswith(str(path)) for line in run.stderr.splitlines()), path
    assert "Traceback" not in run.stderr


def test_without_a_display_play_runs_headless_and_draws_a_picture(tmp_path):
    environment = {
        key: value for key, value in os.environ.items() if key not in ("DISPLAY", "WAYLAND_DISPLAY", "SDL_VIDEODRIVER")
    }
    command = [sys.executable, "-m", "sandbox", "play", str(shipped_folder("levels") / "rope.json")]
    path = str(Path(__file__).resolve().parents[1])
    run = subprocess.run(
        command, cwd=tmp_path, env={**environment, "PYTHONPATH": path}, capture_output=True, text=True, check=False
    )
    if sys.platform != "linux":
        pytest.skip("a desktop system always has a display")
    assert run.returncode == 0, run.stderr
    assert run.stdout.splitlines()[0].startswith("no display: playing")
    assert (tmp_path / "sandbox.png").stat().st_size > 1000


def _sandbox(arguments: list[str], **options) -> subprocess.CompletedProcess:
    environment = {**os.environ, "PYTHONPATH": str(Path(__file__).resolve().parents[1]), **options.pop("env", {})}
    command = [sys.executable, "-m", "sandbox", *arguments]
    return subprocess.run(command, env=environment, check=False, stderr=subprocess.PIPE, **options)


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="needs a device that is always full")
@pytest.mark.parametrize("output", [["--record"], ["--dump"], ["--probe", "rope.1", "-o"]])
def test_a_full_disk_is_told_in_one_line_with_the_file_that_is_full(rope, output, capsys):
    assert main(["run", rope, "--ticks", "3", *output, "/dev/full"]) == 2
    assert _lines(capsys)[1] == ["/dev/full: No space left on device"]


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="needs a device that is always full")
def test_a_standard_output_that_is_full_is_told_in_one_line(rope):
    with open("/dev/full", "w") as full:
        run = _sandbox(["run", rope, "--ticks", "3", "--json"], stdout=full)
    assert (run.returncode, run.stderr) == (2, b"standard output: No space left on device\n")


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="needs a device that is always full")
def test_a_standard_output_that_is_full_is_told_where_more_is_printed_than_a_buffer_holds():
    with open("/dev/full", "w") as full:
        run = _sandbox(["schema"], stdout=full)
    assert (run.returncode, run.stderr) == (2, b"standard output: No space left on device\n")


def test_an_error_without_a_file_is_not_blamed_on_standard_output(rope, monkeypatch, capsys):
    def refuse(*_):
        raise OSError(12, "Cannot allocate memory")

    monkeypatch.setattr("sandbox.session.summary.run", refuse)
    assert main(["run", rope]) == 2
    assert _lines(capsys) == ([], ["the system refuses: Cannot allocate memory"])


COMMANDS = {
    "play": ["rope"], "toy": [], "run": ["rope", "--ticks", "1"], "replay": ["x.jsonl"], "info": ["x.jsonl"],
    "resume": ["x.jsonl"], "show": ["x.jsonl"],
    "check": ["rope"], "diff": ["x.jsonl", "y.jsonl"], "bisect": ["x.json", "y.json"], "shrink": ["x.jsonl"],
    "sweep": ["rope", "--cs", "0.1:1:2", "-o", "x.csv"], "render": ["rope", "-o", "x.png"],
    "page": ["rope", "-o", "x.html"], "site": ["rope", "-o", "x"], "board": ["x"], "link": ["x.jsonl"],
    "open": ["#scene=A"], "take-home": ["rope"], "feel": ["girder"],
    "export": ["rope", "-o", "x.json"], "bring": ["x.svg", "-o", "x.json"], "format": ["x.json"],
    "edit": [], "schema": [],
}  # fmt: skip


def test_every_command_is_tried_in_a_folder_that_is_gone(capsys):
    with pytest.raises(SystemExit):
        main(["--help"])
    listed = capsys.readouterr().out.partition("COMMAND\n")[2]
    assert re.findall(r"^    ([\w-]+)", listed, re.MULTILINE) == list(COMMANDS)


@pytest.mark.skipif(os.name != "posix", reason="only there a folder in use can be removed")
@pytest.mark.parametrize("command", [None, *COMMANDS])
def test_a_start_in_a_folder_that_is_gone_is_refused_in_one_line(command, tmp_path, monkeypatch, capsys):
    gone = tmp_path / "gone"
    gone.mkdir()
    monkeypatch.chdir(gone)
    gone.rmdir()
    assert main([command, *COMMANDS[command]] if command else []) == 2
    out, err = _lines(capsys)
    assert out == []
    assert len(err) == 1 and err[0].startswith("the folder that this was started in cannot be used"), err


def test_a_recording_that_breaks_off_on_a_full_disk_is_told_and_the_run_goes_on(rope, tmp_path, capsys, monkeypatch):
    from sandbox.session.replay.recording import Recorder

    write = Recorder.write_tick

    def full(self, world):
        if world.tick == 2:
            raise OSError(28, "No space left on device")
        write(self, world)

    monkeypatch.setattr(Recorder, "write_tick", full)
    replay = tmp_path / "run.jsonl"
    assert main(["run", rope, "--ticks", "5", "--record", str(replay), "--json"]) == 2
    captured = capsys.readouterr()
    assert json.loads(captured.out)["ticks"] == 5
    assert captured.err == f"{replay}: recording stopped at tick 2: No space left on device\n"


def test_a_closed_standard_output_swallows_what_is_printed(rope):
    closed = {"preexec_fn": lambda: os.close(1)} if os.name == "posix" else {"stdout": subprocess.DEVNULL}
    run = _sandbox(["run", rope, "--ticks", "3"], **closed)
    assert (run.returncode, run.stderr) == (0, b"")


def test_names_that_a_terminal_cannot_say_are_spelled_out(tmp_path):
    path = tmp_path / "rö😀pe.json"
    path.write_text(json.dumps({**ROPE, "name": "Säil 😀"}), encoding="utf-8")
    run = _sandbox(["check", str(path)], env={"PYTHONIOENCODING": "ascii"}, stdout=subprocess.PIPE)
    assert run.returncode == 0, run.stderr
    assert b"S\\xe4il \\U0001f600" in run.stdout


def test_a_name_with_a_line_break_stays_on_one_line(capsys):
    assert main(["replay", "two\nlines"]) == 2
    assert _lines(capsys)[1] == ["two\\nlines: cannot be read: No such file or directory"]


@pytest.mark.parametrize(
    "options",
    [
        ["--record", "rope.json"], ["--dump", "./rope.json"],
        ["--commands", "a", "--dump", "a"], ["--record", "a", "--dump", "a"],
    ],
)  # fmt: skip
def test_nothing_that_is_read_is_written_over(rope, tmp_path, options, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "a").write_text("")
    before = Path(rope).read_bytes()
    assert main(["run", "rope.json", "--ticks", "3", *options]) == 2
    assert "is used twice" in _lines(capsys)[1][0]
    assert Path(rope).read_bytes() == before


def test_a_script_that_is_refused_leaves_no_recording_and_an_older_one_as_it_was(rope, tmp_path, capsys):
    script, replay = tmp_path / "moves.jsonl", tmp_path / "run.replay.gz"
    refused = ["run", rope, "--ticks", "30", "--commands", str(script), "--record", str(replay)]
    script.write_text('{"tick": 10, "command": {"type": "pin", "particle": "rpoe.2"}}')
    assert main(refused) == 2 and [path.name for path in tmp_path.glob("*replay*")] == []
    script.write_text('{"tick": 10, "command": {"type": "pin", "particle": "rope.2"}}')
    assert main([*refused]) == 0
    old = replay.read_bytes()
    script.write_text('{"tick": 20, "command": {"type": "pin", "particle": "rpoe.2"}}')
    assert main(refused) == 2 and replay.read_bytes() == old
    script.write_text('{"tick": 20, "command": {"type": "pin", "particle": "rope.2"}}')
    assert main(refused) == 0 and replay.read_bytes() != old
    assert main(["replay", str(replay)]) == 0
    assert [path.name for path in tmp_path.iterdir() if "replay" in path.name] == ["run.replay.gz"]


@pytest.mark.parametrize("suffix", ["jsonl", "gz"])
def test_an_interrupted_run_leaves_a_recording_that_is_only_cut_off(rope, tmp_path, suffix, monkeypatch, capsys):
    from sandbox.session.replay.recording import Recorder

    write, replay = Recorder.write_tick, tmp_path / f"run.{suffix}"

    def interrupted(self, world):
        if world.tick == 90:
            signal.raise_signal(signal.SIGINT)
        write(self, world)

    monkeypatch.setattr(Recorder, "write_tick", interrupted)
    with interrupts(signal.default_int_handler):
        assert main(["run", rope, "--ticks", "200", "--record", str(replay)]) == 130
        assert signal.getsignal(signal.SIGINT) is signal.default_int_handler
    out, err = _lines(capsys)
    assert out == []
    assert err == [f"{replay}: cut off at tick 90; `sandbox replay --partial` verifies it"]
    assert main(["replay", str(replay)]) == 2
    assert main(["replay", "--partial", str(replay)]) == 0
    assert "equal, 90 ticks" in capsys.readouterr().out


def test_a_run_that_was_started_with_interrupts_ignored_as_by_nohup_goes_on_to_its_end(rope, monkeypatch):
    from sandbox.session.session import Session

    advance = Session.advance
    monkeypatch.setattr(Session, "advance", lambda self: (signal.raise_signal(signal.SIGINT), advance(self)))
    with interrupts(signal.SIG_IGN):
        assert main(["run", rope, "--ticks", "3"]) == 0
        assert signal.getsignal(signal.SIGINT) is signal.SIG_IGN


def test_edit_without_a_display_is_refused_in_one_line(monkeypatch, capsys):
    monkeypatch.setattr("sandbox.app.base.display.has_display", lambda: False)
    assert main(["edit"]) == 2
    assert capsys.readouterr().err.count("\n") == 1


def test_edit_hands_the_level_on_to_the_app(monkeypatch, rope):
    asked = []
    monkeypatch.setattr("sandbox.app.base.display.has_display", lambda: True)
    monkeypatch.setattr("sandbox.app.window.opening.open_app", lambda find, **_: asked.append(find()) or 0)
    assert main(["edit", rope]) == 0
    assert main(["edit"]) == 0
    assert [wanted.edit for wanted in asked] == [rope, ""]


def test_play_opens_the_window_before_it_reads_what_was_asked_for(monkeypatch, rope):
    found = []
    monkeypatch.setattr("sandbox.app.base.display.has_display", lambda: True)
    monkeypatch.setattr("sandbox.app.window.opening.open_app", lambda find, **_: found.append(find()) or 0)
    assert main(["play", rope]) == main(["play", "rope"]) == main(["play"]) == 0
    of_file, shipped, nothing = found
    assert of_file.source == Path(rope) and shipped.source is None
    assert of_file.level.name != shipped.level.name == "Rope"
    assert nothing.level is nothing.replay is None
    assert main(["play", "no such level"]) == 2


@pytest.fixture
def three_levels(rope, tmp_path) -> list[str]:
    failing, refused = tmp_path / "failing.json", tmp_path / "refused.json"
    failing.write_text(json.dumps({**ROPE, "checks": [{**ROPE["checks"][0], "at_least": 5.0}]}))
    refused.write_text(json.dumps({**ROPE, "settings": {"tick_rate": 0}}))
    return [str(failing), str(refused), rope]


def test_levels_are_checked_in_processes_with_the_same_lines_in_the_same_order(three_levels, capfd):
    assert main(["check", *three_levels]) == 2
    alone = capfd.readouterr()
    assert main(["check", "--processes", "2", *three_levels]) == 2
    assert capfd.readouterr() == alone
    assert [line.partition(":")[0] for line in alone.out.splitlines() if "valid" in line] == three_levels[::2]
    assert alone.err.startswith(three_levels[1])


def test_checks_are_told_to_programs_as_an_object_a_level(three_levels, capfd):
    assert main(["check", "--json", *three_levels]) == 2
    told = capfd.readouterr()
    failed, refused, passed = (json.loads(line) for line in told.out.splitlines())
    assert told.err == ""
    assert [each["result"] for each in (failed, refused, passed)] == ["failed", "refused", "passed"]
    assert [each["file"] for each in (failed, refused, passed)] == three_levels
    assert refused["faults"][0].startswith(f"{three_levels[1]}: settings.tick_rate")
    (check,), (held,) = failed["checks"], passed["checks"]
    assert (check["name"], check["metric"], check["passed"], held["passed"]) == ("stays up", "y", False, True)
    assert check["value"] == held["value"] and check["value"] < 5.0 and check["at"] == pytest.approx(1.0)
    assert passed["level"] == ROPE["name"] and passed["stability"]["within_limit"] in (True, False, None)
    assert main(["check", "--json", "--processes", "2", *three_levels]) == 2
    again = capfd.readouterr()
    assert again.err == "" and _untimed(again.out) == _untimed(told.out) != told.out


def _untimed(text: str) -> str:
    return re.sub(r'"wall_seconds": [^,}]+', "", text)


def test_a_reader_that_goes_away_is_no_failure_and_no_traceback_in_any_command(rope, tmp_path):
    """As `sandbox ... | head -1`."""
    replay, recordings = tmp_path / "run.replay.gz", tmp_path / "many"
    assert main(["run", rope, "--ticks", "20", "--record", str(replay)]) == 0
    recordings.mkdir()
    for number in range(3):
        (recordings / f"{number}.replay.gz").write_bytes(replay.read_bytes())
    commands = [
        ["run", rope, "--ticks", "3"], ["run", rope, "--ticks", "3", "--json"], ["replay", str(replay)],
        ["replay", str(recordings)], ["replay", str(recordings), "--processes", "2", "--json"], ["check", rope],
        ["check", rope, rope, "--processes", "2", "--json"], ["diff", rope, "rope"], ["schema"],
    ]  # fmt: skip
    for command in commands:
        reader, writer = os.pipe()
        os.close(reader)
        ended = _sandbox(command, stdout=writer)
        os.close(writer)
        assert (ended.returncode, ended.stderr) == (141, b""), command
    reader, writer = os.pipe()
    os.close(reader)
    environment = {**os.environ, "PYTHONPATH": str(Path(__file__).resolve().parents[1])}
    ended = subprocess.run([sys.executable, "-m", "sandbox", "check", "nowhere.json"], env=environment, stderr=writer)
    os.close(writer)
    assert ended.returncode == 141


@pytest.mark.skipif(os.name != "posix", reason="sends an interrupt to a group of processes, as a terminal does")
def test_an_interrupt_of_checks_in_processes_ends_all_of_them_without_a_word(rope, tmp_path):
    endless = tmp_path / "endless.json"
    endless.write_text(json.dumps({**ROPE, "checks": [{**ROPE["checks"][0], "after": 3600.0}]}))
    command = [sys.executable, "-m", "sandbox", "check", "--processes", "2", rope, str(endless), str(endless)]
    root = str(Path(__file__).resolve().parents[1])
    environment = {**os.environ, "PYTHONPATH": root, "SANDBOX_KERNELS": "interpreted", "PYTHONUNBUFFERED": "1"}
    streams = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, "text": True}
    with interrupts(signal.default_int_handler):
        checking = subprocess.Popen(command, env=environment, start_new_session=True, **streams)
    with checking:
        assert checking.stdout is not None
        assert checking.stdout.readline().startswith(f"{rope}: valid")
        os.killpg(checking.pid, signal.SIGINT)
        try:
            # Whatever were left of the processes would hold the streams open.
            _, told = checking.communicate(timeout=60.0)
        finally:
            with suppress(ProcessLookupError):
                os.killpg(checking.pid, signal.SIGKILL)
    assert (checking.returncode, told) == (130, "")


@pytest.mark.parametrize("text", ["0", "-1", "two", "1000"])
def test_a_number_of_processes_that_nobody_can_mean_is_refused(text, capsys):
    with pytest.raises(SystemExit) as leaving:
        main(["check", "rope", "--processes", text])
    assert leaving.value.code == 2


HEADLESS = """
import sys
from sandbox.cli import main
code = main(sys.argv[1:])
from sandbox.physics import jit
print(*sorted(name for name in sys.modules if name.partition(".")[0] in ("sandbox", "pygame")), file=sys.stderr)
print(*(f"kernel:{kernel.name}" for kernel in jit.entries() if not isinstance(kernel.held, jit.Entry)), file=sys.stderr)
sys.exit(code)
"""


@pytest.mark.slow
def test_a_headless_run_loads_no_drawing_and_makes_only_the_kernels_that_it_calls(rope, tmp_path):
    def loaded(*arguments: str) -> set[str]:
        """Modules that a run has loaded, and the kernels that it has made."""
        environment = {
            **os.environ,
            "PYTHONPATH": str(Path(__file__).resolve().parents[1]),
            "SANDBOX_KERNELS": "interpreted",
        }
        command = [sys.executable, "-c", HEADLESS, *arguments]
        run = subprocess.run(command, env=environment, check=True, capture_output=True, text=True)
        return set(run.stderr.split())

    replay = str(tmp_path / "rope.jsonl")
    runs = [loaded("run", rope, "--ticks", "2", "--solver", name) for name in ("direct", "single_pass")]
    runs += [loaded("run", rope, "--ticks", "2", "--record", replay), loaded("replay", replay)]
    for modules in runs:
        assert not {name for name in modules if name.startswith(("pygame", "sandbox.app", "sandbox.editor"))}
        assert "sandbox.physics.jit.edited" not in modules
        made = {name for name in modules if name.startswith("kernel:")}
        assert "kernel:sandbox.physics.pipeline.tick.tick" in made
        assert not {name for name in made if any(word in name for word in ("find_broken", "lowest_mode"))}
