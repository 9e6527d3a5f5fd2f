import assert from 'node:assert/strict';
import test from 'node:test';
import { deflateRawSync, inflateRawSync } from 'node:zlib';
import { Refusal } from '../../../sandbox/page/web/commands.js';
import { linked, linkOf } from '../../../sandbox/page/web/link.js';
import { bodyKit } from '../../../sandbox/page/web/made.js';
import { verified } from '../../../sandbox/page/web/recording.js';
import { Run } from '../../../sandbox/page/web/run.js';
import { hashAfter, toy } from './toys.mjs';

const MUTATIONS = 600, MARK = '#scene=';
const ODD = [null, -1, 1e9, 'x', [], {}, true, 0.5, 2 ** 40, '__proto__', 1e308];
const body = { particles: [[0, 3], [0.5, 3], [0.2, 3.4]], springs: [[0, 1], [0, 2], [1, 2]], triangles: [[0, 1, 2]],
  material: 'drawn jelly', look: { skin: 'jelly' }, stiffness: 0.75, damping: 0.7, mass: 1, radius: 0.05 };

/** A link to a run with a drag and with things that were made. */
async function made() {
  const [level, fresh] = await toy('rope'), run = new Run(fresh()), { world } = run;
  const give = (record, gesture = run.newGesture()) => run.command(world.commands.read(record, world.counts), gesture);
  give({ type: 'add_body', kit: bodyKit(level.about.adding, body) });
  give({ type: 'add_particle', position: [1, 4], radius: 0.1, pinned: true });
  give({ type: 'add_spring', particle_a: '+.0', particle_b: '+1.2', stiffness: 0.4 });
  hashAfter(run, 30);
  const gesture = run.newGesture();
  give({ type: 'grab', grab: 0, particle: '+1.0', target: [0.5, 2], strength: 80, radius: 0 }, gesture);
  for (let k = 1; k < 20; k++) {
    give({ type: 'move_grab', grab: 0, target: [0.5 + k / 100, 2] }, gesture);
    hashAfter(run, 1);
  }
  let tick = 0;
  const commands = run.commands.map((done) => {
    const passed = done.tick - tick;
    tick = done.tick;
    return { passed, gesture: done.gesture, record: world.commands.named(done.record) };
  });
  const fragment = await linkOf(level.link, { commands, ticks: run.time, at: 0, hash: world.hash().whole });
  return { level, fresh, fragment };
}

test('a run with things that were made comes back from its link to the bit', async () => {
  const { level, fresh, fragment } = await made();
  const [recording, at] = await linked(fragment, level.link);
  assert.equal(at, 0);
  assert.ok(fragment.length < 1200);
  assert.equal(await verified(fresh(), recording, () => {}), null);
  recording.end = '0'.repeat(32);
  assert.deepEqual(await verified(fresh(), recording, () => {}), { tick: 49, words: '' });
});

test('a link that was changed is refused in words, or is another run', async () => {
  const { level, fresh, fragment } = await made(), letters = fragment.slice(MARK.length);
  let seed = 7, refused = 0;
  const below = (most) => {
    seed = (seed * 1103515245 + 12345) % 2147483648;
    return Math.floor((most * seed) / 2147483648);
  };
  for (let k = 0; k < MUTATIONS; k++) {
    const values = JSON.parse(inflateRawSync(Buffer.from(letters, 'base64url'))), places = [];
    const walk = (each) => Object.keys(each).forEach((key) => {
      places.push([each, key]);
      if (typeof each[key] === 'object' && each[key] !== null) walk(each[key]);
    });
    walk(values);
    const [within, key] = places[below(places.length)];
    if (below(4)) within[key] = ODD[below(ODD.length)];
    else delete within[key];
    const changed = MARK + deflateRawSync(Buffer.from(JSON.stringify(values))).toString('base64url');
    try {
      const [{ commands }] = await linked(changed, level.link), run = new Run(fresh(), commands, 5);
      hashAfter(run, 5);
    } catch (error) {
      assert.ok(error instanceof Refusal, error.stack);
      refused += 1;
    }
  }
  assert.ok(refused > MUTATIONS / 4);
});
