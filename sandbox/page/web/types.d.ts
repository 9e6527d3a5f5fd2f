// Types of what Python gives a page, and of what its modules give each other. Slots are numbers of rows of a world.
import type { Commands, StateArrays } from './tables.js';
import type { World } from './world.js';

export type Point = [x: number, y: number];
// Left, top, right and bottom; of places [m]: left, low, right and high.
export type Box = [number, number, number, number];
// Numbers in a row, whatever keeps them.
export type Numbers = ArrayLike<number> & Iterable<number>;
export type AnyArray = Float64Array | Float32Array | BigInt64Array | Uint32Array | Int32Array | Int8Array | Uint8Array;

// ---- A world: start.py

export type Family = 'particle' | 'spring' | 'constraint' | 'corner' | 'actuator' | 'hand' | 'setting' | 'rule' | 'counter'
  | 'probe' | 'still' | 'key' | 'deed';
// Rows in use.
export type Counts = Record<Family | 'material' | 'muscle' | 'hydraulic' | 'motor' | 'rim' | 'hull' | 'limit' | 'breakable' | 'area'
  | 'form' | 'formPoint' | 'formSpring' | 'formConstraint' | 'formArea' | 'formBend', number>;
export type NameKind = 'particle' | 'spring' | 'material' | 'part' | 'key' | 'area' | 'form';

// A line of the table of state arrays.
export interface Column {
  stored: string;
  path: string;
  width: number;
  family: Family;
  isContact: boolean;
  isSparse: boolean;
  usual: number;
}

// A field of a command, or a part of it, as JSON Schema has it; limits in the digits that messages have.
export interface Field {
  type: string;
  names?: NameKind;
  noun?: string;
  isRequired?: boolean;
  isNullable?: boolean;
  default?: unknown;
  maxItems?: number;
  enum?: unknown[];
  expected?: string;
  items?: Field;
  prefixItems?: Field[];
  minimum?: string;
  exclusiveMinimum?: string;
  maximum?: string;
  exclusiveMaximum?: string;
}

export interface CommandEntry {
  fields: Record<string, Field>;
}

// What a kernel takes of a command.
export interface Kind {
  code: number;
  slots: string[];
  numbers: string[];
  changes: string;
}

export interface About {
  kernels: Record<string, string>;
  words: number;
  codes: Record<'FINISHED' | 'UNSOUND' | 'NO_ROOM' | 'LOST' | 'BROKE', number>;
  progress: Record<'TICK' | 'MAY_FLY' | 'COUNT' | 'DONE' | 'BROKEN' | 'CHECKED' | 'KEPT', number>;
  kinds: Record<string, Kind>;
  // What goes by words in commands, as kernels have it.
  choices: Partial<Record<string, Partial<Record<string, number>>>>;
  // Numbers that a kernel writes, and how many they are.
  answers: Partial<Record<string, number>>;
  givers: Record<'HAND' | 'RULE' | 'PROGRAM', number>;
  // How a result says why and where a command was refused, and words for it; and which of these words tell what.
  refusals: { reasons: number; words: Record<number, string>; bad: number; noRows: number };
  filled: Record<'doing' | 'counted' | 'thing' | 'reach', number>;
  // Of other kernels that refuse: by how much reasons are multiplied in their answers, and which of these words are theirs.
  denied: { size: number; reasons: Record<number, number> };
  // Ticks in a second.
  rate: number;
  // By types of commands what they do to things, and what a budget of them counts; and their numbers.
  deeds: Partial<Record<string, [doing: string, counted: string]>>;
  codeOf: Record<string, number>;
  messages: Record<string, string>;
  // null: pages do not carry it out.
  commands: Record<string, CommandEntry | null>;
  solvers: string[];
  hands: { particle: number; spring: number; count: number };
  area: number;
  columns: Column[];
  topology: string[];
  kept: string[];
  names: Record<NameKind, string[]>;
  // What each rule of the level does, in order.
  rules: Action[][];
  second: Partial<Record<NameKind, Record<string, number>>>;
  // By path: the type of its numbers, and how many dimensions it has.
  table: Record<string, ['f8' | 'f4' | 'i8' | 'u4' | 'i4' | 'i1' | 'b1', number]>;
  copies: [to: number, from: number, size: number][];
  counts: Counts;
  // By path of an array that has a row for each of a family: the family, and what new rows hold.
  plan: Record<'GRAB_PARTICLE' | 'GRAB_SPRING', number>;
  grows: Record<string, [family: keyof Counts, fill: number | string, more: number]>;
  kit: KitTable;
  adding: Adding;
}

