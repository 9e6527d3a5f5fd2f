// Toys for tests, as test_modules.py has written them: each call gives a level, and what makes fresh worlds of it.
import { readFileSync } from 'node:fs';
import { join } from 'node:path';
import { read } from '../../../sandbox/page/web/files.js';

export const FOLDER = process.env.SANDBOX_TOYS;
// What else it says: goldens there are, and what checks come to on the desktop.
export const GIVEN = JSON.parse(readFileSync(join(FOLDER, 'given.json'), 'utf8'));
const kernels = WebAssembly.compile(readFileSync(process.env.SANDBOX_KERNELS));

export function toy(name) {
  const bytes = readFileSync(join(FOLDER, name));
  return read(bytes.buffer.slice(bytes.byteOffset, bytes.byteOffset + bytes.byteLength), kernels);
}

// The hash of a world after so many more steps.
export function hashAfter(run, steps) {
  for (let k = 0; k < steps; k++) run.step();
  return run.world.hash().whole;
}
