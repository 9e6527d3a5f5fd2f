// node web.mjs MODULE IMAGE BASE END SYMBOL...: make the calls of an image, as elsewhere.py wrote it, and compare memory
// and results.
import fs from 'node:fs';

const [, , moduleFile, imageFile, , end, ...symbols] = process.argv;
const PAGE = 65536, BLOCK = 3 << 20;
const [PATCH, CALL] = [0, 1];
const { exports } = await WebAssembly.instantiate(new WebAssembly.Module(fs.readFileSync(moduleFile)), {});
if (exports.__heap_base.value > BLOCK) throw new Error('the block of arguments lies in the module');
exports.memory.grow(Math.ceil(Number(end) / PAGE) + 1 - exports.memory.buffer.byteLength / PAGE);
const memory = Buffer.from(exports.memory.buffer), image = fs.readFileSync(imageFile);
let checks = 0, differing = 0, calls = 0;

function check(what, isEqual, place = () => '') {
  checks += 1;
  if (isEqual) return;
  differing += 1;
  if (differing <= 5) console.log(`${what} differs${place()}`);
}

// The call, where the first byte lies that differs, and the word of eight bytes about it: as wanted, and as it is here.
function place(where, content) {
  const at = content.findIndex((byte, k) => byte !== memory[where + k]);
  if (at < 0) return '';
  const word = (where + at) & ~7, wanted = Buffer.from(memory.subarray(word, word + 8));
  content.copy(wanted, Math.max(where - word, 0), Math.max(word - where, 0), Math.max(word - where, 0) + 8);
  const [there, here] = [wanted, memory.subarray(word, word + 8)].map((bytes) => bytes.toString('hex'));
  return `, call ${calls} at ${where + at}: ${there} ${here}`;
}

let last = '';
for (let at = 0; at < image.length;) {
  const kind = image.readUInt32LE(at), where = image.readUInt32LE(at + 4), size = image.readUInt32LE(at + 8);
  const content = image.subarray(at + 12, at + 12 + size);
  at += 12 + size;
  if (kind === PATCH) {
    content.copy(memory, where);
  } else if (kind === CALL) {
    last = symbols[where];
    calls += 1;
    const gives = content.readUInt32LE(0);
    content.copy(memory, BLOCK, 12);
    check(`the status of ${last}`, exports[last](BLOCK) === 0);
    const length = gives === 0 ? 0 : gives === 3 ? 1 : 8;
    check(`the result of ${last}`, content.compare(memory, BLOCK, BLOCK + length, 4, 4 + length) === 0);
  } else {
    check(`memory after ${last}`, content.compare(memory, where, where + size) === 0,
      () => place(where, content));
  }
}
console.log(`${checks} checks, ${differing} differ`);
