"""The article's loop: the largest Cs and Cd that are proven for a body, and programs of it in five languages.

A step of the loop with (Cs + 2 Cd) n_eff < 4 on every spring is stable (stability.py). That is per step: with n
substeps the same numbers hold in each of them, and n times as many steps make the body n^2 times as stiff. Ten ticks of
two particles are there to try one's own program against.
"""

import math
from dataclasses import dataclass
from string import Template

import numpy as np

from sandbox.export.engines import ChosenBody
from sandbox.export.numbers import exact, floored
from sandbox.physics.analysis.stability import BOUND
from sandbox.physics.equation import direction, frequency_from_coefficients, reduced_mass, spring_impulse
from sandbox.physics.softness.body_motion import BodyMotion
from sandbox.physics.softness.firmness import standing_form

Pair = tuple[float, float]

# Ticks of the trial.
TICKS = 10
# How the trial begins: stretched by a tenth, the second particle moving sideways [m/s].
STRETCHED = 1.1
SIDEWAYS = 1.0
# Substeps of a tick that are told of.
SUBSTEPS = (1, 2, 4, 8)


@dataclass(frozen=True)
class LoopPair:
    """Cs and Cd of one step of the loop, and what the body does with them.

    frequency [Hz] and damping_ratio: of its slowest wobble; of one spring alone where its form is not stiff.
    sag: the share of its height by which it sags where it stands, None where its form is not stiff. stretch: the share
    of its length by which one of its springs is stretched by the weight of the whole body.
    """

    stiffness: float
    damping: float
    frequency: float
    damping_ratio: float
    sag: float | None
    stretch: float


@dataclass(frozen=True)
class LoopRow:
    """Proven limits with some substeps of h [s] in a tick: the largest Cs = Cd, and the largest of the level's own
    ratio of Cs to Cd."""

    substeps: int
    h: float
    equal: LoopPair
    own: LoopPair


@dataclass(frozen=True)
class LoopTrial:
    """Two particles on one spring in the article's loop, a step of h [s] a tick, and where they are after each.

    inverse_mass [1/kg], 0 = pinned; rest_length [m]; gravity [m/s^2]; start [m] and velocity [m/s] of both particles;
    places (10, 2, 2) [m].
    """

    h: float
    stiffness: float
    damping: float
    rest_length: float
    gravity: Pair
    inverse_mass: Pair
    start: tuple[Pair, Pair]
    velocity: tuple[Pair, Pair]
    places: tuple[tuple[Pair, Pair], ...]


def loop_rows(body: ChosenBody) -> tuple[LoopRow, ...]:
    """Proven limits of a body with 1, 2, 4 and 8 substeps."""
    equal = own = largest_pair(1.0, 1.0, body.n_eff)
    if max(body.stiffness, body.damping) > 0.0:
        own = largest_pair(body.stiffness, body.damping, body.n_eff)
    rows = []
    for substeps in SUBSTEPS:
        h = body.tick / substeps
        rows.append(LoopRow(substeps, h, _loop_pair(body, *equal, h), _loop_pair(body, *own, h)))
    return tuple(rows)


def largest_pair(stiffness: float, damping: float, n_eff: float) -> tuple[float, float]:
    """The largest Cs and Cd in that ratio, of three digits, with (Cs + 2 Cd) n_eff < 4 and neither above 1."""
    scale = min(1.0 / max(stiffness, damping), BOUND / (n_eff * (stiffness + 2.0 * damping)))

    def proven(stiff: float, damp: float) -> bool:
        return max(stiff, damp) <= 1.0 and (stiff + 2.0 * damp) * n_eff < BOUND

    # The larger of the two first, as the other follows from it.
    if damping >= stiffness:
        ratio = stiffness / damping
        damp = floored(scale * damping, lambda c: proven(ratio * c, c))
        return floored(ratio * damp, lambda c: proven(c, damp)), damp
    ratio = damping / stiffness
    stiff = floored(scale * stiffness, lambda c: proven(c, ratio * c))
    return stiff, floored(ratio * stiff, lambda c: proven(stiff, c))


