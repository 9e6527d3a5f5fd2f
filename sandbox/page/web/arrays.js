// Arrays: typed arrays of a world's block.
/** @import { AnyArray } from './types.js' */

const ALIGNED = 16;
/** @type {Record<string, new (buffer: ArrayBuffer, offset: number, length: number) => AnyArray>} */
export const KINDS = {
  f8: Float64Array, f4: Float32Array, i8: BigInt64Array, u4: Uint32Array, i4: Int32Array, i1: Int8Array, b1: Uint8Array,
};

/** A size, or the next larger one at which an array may begin [bytes].
 * @type {(size: number) => number} */
export const aligned = (size) => Math.ceil(size / ALIGNED) * ALIGNED;

/** Write numbers into an array that holds such, from a place on.
 * @type {(array: AnyArray, values: AnyArray, at?: number) => void} */
export function put(array, values, at = 0) {
  // Both are of 64 bits and whole, or neither is.
  /** @type {Float64Array} */ (array).set(/** @type {Float64Array} */ (values), at);
}
