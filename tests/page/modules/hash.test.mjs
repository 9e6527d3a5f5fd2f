import assert from 'node:assert/strict';
import { createHash } from 'node:crypto';
import test from 'node:test';
import { blake2b, hexOf } from '../../../sandbox/page/web/hash.js';

test('blake2b is that of node for every length around its blocks', () => {
  for (let size = 0; size < 400; size++) {
    const bytes = Uint8Array.from({ length: size }, (_, k) => 31 * k + size);
    assert.equal(blake2b(bytes, 64), createHash('blake2b512').update(bytes).digest('hex'), `${size} bytes`);
  }
});

test('a part of a larger array is hashed by itself', () => {
  const bytes = Uint8Array.from({ length: 300 }, (_, k) => k);
  assert.equal(blake2b(bytes.subarray(100, 250), 16), blake2b(bytes.slice(100, 250), 16));
});

test('floats have the digits of Python', () => {
  const said = { '0x1.999999999999ap-4': 0.1, '-0x1.39eb851eb851fp+3': -9.81, '0x1.0000000000000p+0': 1,
    '0x0.0p+0': -0, '0x0.0000000000001p-1022': 5e-324, '0x1.fffffffffffffp+1023': Number.MAX_VALUE };
  for (const [digits, value] of Object.entries(said)) assert.equal(hexOf(value), digits);
});