// What a rule does: a text or a sound of it, a counter that changes, or commands with slots in place of names.
export interface Action {
  win?: string;
  fail?: string;
  say?: string;
  sound?: string;
  stars?: { counter: number | null; second: number; third: number };
  count?: number;
  by?: number;
  commands?: Command[];
  isCheckpoint?: boolean;
}

// How a run ended for who plays it: won with 1 to 3 stars, or lost with none, at the end of a tick.
export interface Outcome {
  isWon: boolean;
  text: string;
  stars: number;
  tick: number;
  rule: number;
}

// What the module of kernels exports.
export type Kernels = { memory: WebAssembly.Memory; __heap_base: WebAssembly.Global<'i32'> }
  & Record<string, (address: number) => number>;

// Arrays of a block by their paths.
export type Views = { [N in keyof StateArrays as `state.${N}`]: StateArrays[N] }
  & { [N in keyof StateArrays as `good.${N}`]: StateArrays[N] } & {
    numbers: Float64Array;
    choices: BigInt64Array;
    progress: BigInt64Array;
    plan: BigInt64Array;
    'limits.broken': BigInt64Array;
    'collisions.counts': BigInt64Array;
    'collisions.kept.particle': Int32Array;
    'collisions.kept.feature': BigInt64Array;
    'collisions.kept.impulse': Float64Array;
    'collisions.kept.impact': Float64Array;
  };
export type View<P extends string> = P extends keyof Views ? Views[P] : AnyArray;

export interface SavedState {
  time: number;
  counts: Counts;
  arrays: Map<string, AnyArray>;
  contacts: AnyArray[];
  joined: { scene: Joined; keys: Level['keys']; bodies: number }[];
  names: Record<NameKind, string[]>;
  second: Record<string, number>;
  hands: About['hands'];
}

// What a stroke is filled with: spacing [m], area [m^2]; places [m], triangles and their sides.
export interface Mesh {
  spacing: number;
  area: number;
  particles: Point[];
  springs: [number, number][];
  triangles: [number, number, number][];
}

export interface Settings {
  gravity: Point;
  tick_rate: number;
  substeps: number | 'auto';
  solver: string;
  iterations: number;
  warm_start: number;
  wind: Point;
  drag: number;
}

export interface StateHash {
  whole: string;
  arrays: Map<string, string>;
}

// ---- Commands and recordings: recorded.py

// A command with slots in place of names, by its type.
export type Command = Commands[keyof Commands];
// As files have it: with names.
export type NamedRecord = { type: string } & Record<string, unknown>;
// A command as a table of its fields.
export type Fields = { type: string } & Record<string, unknown>;

// Something done: a command with names, until it is carried out; one that was done here has slots alone.
export type Done = { tick: number; gesture: number; record?: Command; named: NamedRecord }
  | { tick: number; gesture: number; record: Command; named?: undefined };

export interface Recording {
  commands: Done[];
  hashes: string[];
  // Of a link: the hash at its end, after its last commands. It has no hashes of ticks.
  end?: string;
}

// What links say of a level: the name of a shipped one, or all of it; what it is known by; and of which physics.
export interface LevelLink {
  level: unknown;
  digest: string;
  physics: number;
}

// What a link holds, before it is looked at.
export type PackedLink = { v: unknown; ticks: unknown; at?: unknown; hash: string; commands: unknown } & LevelLink;

// ---- A level: playing.py

export interface Check {
  name: string;
  metric: string;
  from: number;
  to: number;
  particles?: number[];
  springs?: number[];
  box?: Box;
  is_eventual?: boolean;
  at_least?: number;
  at_most?: number;
}

export interface CheckResult {
  name: string;
  holds: boolean;
  value: number;
}

export interface SagMapData {
  lowest: number;
  rest: number;
  size: number;
  step: number;
  logs: number[];
  names: string[];
  edges: number[];
  places: Record<string, Point>;
}

// A material of the panel; slot null: all of them.
export interface MaterialRow {
  name: string;
  slot: number | null;
  is_first: boolean;
  words: Record<string, Point>;
  subject?: string;
  says?: { sag: string; flat: string; none: string; flat_from: number; none_below: number };
  map?: SagMapData;
}

export interface Stuff {
  modes: [ratio: number, decay: number, strength: number][];
  noise: number;
  cut: number;
  blow: number;
  glide: number;
}

export interface Motor {
  part: number;
  hub: number;
  rim: number[];
  speed: number;
}

