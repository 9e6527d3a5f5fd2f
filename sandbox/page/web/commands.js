// Commands: records read as the desktop reads them, with its words, by the table that it makes of its commands.
/** @import { About, Command, Counts, Field, Kind, NameKind, NamedRecord } from './types.js' */
/** @import { World } from './world.js' */

/** @typedef {'minimum' | 'exclusiveMinimum' | 'maximum' | 'exclusiveMaximum'} Limit */
/** @typedef {{ names: NameKind, noun?: string }} Named */
/** @typedef {(string | number)[]} Place */
/** @typedef {[place: Place, words: string]} Fault */
/** @typedef {Omit<Kind, 'slots' | 'numbers'> & { slots: number[], numbers: number[] }} Packed */

// What a person is to read, in one line.
export class Refusal extends Error {
  /** The nearest sag that a body can have, of one that it cannot.
   * @type {number | undefined} */
  nearest;
}

const PLAIN = /^\w+$/, UNPRINTABLE = /[\p{C}\p{Zl}\p{Zp}]|(?! )\p{Zs}/u, SHOWN = 60, PLACE = 80;
// Beyond this JSON writes whole numbers as floats.
const WHOLE = 1e21;
/** @type {Record<Limit, (value: number, limit: number) => boolean>} */
const LIMITS = {
  minimum: (value, limit) => value >= limit, exclusiveMinimum: (value, limit) => value > limit,
  maximum: (value, limit) => value <= limit, exclusiveMaximum: (value, limit) => value < limit,
};
/** The rows that have the names of a kind, where they are called otherwise.
 * @type {(kind: NameKind) => keyof Counts} */
const countedBy = (kind) => (kind === 'part' ? 'actuator' : /** @type {keyof Counts} */ (kind));

/** @type {(message: string, ...values: unknown[]) => string} */
const fill = (message, ...values) => message.replace(/\{\}/g, () => String(values.shift()));
/** A number to so many digits, as Python's g has it.
 * @type {(value: number, count: number) => string} */
function digits(value, count) {
  const [, power] = value.toExponential(count - 1).split('e'), [short, after] = Number(value.toPrecision(count))
    .toExponential().split('e');
  if (Number(power) >= -4 && Number(power) < count) return String(Number(value.toPrecision(count)));
  return `${short}e${after[0]}${after.slice(1).padStart(2, '0')}`;
}
/** As JSON would keep it: a copy, without -0.
 * @type {(value: unknown) => unknown} */
const plain = (value) => (Array.isArray(value) ? value.map(plain) : typeof value === 'number' ? value + 0 : value);

/** A text in quotes, cut short, as messages of the desktop have it.
 * @type {(text: string) => string} */
function shown(text) {
  let quoted = JSON.stringify(text);
  if (UNPRINTABLE.test(quoted)) {
    quoted = quoted.replace(/[^ -~]/g, (unit) => `\\u${unit.charCodeAt(0).toString(16).padStart(4, '0')}`);
  }
  const letters = [...quoted];
  return letters.length <= SHOWN ? quoted : `${letters.slice(0, SHOWN - 4).join('')}..."`;
}

/** @type {(parts: (string | number)[]) => string} */
const placed = (parts) => [...parts.map((part) => (PLAIN.test(String(part)) ? part : shown(String(part)))).join('.')]
  .slice(0, PLACE).join('');

export class Commands {
  #about;
  #names;
  #second;

  /** about: what Python says, see start.py; names and second: of the rows there are, which may grow.
   * @param {About} about @param {Record<NameKind, string[]>} names @param {About['second']} second */
  constructor(about, names, second) {
    this.#about = about;
    this.#names = names;
    this.#second = second;
  }

  /** @type {(type: string) => [field: string, schema: Named][]} */
  #named(type) {
    const fields = Object.entries(this.#about.commands[type]?.fields ?? {});
    return fields.flatMap(([field, schema]) => {
      const { names, noun } = schema.items ?? schema;
      return names ? [[field, { names, noun }]] : [];
    });
  }

  /** The slot of a name. kind: particle, spring, part or material; counts: rows in use, by family.
   * @type {(schema: Named, name: unknown, counts: Counts) => number} */
  slot({ names: kind, noun = kind }, name, counts) {
    const { messages } = this.#about;
    if (typeof name !== 'string') throw new Refusal(fill(messages.noName, noun));
    const slot = this.find(kind, name, counts);
    if (slot < 0) throw new Refusal(fill(messages.noSlot, noun, shown(name)));
    return slot;
  }

