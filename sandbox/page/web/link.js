// Link: a run in the fragment of an address, which no browser sends to a server; written and read as
// session/replay/link.py does it.
import { Refusal } from './commands.js';
import { isWhole } from './kit.js';
import { packed } from './recording.js';
import { LINK } from './shared.js';
/** @import { Done, LevelLink, NamedRecord, PackedLink, Recording } from './types.js' */

const { MARK, BEAT, VERSION, LONGEST, UNPACKED_LIMIT, RUN_LIMIT, COMMAND_LIMIT, FARTHEST, PER_METRE, HANDS, MOVE } = LINK;
const COLUMNS = 4, ENTRY = 3, MOST_NAME = 60, FIELDS = ['v', 'physics', 'level', 'digest', 'ticks', 'at', 'hash', 'commands'];
const BROKEN = 'This link is broken: copy it again, whole.';

/** @typedef {{ places: Map<number, [number, number]>, gestures: Map<number, number> }} Held */
/** @typedef {{ passed: number, gesture: number, record: NamedRecord }} Entry */

/** @type {() => Held} */
const nobody = () => ({ places: new Map(), gestures: new Map() });
/** @type {(held: Held, gesture: number, record: NamedRecord) => void} */
const note = ({ gestures }, gesture, { type, grab }) => {
  if (type === 'grab' && isWhole(grab, 0, HANDS)) gestures.set(grab, gesture);
};

// A link to another level, which it names where that is a shipped one.
export class Elsewhere extends Refusal {
  /** @param {unknown} level @param {string} text */
  constructor(level, text) {
    super(text);
    this.level = level;
  }
}

/** Whether the fragment of an address holds a run.
 * @type {(fragment: string) => boolean} */
export const isLink = (fragment) => new RegExp(`^#(${BEAT}[^&]*&)?${MARK}`).test(fragment);

/** Whose run a link wants to be raced; null: it is to be watched.
 * @type {(fragment: string) => string | null} */
export function rivalOf(fragment) {
  if (!fragment.startsWith(`#${BEAT}`)) return null;
  let name = '';
  try {
    // What nobody sees may turn round what is beside it.
    name = decodeURIComponent(fragment.slice(BEAT.length + 1).split('&')[0]).replace(/\p{C}/gu, '').slice(0, MOST_NAME).trim();
  } catch { /* It is no name. */ }
  return name || 'Somebody';
}

/** A link by which a run is to be raced.
 * @type {(fragment: string) => string} */
export const raced = (fragment) => `#${BEAT}&${fragment.slice(1)}`;

/** The fragment of a link to a run; null: it would be too long. commands: with names in place of slots.
 * @type {(level: LevelLink, run: { commands: Entry[], ticks: number, at: number, hash: string }) =>
 *   Promise<string | null>} */