export interface Sounds {
  bodies: { of: number[]; mass: number[]; pitch: number[]; weight: number[]; stuff: string[]; strand: boolean[] };
  stuffs: Record<string, Stuff>;
  motors: Motor[];
}

export interface Level {
  name: string;
  scene: Scene;
  sounds: Sounds;
  materials: MaterialRow[];
  gravity_limit: number;
  ramp_ticks: number;
  checks: Check[];
  goals: Goals;
  // What hands may not use: buttons, and parts of the panel.
  absent: string[];
  keys: Record<string, [part: number, value: number][]>;
  header: string;
  link: LevelLink;
  recording: Recording | null;
  // Who is raced.
  rival?: Rival;
  begin: number;
  about: About;
}

// A run that goes along, and whose it is.
export interface Rival {
  name: string;
  recording: Recording;
}

// A win by what it is ranked by: value: of what the level measures.
export interface Result {
  stars: number;
  tick: number;
  value: number;
}

// What a level asks, in a line; counters that are shown: place and name; whether time counts.
export interface Goals {
  goal: string;
  counters: [place: number, text: string][];
  hasClock: boolean;
  // What the second and the third star take, by the rules that win.
  stars: Record<number, string[]>;
  // The solution beside the level, and the fragment of a link to it.
  solved: { text: string, fragment: string } | null;
  // What ranks wins of as many stars: a counter, null: the time; whether more is better.
  measure: { counter: number | null; text: string; is_most: boolean };
}

// Gives a world of its own before the first tick.
export type Fresh = () => World;

// ---- A scene: scene.py

export interface Theme {
  name: 'dark' | 'light';
  stage: string[];
  lamp: string;
  vignette: number;
  shadow: string;
  shadow_strength: number;
  strain: string[];
  turf: [string, string];
  metal: string[];
  tyre: string;
  accent: string;
  card: string;
}

// Of a skin: colours near its edge and deep inside, the strength of light, the colour and strength of shade, its gleam,
// how much shows through inside, and how little at all.
export type SkinLook = [near: string, deep: string, up: number, shade: string, down: number, gloss: number,
  clear: number, alpha: number];

export interface SceneLook {
  skin: string;
  line: string;
  colour: string;
  width: number;
}

export interface SceneShape {
  loops: number[][];
  look: SkinLook;
  line: string | null;
  rounding: number;
  layer: number;
  grown: number;
  extra: number;
  keep: number;
  shows_strain: boolean;
}

export interface Wheel {
  hub: number;
  radius: number;
  is_tyre: boolean;
  inner: number[];
  outer: number[];
  spokes: number[];
}

// Where in its form the middle of a face lies, and how large it may be [m].
export type Spot = [x: number, y: number, room: number];

export interface SceneBody extends SceneLook {
  type: string;
  cell: number;
  angle: number;
  slots: [first: number, count: number][];
  spring: number;
  springs: number;
  segments: number | null;
  shapes: SceneShape[];
  needs: number[];
  triangles?: number[];
  keeps_area?: boolean;
  spacing?: number;
  spot?: Spot;
  face?: boolean;
  knots?: number[];
  wheel?: Wheel;
  picture?: string;
  is_fan?: boolean;
}

export interface Join extends SceneLook {
  spring: number;
  ends: [number, number];
}

export interface Ball {
  slot: number;
  kind: string;
  colour: string | null;
}

export interface Ground {
  kind: string;
  points: Point[];
  rounding?: number;
  grain?: 'earth' | 'wood' | null;
  themes?: Record<string, { look: SkinLook; line: string }>;
}

// A side of a belt, from end to end of its edges; springs below 0 are terrain.
export interface Tread {
  points?: Point[];
  slots?: number[];
  springs: number[];
  arc: number[];
  speed: number;
  closed: boolean;
  side: number;
  radius: number;
}

// Colours of water at its surface, deep down, and of its foam.
export interface Tones {
  near: string;
  deep: string;
  foam: string;
}

export interface Pool {
  box: Box;
  flow: Point;
  tones: Record<'dark' | 'light', Tones>;
}

// A body that says each particle, spring and triangle; what is left out is usual.
export interface MadeBody extends Pair {
  particles: Point[];
  springs: [number, number][];
  triangles: [number, number, number][];
  mass: number;
  radius: number;
  material: string;
  pinned?: number[];
  friction?: number;
  collides?: string;
  look: Record<string, unknown>;
}

