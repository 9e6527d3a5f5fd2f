// Look: what people see of a kit, in its own slots: looked at before it is drawn, and moved to the slots of a world.
import { Refusal } from './commands.js';
/** @import { Joined } from './types.js' */

// A form of what is given: a name of a check, a list of one form or of several in order, or fields, of which those that
// end in ? may be left out.
/** @typedef {string | Form[] | { [field: string]: Form }} Form */
const MOST = 20000, FAR = 1000, NAME = /^[a-z]{0,20}( [a-z]{1,20})?$/, COLOUR = /^#[0-9a-f]{6}$/;
/** @type {Form} */
const LOOK = { skin: 'name', line: 'name', colour: 'colour', width: 'number' };
/** @type {Form} */
const SHAPE = { loops: [['particle']], look: ['colour', 'colour', 'number', 'colour', 'number', 'number', 'number', 'number'],
  line: 'colour or null', rounding: 'number', layer: 'number', grown: 'number', extra: 'number', keep: 'number',
  shows_strain: 'flag' };
/** @type {Record<string, Form>} */
const PARTS = {
  bodies: [{ ...LOOK, type: 'name', cell: 'number', angle: 'number', slots: [['particle', 'count']], spring: 'first',
    springs: 'count', segments: 'count or null', shapes: [SHAPE], needs: ['spring'], 'triangles?': ['particle'],
    'keeps_area?': 'flag', 'spacing?': 'number', 'spot?': ['number', 'number', 'number'], 'face?': 'flag',
    'knots?': ['particle'], 'wheel?': { hub: 'particle', radius: 'number', is_tyre: 'flag', inner: ['particle'],
      outer: ['particle'], spokes: ['particle'] }, 'picture?': 'file', 'is_fan?': 'flag' }],
  joins: [{ ...LOOK, spring: 'spring' }],
  balls: [{ slot: 'particle', kind: 'name', colour: 'colour or null' }],
};
// Slots that move along with the kit.
const SLOTS = ['particle', 'spring', 'first'];

/** @typedef {Record<string, number>} Rows */
/** @type {Record<string, (value: any, rows: Rows) => boolean>} */
const CHECKS = {
  name: (value) => typeof value === 'string' && NAME.test(value) && !(value in {}),
  file: (value) => typeof value === 'string' && value.length <= 256,
  colour: (value) => typeof value === 'string' && COLOUR.test(value),
  'colour or null': (value, rows) => value === null || CHECKS.colour(value, rows),
  number: (value) => typeof value === 'number' && Math.abs(value) <= FAR,
  flag: (value) => typeof value === 'boolean',
  count: (value) => Number.isInteger(value) && value >= 0 && value <= MOST,
  'count or null': (value, rows) => value === null || CHECKS.count(value, rows),
  particle: (value, { particles }) => Number.isInteger(value) && value >= 0 && value < particles,
  spring: (value, { springs }) => Number.isInteger(value) && value >= 0 && value < springs,
  first: (value, { springs }) => Number.isInteger(value) && value >= 0 && value <= springs,
};
/** @type {(form: Form[]) => boolean} */
const isOrdered = (form) => form.length > 1;

/** @type {(value: any, form: Form, rows: Rows) => boolean} */
function fits(value, form, rows) {
  if (typeof form === 'string') return CHECKS[form](value, rows);
  if (Array.isArray(form)) {
    if (!Array.isArray(value) || value.length > MOST || (isOrdered(form) && value.length !== form.length)) return false;
    return value.every((each, k) => fits(each, isOrdered(form) ? form[k] : form[0], rows));
  }
  if (typeof value !== 'object' || value === null || Array.isArray(value)) return false;
  const known = Object.keys(form).map((field) => field.replace('?', ''));
  return Object.keys(value).every((field) => known.includes(field)) && Object.entries(form).every(([field, each]) => {
    const name = field.replace('?', '');
    return Object.hasOwn(value, name) ? fits(value[name], each, rows) : field.endsWith('?');
  });
}

/** Throw a Refusal where a look does not fit the rows of its kit.
 * @type {(look: any, rows: Rows) => void} */
export function checkLook(look, rows) {
  const isTable = typeof look === 'object' && look !== null && !Array.isArray(look);
  const isRight = isTable && Object.entries(look).every(([part, things]) => Object.hasOwn(PARTS, part)
    && fits(things, PARTS[part], rows)) && (look.bodies ?? []).length <= rows.bodies
    && (look.bodies ?? []).every((/** @type {any} */ body) => body.spring + body.springs <= rows.springs
      && (body.triangles ?? []).length % 3 === 0 && body.slots.reduce((/** @type {number} */ sum,
        /** @type {[number, number]} */ [first, count]) => (first + count <= rows.particles ? sum + count : Infinity), 0)
      <= rows.particles);
  if (!isRight) throw new Refusal('look: it does not fit');
}

/** @type {(value: any, form: Form, by: Record<string, number>) => any} */
function movedBy(value, form, by) {
  if (typeof form === 'string') return SLOTS.includes(form) ? value + by[form] : value;
  if (Array.isArray(form)) {
    return value.map((/** @type {any} */ each, /** @type {number} */ k) => movedBy(each, isOrdered(form) ? form[k] : form[0], by));
  }
  const forms = Object.fromEntries(Object.entries(form).map(([field, each]) => [field.replace('?', ''), each]));
  return Object.fromEntries(Object.entries(value).map(([field, each]) => [field, movedBy(each, forms[field], by)]));
}

/** A look in the slots of a world, whose first particle and spring of the kit these are.
 * @type {(look: any, particle: number, spring: number) => Joined} */
export function moved(look, particle, spring) {
  const by = { particle, spring, first: spring };
  return Object.fromEntries(Object.entries(look).map(([part, things]) => [part, movedBy(things, PARTS[part], by)]));
}