export async function linkOf({ level, digest, physics }, { commands, ticks, at, hash }) {
  const whole = { v: VERSION, physics, level, digest, ticks, at, hash, commands: shortened(commands) };
  const bytes = new TextEncoder().encode(JSON.stringify(whole));
  if (ticks > RUN_LIMIT || bytes.length > UNPACKED_LIMIT) return null;
  const letters = (await packed(bytes, 'deflate-raw')).replace(/\+/g, '-').replace(/\//g, '_').replace(/=+$/, '');
  return letters.length + MARK.length > LONGEST ? null : `#${MARK}${letters}`;
}

/** Commands as short lists, gestures counted from 1 on.
 * @type {(commands: Entry[]) => unknown[]} */
function shortened(commands) {
  /** @type {unknown[]} */
  const found = [];
  const held = nobody(), numbers = new Map();
  /** @type {number[][] | null} */
  let moves = null;
  for (const { passed, gesture, record } of commands) {
    if (!numbers.has(gesture)) numbers.set(gesture, numbers.size + 1);
    const number = numbers.get(gesture), place = moved(record, number, held);
    if (!place) {
      moves = null;
      found.push([passed, number, record]);
      note(held, number, record);
      continue;
    }
    if (!moves) found.push(moves = [[], [], [], []]);
    const hand = Number(record.grab), [x, y] = held.places.get(hand) ?? [0, 0];
    [passed, hand, place[0] - x, place[1] - y].forEach((value, k) => moves?.[k].push(value));
    held.places.set(hand, place);
  }
  return found;
}

/** Where a hand moves to [mm], where that is all that a record says.
 * @type {(record: NamedRecord, gesture: number, held: Held) => [number, number] | null} */
function moved({ type, grab, target, ...more }, gesture, { gestures }) {
  if (type !== MOVE || Object.keys(more).length || gestures.get(Number(grab)) !== gesture || !Array.isArray(target)) {
    return null;
  }
  // A -0 is no whole number.
  const [x, y] = target.map((each) => Math.round(each * PER_METRE) + 0);
  const isExact = [x, y].every((each, k) => Object.is(each / PER_METRE, target[k]) && Math.abs(each) <= FARTHEST);
  return isExact ? [x, y] : null;
}

/** What a fragment holds. Throws a Refusal.
 * @type {(fragment: string) => Promise<PackedLink>} */
async function unpacked(fragment) {
  const letters = fragment.slice(fragment.indexOf(MARK) + MARK.length);
  if (letters.length > LONGEST) throw new Refusal('This link is too long.');
  try {
    const text = atob(letters.replace(/-/g, '+').replace(/_/g, '/'));
    const bytes = Uint8Array.from(text, (letter) => letter.charCodeAt(0));
    const reader = new Blob([bytes]).stream().pipeThrough(new DecompressionStream('deflate-raw')).getReader();
    const decoder = new TextDecoder('utf-8', { fatal: true });
    let plain = '', size = 0;
    for (let part = await reader.read(); !part.done; part = await reader.read()) {
      size += part.value.length;
      if (size > UNPACKED_LIMIT) throw new Refusal('This link unpacks to too much.');
      plain += decoder.decode(part.value, { stream: true });
    }
    return JSON.parse(plain + decoder.decode());
  } catch (error) {
    throw error instanceof Refusal ? error : new Refusal(BROKEN);
  }
}

/** Commands one by one. Throws a Refusal.
 * @type {(given: unknown) => Generator<Entry>} */
function* entriesOf(given) {
  if (!Array.isArray(given)) throw new Refusal(BROKEN);
  const held = nobody();
  let count = 0;
  for (const entry of given) {
    if (!Array.isArray(entry)) throw new Refusal(BROKEN);
    const isMoves = entry.length === COLUMNS && entry.every(Array.isArray);
    for (const found of isMoves ? movesOf(entry, held) : [commandOf(entry, held)]) {
      count += 1;
      if (count > COMMAND_LIMIT) throw new Refusal('This link holds too many commands.');
      yield found;
    }
  }
}

/** @type {(entry: unknown[], held: Held) => Entry} */
function commandOf(entry, held) {
  const [passed, gesture, record] = entry;
  const isRecord = entry.length === ENTRY && typeof record === 'object' && record !== null && !Array.isArray(record);
  if (!isRecord || !isWhole(passed, 0, RUN_LIMIT) || !isWhole(gesture, 0, COMMAND_LIMIT)) throw new Refusal(BROKEN);
  const named = /** @type {NamedRecord} */ (record);
  note(held, gesture, named);
  return { passed, gesture, record: named };
}

/** @type {(columns: unknown[][], held: Held) => Generator<Entry>} */
function* movesOf([passes, hands, across, up], { places, gestures }) {
  if ([hands, across, up].some(({ length }) => length !== passes.length)) throw new Refusal(BROKEN);
  for (let k = 0; k < passes.length; k++) {
    const passed = passes[k], hand = hands[k], dx = across[k], dy = up[k];
    const isRight = isWhole(passed, 0, RUN_LIMIT) && isWhole(hand, 0, HANDS - 1) && isWhole(dx, -2 * FARTHEST, 2 * FARTHEST)
      && isWhole(dy, -2 * FARTHEST, 2 * FARTHEST);
    const gesture = isRight ? gestures.get(hand) : undefined;
    if (!isRight || gesture === undefined) throw new Refusal(BROKEN);
    const [x, y] = places.get(hand) ?? [0, 0];
    places.set(hand, [x + dx, y + dy]);
    yield { passed, gesture, record: { type: MOVE, grab: hand, target: [(x + dx) / PER_METRE, (y + dy) / PER_METRE] } };
  }
}

/** The run of a link to a level, and the tick at which it is shown. Throws a Refusal.
 * @type {(fragment: string, level: LevelLink) => Promise<[recording: Recording, at: number]>} */
export async function linked(fragment, { level, digest, physics }) {
  const link = await unpacked(fragment);
  if (typeof link !== 'object' || link === null || Array.isArray(link)) throw new Refusal(BROKEN);
  const { v, ticks, at = 0, hash } = link;
  if (Object.keys(link).some((field) => !FIELDS.includes(field))) throw new Refusal(BROKEN);
  if (v !== VERSION) throw new Refusal(`This link is of version ${shown(v)}; this page reads ${VERSION}.`);
  if (link.physics !== physics) throw new Refusal('This link was made with other physics, whose bits differ.');
  if (!isWhole(ticks, 0, RUN_LIMIT) || !isWhole(at, 0, ticks) || !/^[0-9a-f]{32}$/.test(String(hash))) {
    throw new Refusal(BROKEN);
  }
  if (link.digest !== digest || exactly(link.level) !== exactly(level)) {
    throw exactly(link.level) === exactly(level) ? new Refusal('This link is to another edition of this level.')
      : new Elsewhere(link.level, 'This link is to another level.');
  }
  /** @type {Done[]} */
  const commands = [];
  let tick = 0;
  for (const { passed, gesture, record } of entriesOf(link.commands)) {
    tick += passed;
    commands.push({ tick, gesture, named: record });
  }
  if (tick > ticks) throw new Refusal(BROKEN);
  /** @type {string[]} */
  const hashes = [];
  hashes.length = ticks + 1;
  return [{ commands, hashes, end: hash }, at];
}

/** A level as text, in which 0 and -0 differ.
 * @type {(level: unknown) => string} */
const exactly = (level) => JSON.stringify(level, (_, value) => (Object.is(value, -0) ? '-0' : value));

/** A version of a link that a person may read.
 * @type {(version: unknown) => string} */
const shown = (version) => (isWhole(version, 0, 1000) ? String(version) : 'none');