// Bodies as rows: docs/kits.md. What is in the columns of its parts is looked at when it joins a world.
export interface Kit {
  bodies?: number;
  names?: unknown;
  areas?: any;
  forms?: KitForm[];
  keys?: Level['keys'];
  look?: any;
  [part: string]: unknown;
}

// The form at rest of a body of a kit: places [m] and masses [kg] of its points, and what joins them, by their numbers.
export interface KitForm {
  body: number;
  x: number[];
  y: number[];
  mass: number[];
  pairs: number[];
  areas: number[];
  bends: number[];
  springs: number[];
  constraints: number[];
}

// What a kit calls its rows in a world.
export interface KitNames {
  particle: string[];
  spring: string[];
  part: string[];
  material: string[];
  area: string[];
  second: [name: string, slot: number][];
}

// The tables of kits: start.py.
export interface KitTable {
  parts: string[];
  families: Record<string, keyof Counts>;
  slots: [part: string, name: string, usual: number | null, range: [string, string, string] | null][];
  numbers: [part: string, name: string, usual: number | string | null, range: [number | string, number | string, string]][];
  table: string[];
  ranges: (number | string)[];
  codes: Record<'NO_ROWS' | 'NO_LIMIT_ROWS' | 'TOO_MANY' | 'BAD_PLACE' | 'HEADER' | 'NO_ARENA' | 'BAD_SLOT', number>;
  ways: Record<'BODY' | 'HANGING', number>;
  most: Record<string, number>;
  limitedWork: number;
  far: string;
  groupBits: string;
  nouns: Record<string, string>;
  words: Record<string, string>;
}

// What shapes of each skin are like, colours by their names, that of wood, and the Cs from which on a spring is a bar.
export interface Made {
  skins: Record<string, SceneShape>;
  palette: Record<string, string>;
  wood: string;
  firm: number;
  // What drawn bodies are made of: Cs, Cd, mass of a square metre [kg/m^2], colours that they take in turn, and what a
  // body says more; of ropes and rods, and of springs.
  stuffs: Record<string, Pair & { density: number; colours: string[]; more: { look: Record<string, unknown> } }>;
  firmest: Pair;
  springy: Pair;
  // Cs and Cd by words of firmness.
  words: Record<string, Point>;
  // Sags of bodies by words of firmness.
  sags: Record<string, { sag: number }>;
  firmness: Record<string, { sag: number } | { hz: number, ratio: number }>[];
}

export interface Pair {
  stiffness: number;
  damping: number;
}

// What a page must know to make kits: see start.py.
export interface Adding {
  surface: { friction: number; restitution: number; group: string; collides: string };
  body: { friction: number; restitution: number; group: string; collides: string };
  terrain: string;
  touches: boolean;
  edges: Record<'none' | 'line' | 'left' | 'right', number>;
  made: Made;
  parts: Droppable[];
  catalogue: Droppable[];
}

// What a page drops: the commands that add it about the origin, and lines around it there [m].
export interface Droppable {
  id: string;
  name: string;
  records: (NamedRecord & { kit?: Kit, position?: Point })[];
  ghost: Point[][];
}

// What people see of what joined a world.
export type Joined = Partial<Pick<Scene, 'bodies' | 'joins' | 'balls'>>;

export interface Scene {
  view: Box;
  theme: 'dark' | 'light' | null;
  themes: Record<'dark' | 'light', Theme>;
  palette: string[];
  bodies: SceneBody[];
  joins: Join[];
  balls: Ball[];
  pieces: { own: number; kept: number; crumb: number; flat: unknown[] };
  ground: Ground[];
  treads: Tread[];
  water: Pool[];
  pictures: Record<string, { rows: number; bytes: string }>;
  worn: Record<string, string>;
}

// ---- What is drawn: things.js, pieces.js, draw.js, paint.js

// A spring and its ends.
export type SpringEnds = [spring: number, a: number, b: number];

// A body with all its slots and springs.
export interface Body extends Omit<SceneBody, 'slots' | 'springs'> {
  slots: number[];
  springs: SpringEnds[];
}

// A body of triangles, with the springs along the sides of each.
export interface FilledBody extends Body {
  triangles: number[];
  sides: (number | undefined)[];
  spot: Spot;
  spacing: number;
}

export type Unfolded = Omit<Scene, 'bodies'> & { bodies: (Body | FilledBody)[] };

export interface Piece {
  left: number[][];
  slots: number[];
  loops: number[][];
  inside: SpringEnds[];
  face?: Face | false;
  isCrumb?: boolean;
}