  /** The same; -1: there is none.
   * @type {(kind: NameKind, name: string, counts: Counts) => number} */
  find(kind, name, counts) {
    const first = this.#names[kind].indexOf(name), others = this.#second[kind] ?? {};
    const slot = first < 0 && Object.hasOwn(others, name) ? others[name] : first;
    return slot < (kind === 'form' ? this.#names.form.length : counts[countedBy(kind)]) ? slot : -1;
  }

  /** A record as files have it, with slots in place of names, and defaults.
   * @type {(record: unknown, counts: Counts) => Command} */
  read(record, counts) {
    const { messages, commands } = this.#about, types = Object.keys(commands);
    const type = typeof record === 'object' && record && 'type' in record ? record.type : null;
    if (typeof record !== 'object' || !record || typeof type !== 'string') throw new Refusal(messages.noCommand);
    if (!types.includes(type)) throw new Refusal(fill(messages.unknown, shown(type), types.join(', ')));
    const entry = commands[type];
    // A world reads a kit when it lets it join.
    if (type === 'add_body') return /** @type {Command} */ (record);
    if (!entry) {
      throw new Refusal(`a page cannot do ${type}; it can do ${types.filter((each) => commands[each]).join(', ')}`);
    }
    const { fields } = entry;
    /** @type {Map<string, unknown>} */
    const given = new Map(Object.entries(record).filter(([name, value]) => name !== 'type' && value !== undefined));
    for (const [field, schema] of this.#named(type)) {
      const value = given.get(field), slot = (/** @type {unknown} */ name) => this.slot(schema, name, counts);
      if (value != null) given.set(field, Array.isArray(value) ? value.map(slot) : slot(value));
    }
    const fault = this.#faultOf(given, fields);
    if (fault) throw new Refusal(`${type}: ${placed(fault[0])}: ${fault[1]}`);
    const values = Object.entries(fields).map(([field, schema]) => [field, plain(given.get(field) ?? schema.default)]);
    return /** @type {Command} */ ({ type, ...Object.fromEntries(values.filter(([, value]) => value != null)) });
  }

  /** The first fault: where it is, and words for it.
   * @type {(given: Map<string, unknown>, fields: Record<string, Field>) => Fault | null} */
  #faultOf(given, fields) {
    const { messages } = this.#about;
    for (const [field, schema] of Object.entries(fields)) {
      const value = given.get(field);
      if (!given.has(field)) {
        if (schema.isRequired) return [[field], messages.missing];
      } else if (value !== null || !schema.isNullable) {
        const fault = this.#fault(value, schema, [field]);
        if (fault) return fault;
      }
    }
    const stranger = [...given.keys()].find((field) => !Object.hasOwn(fields, field));
    return stranger === undefined ? null : [[stranger], messages.unexpected];
  }

