// Files: a toy's file, which has the level and the image of its world, and the kernels that all toys share.
import { Refusal } from './commands.js';
import { World } from './world.js';

// Level and worlds of a toy's file, which begins with the length of what is JSON, and of the kernels' module.
export async function read(content, kernels) {
  const bytes = new Uint8Array(content), begin = 4;
  const end = begin + new DataView(content).getUint32(0, true), image = bytes.subarray(end);
  const level = JSON.parse(new TextDecoder().decode(bytes.subarray(begin, end)));
  const module = await kernels;
  return [level, () => new World(new WebAssembly.Instance(module, {}).exports, image, level.about)];
}

const modules = new Map();

async function fetched(address) {
  const answer = await fetch(address).catch(() => null);
  if (!answer?.ok) throw new Refusal(`There is no file ${address} here.`);
  return answer;
}

// The level and the worlds of files at addresses; kernels are fetched once for all toys of a page.
export async function load(address, kernels = new URL('kernels.wasm', import.meta.url)) {
  if (!globalThis.WebAssembly || !globalThis.DecompressionStream) throw new Refusal('This browser is too old for it.');
  const key = String(kernels);
  if (!modules.has(key)) modules.set(key, fetched(kernels).then((answer) => answer.arrayBuffer()).then(
    WebAssembly.compile));
  const file = await fetched(address);
  const content = await new Response(file.body.pipeThrough(new DecompressionStream('gzip'))).arrayBuffer().catch(
    () => { throw new Refusal(`${address} was cut off or damaged.`); });
  return read(content, modules.get(key));
}
