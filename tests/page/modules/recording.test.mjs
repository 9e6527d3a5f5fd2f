import assert from 'node:assert/strict';
import { writeFileSync } from 'node:fs';
import { join } from 'node:path';
import test from 'node:test';
import { gunzipSync } from 'node:zlib';
import { blake2b } from '../../../sandbox/page/web/hash.js';
import { verified, written } from '../../../sandbox/page/web/recording.js';
import { Run } from '../../../sandbox/page/web/run.js';
import { FOLDER, GIVEN, hashAfter, toy } from './toys.mjs';

for (const name of GIVEN.goldens) {
  test(`every tick of ${name} has the bits of the desktop`, async () => {
    const [level, fresh] = await toy(name);
    assert.equal(await verified(fresh(), level.recording, () => {}), null);
  });
}

test('the first tick that differs is told', async () => {
  const [level, fresh] = await toy(GIVEN.goldens[0]);
  const { recording } = level;
  recording.hashes[17] = recording.hashes[16];
  assert.deepEqual(await verified(fresh(), recording, () => {}), { tick: 17, words: '' });
});

// test_modules.py verifies the file on the desktop.
test('a file has a line for each tick and command, chained, and ends with the whole hash', async () => {
  const [level, fresh] = await toy('rope'), run = new Run(fresh()), told = [];
  hashAfter(run, 50);
  run.command({ type: 'grab', grab: 0, particle: 20, target: [0.5, 1], strength: 80, radius: 0 }, run.newGesture());
  hashAfter(run, 20);
  run.command({ type: 'cut_springs', springs: [10] }, run.newGesture());
  const hash = hashAfter(run, 20);
  const file = await written(fresh(), level.about, level.header, run.commands, run.time, (tick) => told.push(tick));
  const bytes = new Uint8Array(await file.arrayBuffer());
  writeFileSync(join(FOLDER, 'written.replay.gz'), bytes);
  const lines = gunzipSync(bytes).toString().trimEnd().split('\n');
  let chain = '';
  for (const line of lines) {
    const at = line.lastIndexOf(', "chain"');
    chain = blake2b(new TextEncoder().encode(chain + line.slice(0, at)), 16);
    assert.equal(JSON.parse(line).chain, chain.slice(0, 8));
  }
  const read = lines.slice(1).map((line) => JSON.parse(line)), last = read.at(-1);
  assert.deepEqual(read.filter((line) => line.arrays).map((line) => line.tick), Array.from({ length: 91 }, (_, k) => k));
  assert.deepEqual(read.filter((line) => line.command).map((line) => [line.tick, line.command.type]),
    [[50, 'grab'], [70, 'cut_springs']]);
  assert.deepEqual([last.end, last.tick, last.hash], [true, 90, hash]);
  assert.deepEqual(told, Array.from({ length: 91 }, (_, k) => k));
});