  /** @type {(value: unknown, schema: Field, parts: Place) => Fault | null} */
  #fault(value, schema, parts) {
    const { messages } = this.#about;
    if (schema.enum) return schema.enum.includes(value) ? null : [parts, fill(messages.choice, schema.expected)];
    if (schema.type === 'array') return this.#faultOfList(value, schema, parts);
    if (schema.type === 'string') return typeof value === 'string' ? null : [parts, messages.text];
    if (schema.type === 'boolean') return typeof value === 'boolean' ? null : [parts, messages.boolean];
    const isWhole = typeof value === 'number' && Number.isInteger(value) && Math.abs(value) < WHOLE;
    if (schema.type === 'integer' && !isWhole) {
      return [parts, schema.names ? messages.name : messages.integer];
    }
    if (typeof value !== 'number') return [parts, messages.number];
    if (!Number.isFinite(value)) return [parts, messages.finite];
    const limits = /** @type {Limit[]} */ (Object.keys(LIMITS));
    const broken = limits.find((key) => key in schema && !LIMITS[key](value, Number(schema[key])));
    return broken ? [parts, fill(messages[broken], schema[broken])] : null;
  }

  /** @type {(value: unknown, schema: Field, parts: Place) => Fault | null} */
  #faultOfList(value, { maxItems = Infinity, items, prefixItems = [] }, parts) {
    const { messages } = this.#about;
    if (!Array.isArray(value)) return [parts, messages.array];
    if (value.length > maxItems) return [parts, fill(messages.long, maxItems)];
    for (let k = 0; k < Math.max(value.length, prefixItems.length); k++) {
      const place = [...parts, k];
      /** @type {Fault | null} */
      const fault = k < value.length ? this.#fault(value[k], items ?? prefixItems[k], place)
        : [place, messages.missing];
      if (fault) return fault;
    }
    return null;
  }

  /** Whether a kernel beside `command` lets hands do it: throws in words where it does not. named: what its place is.
   * @type {(type: string, answer: number, named: (place: number) => string) => void} */
  check(type, answer, named) {
    const { size, reasons } = this.#about.denied;
    if (answer <= -size) throw new Refusal(this.#words(reasons[Math.floor(-answer / size)], type, named(-answer % size)));
  }

  /** Whether the level lets hands give a type of commands. refused: of each type, as state has it.
   * @type {(type: string, refused: ArrayLike<unknown>) => boolean} */
  lets(type, refused) {
    return !refused.length || !refused[this.#about.codeOf[type]];
  }

  /** Words for why a type of command is refused, of a name or number.
   * @type {(reason: number, type: string, name?: string | number, ...further: string[]) => string} */
  #words(reason, type, name = '', ...further) {
    const { refusals, filled, deeds } = this.#about, [doing, counted] = deeds[type] ?? ['', ''];
    const thing = String(name).split(':')[0].split('.')[0] || String(name);
    const what = { [filled.doing]: doing, [filled.counted]: counted, [filled.thing]: shown(thing) };
    return fill(refusals.words[reason], what[reason] ?? name, ...further);
  }

  /** What a kernel takes for a record with slots: its number, slots and numbers; and what has to be derived again.
   * @type {(record: Command, given: Record<string, number>) => Packed} */
  packed(record, given) {
    const { kinds, commands, choices, answers } = this.#about, kind = kinds[record.type], fields = commands[record.type]?.fields;
    const own = /** @type {Record<string, unknown>} */ (record);
    /** @type {(name: string) => number | number[]} */
    const value = (name) => {
      if (name.startsWith('?')) return Number(own[name.slice(1)] != null);
      if (answers[name]) return Array(answers[name]).fill(0);
      const found = given[name] ?? own[name] ?? fields?.[name]?.default ?? 0;
      return /** @type {number | number[]} */ (choices[name]?.[String(found)] ?? found);
    };
    const slots = kind.slots.flatMap((name) => value(name)).map(Number);
    return { ...kind, slots, numbers: kind.numbers.flatMap((name) => value(name)) };
  }

  /** A firmness that cannot be had, the rate, the nearest that can, and what is said after it, in words.
   * @type {(record: Command, nearest: Float64Array) => string[]} */
  #reach(record, [first, second]) {
    const { sag, hz, ratio } = /** @type {{ sag?: number, hz?: number, ratio?: number }} */ (record);
    /** @type {(sag?: number | null, hz?: number, ratio?: number | null) => string} */
    const said = (one, frequency, damping) => (one != null ? `sag ${digits(one, 3)}`
      : `${digits(Number(frequency), 4)} Hz${damping == null ? '' : ` at ratio ${digits(damping, 4)}`}`);
    const nearest = sag != null ? said(first) : said(null, first, second);
    return [said(sag, hz, ratio), digits(this.#about.rate, 6), nearest,
      sag != null && first ? this.#about.messages.butRigid : ''];
  }

  /** Whether a kernel has done nothing, since it needs more rows.
   * @type {(result: number) => boolean} */
  wantsRows(result) {
    const { reasons, noRows } = this.#about.refusals;
    return result < 0 && -result % reasons === noRows;
  }

  /** How many rows it needs, of what its numbers end with.
   * @type {(numbers: Float64Array) => Float64Array} */
  rowsIn(numbers) {
    return numbers.slice(-Number(this.#about.answers.rows));
  }

  /** Whether a kernel has done it: throws in words where it has not. answers: its numbers afterwards.
   * @type {(record: Command, packed: Packed, result: number, answers: Float64Array) => void} */
  answer(record, { slots, numbers }, result, answers) {
    if (result >= 0) return;
    const { refusals: { reasons, bad }, messages, kinds } = this.#about, { type } = record;
    const reason = -result % reasons, place = Math.floor(-result / reasons), names = this.#names;
    const { at } = /** @type {{ at?: number[] }} */ (record);
    if (place === slots.length && at?.length && at.length !== slots.length) {
      throw new Refusal(fill(messages.unequal, at.length, slots.length));
    }
    if (place >= slots.length) throw new Refusal(`${type}: ${numbers.join(', ')}: finite numbers are needed`);
    const fields = kinds[type].slots, field = fields[Math.min(place, fields.length - 1)], slot = slots[place];
    const { names: kind, noun } = new Map(this.#named(type)).get(field) ?? {}, name = kind && names[kind][slot];
    if (reason !== bad) {
      const further = reason === this.#about.filled.reach ? this.#reach(record, answers.slice(-2)) : [];
      const refusal = new Refusal(this.#words(reason, type, name ?? slot, ...further));
      if (further.length && 'sag' in record && record.sag != null) [refusal.nearest] = answers.slice(-2);
      throw refusal;
    }
    if (name !== undefined) throw new Refusal(fill(messages.noSlot, noun, shown(name)));
    throw new Refusal(`${type}: ${slot}: it is not there, not in use, or out of range`);
  }

  /** A record with slots as files have it: names in place of slots, and nothing that is left out.
   * @type {(record: Command) => NamedRecord} */
  named(record) {
    const names = this.#names, kinds = new Map(this.#named(record.type));
    /** @type {(field: string, value: unknown) => boolean} */
    const isSaid = (field, value) => value !== null && value !== undefined
      && (kinds.has(field) || !Array.isArray(value) || value.length > 0);
    const entries = Object.entries(record).filter(([field, value]) => isSaid(field, value));
    return { type: record.type, ...Object.fromEntries(entries.map(([field, value]) => {
      const kind = kinds.get(field)?.names;
      if (!kind) return [field, value];
      return [field, Array.isArray(value) ? value.map((slot) => names[kind][slot]) : names[kind][value]];
    })) };
  }
}