export interface Face {
  slots: number[];
  springs: SpringEnds[];
  angle: number;
  spot: Spot;
}

// A drop: where it began [m], its velocity then [m/s], when that was and how long it lives [s], its size [m], its pool.
export interface Drop {
  x: number;
  y: number;
  u: number;
  v: number;
  born: number;
  life: number;
  size: number;
  pool: number;
}

export type Flag = ArrayLike<number>;

// What makeSkin() takes of a shape, and what it leaves in it.
export interface Skinned {
  box: Box;
  depth: number;
  path: Path2D;
  look: SkinLook;
  splats?: Splat[] | null;
  reach?: number;
  fill?: CanvasPattern | null;
  cells?: CanvasRenderingContext2D;
}

// Where strain shows, and how much of it: -1 squeezed to 1 stretched.
export type Splat = [x: number, y: number, amount: number];

export interface Shape extends SceneShape, Skinned {
  springs: SpringEnds[];
  cell: number;
  splats: Splat[] | null;
  reach: number;
}

// A piece of a line: from and to: places along its texture.
export type LinePiece = [ax: number, ay: number, bx: number, by: number, from?: number, to?: number, spring?: number];

interface Line {
  kind: string;
  width: number;
  half: number;
  pieces: LinePiece[];
  path: Path2D;
}

export interface Strand extends Line {
  particles: number[];
  springs: number[];
}

export interface Bars extends Line {
  particles?: undefined;
  colour: string;
  cell?: number;
  size: number[];
  springs: SpringEnds[];
  raised?: number;
  bolts?: number[];
  isTruss?: boolean;
}

export interface Working {
  kind: string;
  spring: number;
  ends: [number, number];
  width: number;
}

// A part of a sheet: three corners with their places in its picture, or four with left, top, right and bottom there.
export interface SheetPart {
  slots: number[];
  texels: number[];
}

export interface Sheet {
  body: FilledBody;
  triangles: number[][];
  loops: number[][];
  isCloth: boolean;
  parts?: SheetPart[];
}

// A picture that a part of a body wears; texels: corners of a band around it and of its triangles, 0..1 to the right and
// down. The slot -1 is the middle of the first loop.
export interface Worn {
  body: Body;
  shape: Shape;
  triangles: number[][];
  loops: number[][];
  texels: number[][];
}

// A picture, once it is unpacked, and what fills with it over a colour.
export interface WornPicture {
  image: ImageBitmap | null;
  over: Map<string, CanvasPattern>;
}

export interface Things {
  shapes: Shape[];
  lines: (Strand | Bars)[];
  working: Working[];
  wheels: Wheel[];
  sheets: Sheet[];
  worn: Worn[];
  faces: Face[];
  balloons: (Body & { knots: number[] })[];
}

// ---- Around a toy

// What a toy tells, by the names of its events.
export interface ToyEvents {
  way: { done: number; all: number };
  tick: undefined;
  break: { springs: string[] };
  check: CheckResult;
  rules: { actions: Action[] };
  outcome: Outcome;
  say: { text: string; rank: Rank };
  menu: Asked;
  speak: { text: string };
  pause: { isPaused: boolean };
  pace: { isBehind: boolean };
  jump: undefined;
  theme: { name: 'dark' | 'light' };
  draw: undefined;
}

// What a page says: of which rank, see messages.js; whether it is good news; where it was asked for; where it leads.
export type Rank = 'verdict' | 'fault' | 'refusal' | 'done' | 'progress' | 'rule' | 'tip';
export interface Message {
  rank: Rank;
  text: string;
  isGood?: boolean;
  place?: string;
  href?: string;
}

// What a hand does to the page around it; isStill: whether time stands.
export interface HandEvents {
  isStill: () => boolean;
  changed: () => void;
  fit: () => void;
  say: (text: string) => void;
  menu: (asked: Asked) => void;
  speak: (text: string) => void;
}

// A press of a pointer, or of the cursor of keys, which is at a particle or at none.
export type Pressed = Pick<PointerEvent, 'pointerId' | 'pointerType' | 'type' | 'button' | 'buttons' | 'altKey'
  | 'timeStamp' | 'offsetX' | 'offsetY'> & { particle?: number | null };

// A particle that somebody asked a menu of, and where [pixels].
export interface Asked {
  particle: number;
  x: number;
  y: number;
}

declare global {
  // The page, once it is open, and what a page holds under an id.
  var page: object | undefined;
  function unpacked(id: string): Promise<ArrayBuffer>;
}