def _loop_pair(body: ChosenBody, stiffness: float, damping: float, h: float) -> LoopPair:
    # Of an eigenvalue a, the network is one spring of a Cs and a Cd (docs/physics.md, section 2).
    stretch = (
        body.weight * h * h / (stiffness * body.least_mass * body.least_length) if stiffness > 0.0 else float("inf")
    )
    if body.mode > 0.0:
        assert body.form is not None
        form = standing_form(body.world.forms[body.form].shape, body.world.settings.gravity)
        view = BodyMotion(body.mode, form, body.gravity, h, 1, "single_pass", 1)
        sag, motion = view.sag(np.array([stiffness]), np.array([damping])), view.motion(stiffness, damping)
        assert sag is not None
        return LoopPair(stiffness, damping, motion.hz, motion.ratio, float(sag[0]), stretch)
    hz, ratio = frequency_from_coefficients(stiffness, damping, h)
    return LoopPair(stiffness, damping, hz, ratio, None, stretch)


def loop_trial(body: ChosenBody, stiffness: float, damping: float) -> LoopTrial:
    """Ten ticks of the body's first spring, with its masses and length, at that Cs and Cd."""
    world, spring = body.world, int(body.springs[0])
    ends = int(world.particle_a[spring]), int(world.particle_b[spring])
    inverse_a, inverse_b = (float(world.inverse_mass[end]) for end in ends)
    length = float(world.rest_length[spring]) or 1.0
    x, y = world.settings.gravity
    start = (0.0, 0.0), (STRETCHED * length, 0.0)
    moving = SIDEWAYS if inverse_b > 0.0 else 0.0
    velocity = (0.0, 0.0 if moving else SIDEWAYS), (0.0, moving)
    trial = LoopTrial(
        body.tick, stiffness, damping, length, (x + 0.0, y + 0.0), (inverse_a, inverse_b), start, velocity, ()
    )  # fmt: skip
    return LoopTrial(**{**trial.__dict__, "places": _ticks(trial)})


def _ticks(trial: LoopTrial) -> tuple[tuple[Pair, Pair], ...]:
    place, velocity = [list(each) for each in trial.start], [list(each) for each in trial.velocity]
    inverse, h, found = trial.inverse_mass, trial.h, []
    for _ in range(TICKS):
        for p, weight in enumerate(inverse):
            if weight > 0.0:
                velocity[p] = [v + g * h for v, g in zip(velocity[p], trial.gravity, strict=True)]
        (dx, dy), (du, dv) = ([b - a for a, b in zip(*pair, strict=True)] for pair in (place, velocity))
        nx, ny, length = direction(dx, dy, du, dv)
        error, rate = length - trial.rest_length, nx * du + ny * dv
        j = spring_impulse(trial.stiffness, trial.damping, error, rate, reduced_mass(*inverse), h)
        for p, sign in enumerate((-1.0, 1.0)):
            velocity[p] = [v + sign * j * n * inverse[p] for v, n in zip(velocity[p], (nx, ny), strict=True)]
            place[p] = [x + v * h for x, v in zip(place[p], velocity[p], strict=True)]
        found.append(((place[0][0], place[0][1]), (place[1][0], place[1][1])))
    assert all(math.isfinite(value) for pair in found for point in pair for value in point)
    return tuple(found)


def listing(trial: LoopTrial, language: str) -> str:
    """A whole program of the trial, which prints `tick x y x y` [m] of both particles after each tick."""
    (ax, ay), (bx, by) = trial.start
    (au, av), (bu, bv) = trial.velocity
    values = {
        "h": trial.h, "cs": trial.stiffness, "cd": trial.damping, "rest": trial.rest_length, "gx": trial.gravity[0],
        "gy": trial.gravity[1], "wa": trial.inverse_mass[0], "wb": trial.inverse_mass[1], "ax": ax, "ay": ay, "bx": bx,
        "by": by, "au": au, "av": av, "bu": bu, "bv": bv,
    }  # fmt: skip
    return Template(LISTINGS[language].lstrip("\n")).substitute({name: exact(value) for name, value in values.items()})


def expected(trial: LoopTrial) -> list[str]:
    """The lines that the program prints, with all digits."""
    return [
        " ".join([str(tick), *(exact(value) for point in pair for value in point)])
        for tick, pair in enumerate(trial.places, 1)
    ]


