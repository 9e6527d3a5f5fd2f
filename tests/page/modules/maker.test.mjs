import assert from 'node:assert/strict';
import test from 'node:test';
import { Refusal } from '../../../sandbox/page/web/commands.js';
import { filled, Maker } from '../../../sandbox/page/web/maker.js';
import { Run } from '../../../sandbox/page/web/run.js';
import { GIVEN, toy } from './toys.mjs';

const WITHIN = 0.3;

async function world() {
  const [, fresh] = await toy('rope');
  return fresh();
}

/** What a person is told who draws along places. */
async function told(places) {
  const said = [], maker = new Maker(new Run(await world()), { made: { stuffs: { jelly: {} } }, parts: [], catalogue: [] }, (text) => said.push(text));
  maker.begin(places[0], null);
  for (const place of places.slice(1)) maker.go(place, WITHIN);
  maker.end('jelly', places[0], null, WITHIN);
  return said;
}

test('a stroke gets the mesh that it gets on the desktop, to the bit, or the same words', async () => {
  const present = await world();
  let refused = 0;
  for (const { numbers, mesh, refusal } of GIVEN.strokes) {
    if (mesh) assert.deepEqual(filled(present, numbers), mesh);
    else assert.throws(() => filled(present, numbers), new Refusal(refusal));
    refused += mesh ? 0 : 1;
  }
  assert.ok(refused > 0 && refused < GIVEN.strokes.length / 2);
});

test('a figure of eight is told that it crosses itself, and a dot to be drawn larger', async () => {
  const { small, crosses } = GIVEN.refusals;
  const eight = Array.from({ length: 60 }, (_, k) => [Math.sin(k / 9.55), Math.sin(k / 4.775)]);
  assert.deepEqual(await told(eight), [crosses]);
  assert.deepEqual(await told([[0, 0], [0.01, 0], [0, 0.01]]), [small]);
});

test('meshing changes no bit of the world', async () => {
  const present = await world(), before = present.hash().whole;
  filled(present, GIVEN.strokes.find(({ mesh }) => mesh).numbers);
  assert.equal(present.hash().whole, before);
});
