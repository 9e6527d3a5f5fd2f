// Forms: bodies of a kit that may be stiff by their form, as rows behind those of a world (softness/kernels/firm.py).
/** @import { AnyArray, Counts, Kit, KitForm } from './types.js' */

/** Lists of a form: how many numbers a row has, the family that counts them, and where they lie; slots are counted on from
 * those that the world has of a family.
 * @type {[list: Exclude<keyof KitForm, 'body'>, width: number, family: keyof Counts, path: string, from?: keyof Counts][]} */
const LISTS = [['mass', 1, 'formPoint', 'forms.shapes.mass'], ['pairs', 2, 'formSpring', 'forms.shapes.pairs'],
  ['areas', 3, 'formArea', 'forms.shapes.areas'], ['bends', 3, 'formBend', 'forms.shapes.bends'],
  ['springs', 1, 'formSpring', 'forms.spring', 'spring'], ['constraints', 1, 'formConstraint', 'forms.constraint', 'constraint']];
// Columns of `first`, in their order.
const COUNTED = /** @type {const} */ (['formPoint', 'formSpring', 'formConstraint', 'formArea', 'formBend']);

/** How many rows there are once a kit has joined.
 * @type {(kit: Kit, before: Counts) => Partial<Counts>} */
export function formCounts({ forms = [] }, before) {
  /** @type {Partial<Counts>} */
  const found = { form: before.form + forms.length };
  for (const [list, width, family, , from] of LISTS) {
    if (list === 'springs' && from) continue;
    found[family] = forms.reduce((sum, form) => sum + form[list].length / width, before[family]);
  }
  return found;
}

/** Rows of a kit's forms: where, what, and from which number on.
 * @type {(kit: Kit, before: Counts) => [path: string, values: AnyArray, at: number][]} */
export function formRows({ forms = [] }, before) {
  /** @type {[string, AnyArray, number][]} */
  const found = [];
  const points = forms.flatMap(({ x, y }) => x.flatMap((value, k) => [value, y[k]]));
  found.push(['forms.shapes.points', Float64Array.from(points), 2 * before.formPoint]);
  for (const [list, width, family, path, from] of LISTS) {
    const values = forms.flatMap((form) => form[list]), more = from ? before[from] : 0;
    const array = list === 'mass' ? Float64Array.from(values) : BigInt64Array.from(values, (each) => BigInt(each + more));
    found.push([path, array, width * before[family]]);
  }
  const ends = COUNTED.map((family) => before[family]), first = forms.flatMap((form) => {
    [form.mass.length, form.springs.length, form.constraints.length, form.areas.length / 3, form.bends.length / 3].forEach(
      (count, k) => { ends[k] += count; });
    return [...ends];
  });
  found.push(['forms.first', BigInt64Array.from(first, BigInt), COUNTED.length * (before.form + 1)]);
  return found;
}

/** What the world calls bodies of a kit that have forms; first: the number of its first body.
 * @type {(kit: Kit, first: number) => string[]} */
export const formNames = ({ forms = [] }, first) => forms.map(({ body }) => `+${first + body}`);