PYTHON = """
h, cs, cd, gravity = $h, $cs, $cd, ($gx, $gy)
x, v = [[$ax, $ay], [$bx, $by]], [[$au, $av], [$bu, $bv]]  # [m], [m/s]
w, springs = [$wa, $wb], [(0, 1, $rest)]  # 1/mass, 0 = pinned; ends and rest length [m]
for tick in range(1, 11):
    v = [[c + (g * h if w[p] else 0.0) for c, g in zip(v[p], gravity)] for p in range(len(x))]
    impulse = [[0.0, 0.0] for _ in x]
    for a, b, rest in springs:
        d = [x[b][i] - x[a][i] for i in (0, 1)]
        length = (d[0] * d[0] + d[1] * d[1]) ** 0.5
        n = [d[0] / length, d[1] / length]
        u = sum(n[i] * (v[b][i] - v[a][i]) for i in (0, 1))
        j = -(cs * (length - rest) / h + cd * u) / (w[a] + w[b])  # 1 / (w + w) is the reduced mass
        for i in (0, 1):
            impulse[a][i] -= j * n[i]
            impulse[b][i] += j * n[i]
    for p in range(len(x)):
        v[p] = [v[p][i] + impulse[p][i] * w[p] for i in (0, 1)]
        x[p] = [x[p][i] + v[p][i] * h for i in (0, 1)]
    print(tick, *x[0], *x[1])
"""

JAVASCRIPT = """
const h = $h, cs = $cs, cd = $cd, gravity = [$gx, $gy];
const x = [[$ax, $ay], [$bx, $by]], v = [[$au, $av], [$bu, $bv]];  // [m], [m/s]
const w = [$wa, $wb], springs = [[0, 1, $rest]];  // 1/mass, 0 = pinned; ends and rest length [m]
for (let tick = 1; tick <= 10; tick++) {
  for (const p of x.keys()) if (w[p] > 0) for (const i of [0, 1]) v[p][i] += gravity[i] * h;
  const impulse = x.map(() => [0, 0]);
  for (const [a, b, rest] of springs) {
    const d = [x[b][0] - x[a][0], x[b][1] - x[a][1]], length = Math.sqrt(d[0] * d[0] + d[1] * d[1]);
    const n = [d[0] / length, d[1] / length];
    const u = n[0] * (v[b][0] - v[a][0]) + n[1] * (v[b][1] - v[a][1]);
    const j = -(cs * (length - rest) / h + cd * u) / (w[a] + w[b]);  // 1 / (w + w) is the reduced mass
    for (const i of [0, 1]) { impulse[a][i] -= j * n[i]; impulse[b][i] += j * n[i]; }
  }
  for (const p of x.keys()) for (const i of [0, 1]) { v[p][i] += impulse[p][i] * w[p]; x[p][i] += v[p][i] * h; }
  console.log(tick, ...x[0], ...x[1]);
}
"""

CPP = """
#include <cmath>
#include <cstdio>
struct Spring { int a, b; double rest; };
int main() {
  const double h = $h, cs = $cs, cd = $cd, gravity[2] = {$gx, $gy};
  double x[2][2] = {{$ax, $ay}, {$bx, $by}}, v[2][2] = {{$au, $av}, {$bu, $bv}};  // [m], [m/s]
  const double w[2] = {$wa, $wb};  // 1/mass, 0 = pinned
  const Spring springs[] = {{0, 1, $rest}};  // ends and rest length [m]
  for (int tick = 1; tick <= 10; tick++) {
    double impulse[2][2] = {};
    for (int p = 0; p < 2; p++) for (int i = 0; i < 2; i++) if (w[p] > 0) v[p][i] += gravity[i] * h;
    for (const Spring& s : springs) {
      const double dx = x[s.b][0] - x[s.a][0], dy = x[s.b][1] - x[s.a][1], length = std::sqrt(dx * dx + dy * dy);
      const double n[2] = {dx / length, dy / length};
      const double u = n[0] * (v[s.b][0] - v[s.a][0]) + n[1] * (v[s.b][1] - v[s.a][1]);
      const double j = -(cs * (length - s.rest) / h + cd * u) / (w[s.a] + w[s.b]);  // 1 / (w + w): reduced mass
      for (int i = 0; i < 2; i++) { impulse[s.a][i] -= j * n[i]; impulse[s.b][i] += j * n[i]; }
    }
    for (int p = 0; p < 2; p++) for (int i = 0; i < 2; i++) { v[p][i] += impulse[p][i] * w[p]; x[p][i] += v[p][i] * h; }
    std::printf("%d %.17g %.17g %.17g %.17g\\n", tick, x[0][0], x[0][1], x[1][0], x[1][1]);
  }
}
"""

