import assert from 'node:assert/strict';
import test from 'node:test';
import { Refusal } from '../../../sandbox/page/web/commands.js';
import { areaOf, meshed, outlineOf } from '../../../sandbox/page/web/mesh.js';

const OUTLINES = 60;

/** Outlines as a hand draws them: more or less round, more or less rough. */
function* outlines() {
  let seed = 3;
  const chance = () => {
    seed = (seed * 1103515245 + 12345) % 2147483648;
    return seed / 2147483648;
  };
  for (let k = 0; k < OUTLINES; k++) {
    const count = 8 + Math.floor(30 * chance()), size = 0.1 + 2 * chance(), rough = 0.8 * chance();
    const stroke = Array.from({ length: count }, (_, n) => {
      const turn = (2 * Math.PI * n) / count, radius = size * (1 - rough * chance());
      return [3 + radius * Math.cos(turn), 2 + 0.4 * radius * Math.sin(turn)];
    });
    yield outlineOf(stroke, 0.03 * size);
  }
}

const doubled = ([ax, ay], [bx, by], [cx, cy]) => (bx - ax) * (cy - ay) - (by - ay) * (cx - ax);

test('an outline is filled with triangles that run counter-clockwise and have a spring along each side', () => {
  for (const outline of outlines()) {
    const { particles, springs, triangles } = meshed(outline), joined = new Set(springs.map((pair) => pair.join()));
    let filled = 0;
    for (const [a, b, c] of triangles) {
      const twice = doubled(particles[a], particles[b], particles[c]);
      assert.ok(twice > 0);
      filled += twice / 2;
      for (const side of [[a, b], [b, c], [c, a]]) assert.ok(joined.has(side.sort((one, other) => one - other).join()));
    }
    assert.ok(Math.abs(filled / areaOf(outline) - 1) < 0.05);
    assert.equal(joined.size, springs.length);
  }
});

test('an outline that crosses itself is refused in words', () => {
  assert.throws(() => outlineOf([[0, 0], [1, 1], [1, 0], [0, 1]], 0.01), Refusal);
});
