// Files: a toy's file, which has the level and the image of its world, and the kernels that all toys share; compressed.
import { Refusal } from './commands.js';
import { World } from './world.js';
/** @import { Fresh, Kernels, Level } from './types.js' */

/** Level and worlds of a toy's file, which begins with the length of what is JSON, and of the kernels' module.
 * @type {(content: ArrayBuffer, kernels: WebAssembly.Module | Promise<WebAssembly.Module>) => Promise<[Level,
 *   Fresh]>} */
export async function read(content, kernels) {
  const bytes = new Uint8Array(content), begin = 4;
  const end = begin + new DataView(content).getUint32(0, true), image = bytes.subarray(end);
  const level = JSON.parse(new TextDecoder().decode(bytes.subarray(begin, end)));
  const module = await kernels;
  const exports = () => /** @type {Kernels} */ (new WebAssembly.Instance(module, {}).exports);
  return [level, () => new World(exports(), image, level.about)];
}

// What did not come, or not whole: it may come when it is asked for again.
export class Lost extends Refusal {}

/** @type {Map<string, Promise<WebAssembly.Module>>} */
const modules = new Map();

/** @type {(address: string) => Promise<Response>} */
async function fetched(address) {
  const answer = await fetch(address).catch(() => null);
  if (!answer) throw new Lost(`${address} could not be fetched.`);
  if (!answer.ok) throw new Lost(`There is no file ${address} here.`);
  return answer;
}

/** The content of a compressed file; kernels may be plain WebAssembly, which begins with a zero.
 * @type {(address: string) => Promise<ArrayBuffer>} */
async function unpacked(address) {
  const file = await fetched(address);
  try {
    const blob = await file.blob(), [first] = new Uint8Array(await blob.slice(0, 1).arrayBuffer());
    if (first === 0) return await blob.arrayBuffer();
    return await new Response(blob.stream().pipeThrough(new DecompressionStream('gzip'))).arrayBuffer();
  } catch {
    throw new Lost(`${address} was cut off or damaged.`);
  }
}

/** The level and the worlds of files at addresses; kernels are fetched once for all toys of a page.
 * @type {(address: string, kernels?: string | URL) => Promise<[Level, Fresh]>} */
export async function load(address, kernels = new URL('kernels.wasm.gz', import.meta.url)) {
  if (!globalThis.WebAssembly || !globalThis.DecompressionStream) throw new Refusal('This browser is too old for it.');
  const key = String(kernels);
  const module = modules.get(key) ?? unpacked(key).then(WebAssembly.compile);
  modules.set(key, module);
  // What has failed is not kept.
  module.catch(() => modules.delete(key));
  return read(await unpacked(address), module);
}