CSHARP = """
using System;
static class Program {
  static void Main() {
    const double h = $h, cs = $cs, cd = $cd;
    double[] gravity = {$gx, $gy}, w = {$wa, $wb};  // w: 1/mass, 0 = pinned
    double[,] x = {{$ax, $ay}, {$bx, $by}}, v = {{$au, $av}, {$bu, $bv}};  // [m], [m/s]
    (int a, int b, double rest)[] springs = {(0, 1, $rest)};  // ends and rest length [m]
    for (int tick = 1; tick <= 10; tick++) {
      var impulse = new double[2, 2];
      for (int p = 0; p < 2; p++) for (int i = 0; i < 2; i++) if (w[p] > 0) v[p, i] += gravity[i] * h;
      foreach (var (a, b, rest) in springs) {
        double dx = x[b, 0] - x[a, 0], dy = x[b, 1] - x[a, 1], length = Math.Sqrt(dx * dx + dy * dy);
        double[] n = {dx / length, dy / length};
        double u = n[0] * (v[b, 0] - v[a, 0]) + n[1] * (v[b, 1] - v[a, 1]);
        double j = -(cs * (length - rest) / h + cd * u) / (w[a] + w[b]);  // 1 / (w + w) is the reduced mass
        for (int i = 0; i < 2; i++) { impulse[a, i] -= j * n[i]; impulse[b, i] += j * n[i]; }
      }
      for (int p = 0; p < 2; p++)
        for (int i = 0; i < 2; i++) { v[p, i] += impulse[p, i] * w[p]; x[p, i] += v[p, i] * h; }
      FormattableString line = $$"{tick} {x[0, 0]:R} {x[0, 1]:R} {x[1, 0]:R} {x[1, 1]:R}";
      Console.WriteLine(FormattableString.Invariant(line));
    }
  }
}
"""

GDSCRIPT = """
extends SceneTree  # godot --headless --script loop.gd; plain floats, as Vector2 has half the digits

func _init():
	var h = $h; var cs = $cs; var cd = $cd; var gravity = [$gx, $gy]
	var x = [[$ax, $ay], [$bx, $by]]; var v = [[$au, $av], [$bu, $bv]]  # [m], [m/s]
	var w = [$wa, $wb]; var springs = [[0, 1, $rest]]  # 1/mass, 0 = pinned; ends and rest length [m]
	for tick in range(1, 11):
		var impulse = []
		for p in x.size():
			impulse.append([0.0, 0.0])
			for i in 2: v[p][i] += gravity[i] * h if w[p] > 0.0 else 0.0
		for s in springs:
			var a = s[0]; var b = s[1]
			var d = [x[b][0] - x[a][0], x[b][1] - x[a][1]]
			var length = sqrt(d[0] * d[0] + d[1] * d[1])
			var n = [d[0] / length, d[1] / length]
			var u = n[0] * (v[b][0] - v[a][0]) + n[1] * (v[b][1] - v[a][1])
			var j = -(cs * (length - s[2]) / h + cd * u) / (w[a] + w[b])  # 1 / (w + w) is the reduced mass
			for i in 2:
				impulse[a][i] -= j * n[i]
				impulse[b][i] += j * n[i]
		for p in x.size():
			for i in 2:
				v[p][i] += impulse[p][i] * w[p]
				x[p][i] += v[p][i] * h
		print("%d %.15f %.15f %.15f %.15f" % [tick, x[0][0], x[0][1], x[1][0], x[1][1]])
	quit()
"""

# By their names in `--to`, in the order in which all of them are shown.
LISTINGS = {"csharp": CSHARP, "gdscript": GDSCRIPT, "cpp": CPP, "javascript": JAVASCRIPT, "python": PYTHON}
