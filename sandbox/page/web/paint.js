// Paint: colours, lit skins, strips with a texture and balls on a canvas. All sizes are pixels of the page.
import { COLOURS } from './shared.js';
/** @import { Box, LinePiece, Numbers, Point, Scene, SheetPart, SkinLook, Skinned, Splat, Theme } from './types.js' */

/** @type {(value: number, low?: number, high?: number) => number} */
export const clamp = (value, low = 0, high = 1) => Math.min(Math.max(value, low), high);
/** @type {(colour: string) => number[]} */
const parse = (colour) => [1, 3, 5].map((at) => parseInt(colour.slice(at, at + 2), 16));
/** @type {(first: number[], second: number[], share: number) => number[]} */
const mean = (first, second, share) => first.map((value, k) => value + (second[k] - value) * share);

/** @typedef {{ width: number, height: number }} Size */
/** @typedef {[number, number, number]} Point3 */
/** A colour over a line at a spring, and how much of that.
 * @typedef {(spring: number) => [colour: string, alpha: number] | null} TintOf */

/** The colour that has `share` (0..1) of the second in it; colours are '#rrggbb'.
 * @type {(first: string, second: string, share: number) => string} */
export function mixed(first, second, share) {
  const channels = mean(parse(first), parse(second), share);
  return `#${channels.map((value) => Math.round(value).toString(16).padStart(2, '0')).join('')}`;
}

/** @type {(colour: string) => string} */
export const outlineOf = (colour) => mixed(colour, '#28003c', 0.46);

const WHITE = [255, 255, 255];
/** @type {Map<string, unknown>} */
const kept = new Map();
/** Textures by their names in a scene.
 * @type {Map<string, CanvasPattern>} */
const textures = new Map();
/** @type {(name: string) => CanvasPattern | string} */
const textureOf = (name) => textures.get(name) ?? 'transparent';

/** What was made under a name, or is made now.
 * @template T @param {string} name @param {() => T} make @returns {T} */
function once(name, make) {
  if (!kept.has(name)) kept.set(name, make());
  return /** @type {T} */ (kept.get(name));
}

/** What draws on a canvas.
 * @type {(canvas: HTMLCanvasElement, settings?: CanvasRenderingContext2DSettings) => CanvasRenderingContext2D} */
export function contextOf(canvas, settings) {
  const context = canvas.getContext('2d', settings);
  if (!context) throw new Error('this canvas has no 2d context');
  return context;
}

/** @type {(width: number, height: number, settings?: CanvasRenderingContext2DSettings) => CanvasRenderingContext2D} */
export function canvasOf(width, height, settings) {
  const canvas = document.createElement('canvas');
  Object.assign(canvas, { width, height });
  return contextOf(canvas, settings);
}

/** A picture as what fills all around it.
 * @type {(context: CanvasRenderingContext2D) => CanvasPattern} */
export function tiled(context) {
  const pattern = context.createPattern(context.canvas, 'repeat');
  if (!pattern) throw new Error('a picture has no size');
  return pattern;
}

/** @type {(image: ImageData) => CanvasPattern} */
function patternOf(image) {
  const context = canvasOf(image.width, image.height);
  context.putImageData(image, 0, 0);
  return tiled(context);
}

/** Closed loops of points [x, y, ...] as one path, with their corners cut by `keep` of their sides.
 * @type {(loops: Numbers[], keep?: number) => Path2D} */
export function pathOf(loops, keep = 0) {
  const path = new Path2D(), cut = Math.min(2 * keep, 0.5);
  for (const points of loops) {
    const count = points.length;
    for (let k = 0; k < count; k += 2) {
      const x = points[k], y = points[k + 1], before = (k + count - 2) % count, after = (k + 2) % count;
      path[k ? 'lineTo' : 'moveTo'](x + (points[before] - x) * cut, y + (points[before + 1] - y) * cut);
      if (cut) path.quadraticCurveTo(x, y, x + (points[after] - x) * cut, y + (points[after + 1] - y) * cut);
    }
    path.closePath();
  }
  return path;
}

/** A loop of points moved outwards by so much; it runs anticlockwise, and a hole the other way.
 * @type {(points: Float64Array, by: number) => Float64Array} */
export function grown(points, by) {
  return points.map((value, k) => {
    const x = k & ~1, before = (x + points.length - 2) % points.length, after = (x + 2) % points.length;
    const dx = points[after] - points[before], dy = points[after + 1] - points[before + 1];
    return value + ((k % 2 ? dx : -dy) * by) / (Math.hypot(dx, dy) || 1);
  });
}

/** Left, top, right and bottom of points [x, y, ...].
 * @type {(points: Numbers) => Box} */
export function boxOf(points) {
  /** @type {Box} */
  const box = [Infinity, Infinity, -Infinity, -Infinity];
  for (let k = 0; k < points.length; k++) {
    box[k % 2] = Math.min(box[k % 2], points[k]);
    box[2 + (k % 2)] = Math.max(box[2 + (k % 2)], points[k]);
  }
  return box;
}

const INSIDE = 32, LIT = 128, STRONGEST = 1.5;

/** Colours of a skin by how far inside a place is, and how lit. look: colours near its edge and deep inside, the
 * strength of light, the colour and strength of shade, its gleam, how much shows through inside, and how little at all.
 * @type {(look: SkinLook) => Uint32Array} */
function table(look) {
  return once(look.join(), () => {
    const [, , up, , down, gloss, clear, alpha] = look, [near, deep, shade] = [look[0], look[1], look[3]].map(parse);
    const colours = new Uint8ClampedArray(4 * INSIDE * LIT);
    for (let k = 0; k < INSIDE * LIT; k++) {
      const inside = Math.floor(k / LIT) / (INSIDE - 1), lit = STRONGEST * ((2 * (k % LIT)) / (LIT - 1) - 1);
      const gleam = clamp((lit - 0.3) * 5) * clamp((inside - 0.16) * 6) * clamp((0.8 - inside) * 4) * gloss;
      const own = mean(near, deep, clamp(1.15 * inside - 0.08));
      const colour = lit > 0 ? mean(own, WHITE, up * Math.min(lit, 1.1)) : mean(own, shade, down * Math.min(-lit, 1));
      const shown = alpha * (1 - clear * inside * (1 - 0.5 * Math.min(Math.abs(lit), 1)));
      colours.set([...mean(colour, WHITE, gleam), 255 * shown], 4 * k);
    }
    return new Uint32Array(colours.buffer);
  });
}

/** Blur cells in rows by the mean of `reach` of them to each side, so many times; cells at the border are empty.
 * @type {(cells: Float32Array, columns: number, reach: number, times: number) => void} */
function blur(cells, columns, reach, times) {
  const full = 2 * reach + 1;
  for (let time = 0; time < 2 * times; time++) {
    const step = time % 2 ? columns : 1, before = new Float32Array(cells.length + full * step);
    before.set(cells, (reach + 1) * step);
    for (let first = 0; first < step; first++) {
      let sum = 0;
      for (let k = first; k < first + reach * step; k += step) sum += cells[k];
      for (let k = first; k < cells.length; k += step) {
        sum += before[k + full * step] - before[k];
        cells[k] = sum / full;
      }
    }
  }
}

// Pixels of the page to one of a shadow, and how often that is blurred.
const SHADOW = 6, SOFTNESS = 3, shadowed = canvasOf(1, 1, { willReadFrequently: true });

/** Lay the soft shadow of what a function draws on a picture of this size: down and to the right.
 * @type {(onto: CanvasRenderingContext2D, size: Size, theme: Pick<Theme, 'shadow' | 'shadow_strength'>,
 *   scale: number, draw: (context: CanvasRenderingContext2D) => void) => void} */
export function castShadow(onto, { width, height }, { shadow: colour, shadow_strength: strength }, scale, draw) {
  const context = shadowed, { canvas } = context, columns = Math.ceil(width / SHADOW) + 2 * SOFTNESS;
  Object.assign(canvas, { width: columns, height: Math.ceil(height / SHADOW) + 2 * SOFTNESS });
  context.setTransform(1 / SHADOW, 0, 0, 1 / SHADOW, SOFTNESS, SOFTNESS);
  context.fillStyle = colour;
  context.lineCap = context.lineJoin = 'round';
  draw(context);
  const image = context.getImageData(0, 0, columns, canvas.height), pixels = new Uint32Array(image.data.buffer);
  const found = [], [red, green, blue] = parse(colour);
  for (let k = 0; k < pixels.length; k++) if (pixels[k]) found.push(k % columns, Math.floor(k / columns));
  if (!found.length) return;
  // Only where there is any.
  const [left, top, right, bottom] = boxOf(found), x = Math.max(left - SOFTNESS, 0), y = Math.max(top - SOFTNESS, 0);
  const wide = right + SOFTNESS + 1 - x, high = Math.min(bottom + SOFTNESS + 1, canvas.height) - y;
  const first = y * columns, cells = new Float32Array(high * columns);
  for (let k = 0; k < cells.length; k++) cells[k] = pixels[first + k] >>> 24;
  blur(cells, columns, 1, SOFTNESS);
  for (let k = 0; k < cells.length; k++) pixels[first + k] = (cells[k] << 24) | (blue << 16) | (green << 8) | red;
  context.putImageData(image, 0, 0);
  onto.globalAlpha = strength;
  onto.drawImage(canvas, x, y, wide, high, (x - SOFTNESS) * SHADOW + 4 * scale, (y - SOFTNESS) * SHADOW + 8 * scale,
    wide * SHADOW, high * SHADOW);
  onto.globalAlpha = 1;
}

// Cells of a skin are this part of its depth wide; they are blurred by so many to each side, so often; cells around it.
const CELL = 0.25, REACH = 3, TIMES = 3, AROUND = REACH * (TIMES - 1) + 1;
// Light from above, a little from the left.
const DOWNWARDS = 0.9, ACROSS = 0.42, STEEPNESS = 1.45 / CELL / 2;
const FLUSH = 0.74, SQUEEZED = parse(COLOURS.SQUEEZED), STRETCHED = parse(COLOURS.STRETCHED);

/** Make the skin of a shape that bulges, of which a view of this size is seen. The shape has a path, a box, a depth, a
 * look, and splats of strain or none: it is filled with cells; blurred they are how high its skin stands, and the slope
 * of that is how it is lit.
 * @type {(shape: Skinned, width: number, height: number) => void} */
export function makeSkin(shape, width, height) {
  const { box: [left, top, right, bottom], depth, path, look } = shape, cell = Math.max(CELL * depth, 1);
  const room = AROUND * cell, x = Math.max(left, -room) - room, y = Math.max(top, -room) - room;
  const columns = Math.ceil((Math.min(right, width + room) + room - x) / cell);
  const rows = Math.ceil((Math.min(bottom, height + room) + room - y) / cell);
  shape.fill = null;
  // Nothing of what is elsewhere, or nowhere.
  if (!(columns > 2 * AROUND && rows > 2 * AROUND)) return;
  const context = (shape.cells ??= canvasOf(1, 1, { willReadFrequently: true })), { canvas } = context;
  Object.assign(canvas, { width: columns, height: rows });
  context.setTransform(1 / cell, 0, 0, 1 / cell, -x / cell, -y / cell);
  context.fill(path, 'evenodd');
  const image = context.getImageData(0, 0, columns, rows), pixels = new Uint32Array(image.data.buffer);
  const colours = table(look), high = new Float32Array(pixels.length);
  const { splats, reach = 0 } = shape;
  const strain = splats && strainOf(splats.map(([across, down, amount]) =>
    [(across - x) / cell, (down - y) / cell, amount]), Math.max(reach / cell, 1), columns, rows);
  for (let k = 0; k < pixels.length; k++) high[k] = (pixels[k] >>> 24) / 255;
  blur(high, columns, REACH, TIMES);
  for (let k = columns; k < pixels.length - columns; k++) {
    const across = high[k + 1] - high[k - 1], down = high[k + columns] - high[k - columns];
    const lit = STEEPNESS * (ACROSS * across + DOWNWARDS * down);
    const inside = clamp(Math.round(1.9 * (high[k] - 0.45) * (INSIDE - 1)), 0, INSIDE - 1);
    pixels[k] = colours[inside * LIT + clamp(Math.round((lit / STRONGEST + 1) * 0.5 * (LIT - 1)), 0, LIT - 1)];
    if (!strain?.[k]) continue;
    const share = FLUSH * Math.abs(strain[k]), over = strain[k] > 0 ? STRETCHED : SQUEEZED;
    for (let at = 0; at < 3; at++) image.data[4 * k + at] += (over[at] - image.data[4 * k + at]) * share;
  }
  context.putImageData(image, 0, 0);
  shape.fill = tiled(context);
  shape.fill.setTransform(new DOMMatrix([cell, 0, 0, cell, x, y]));
}

/** How squeezed (-1) or stretched (1) cells are, by splats [x, y, amount] that reach so far.
 * @type {(splats: Splat[], reach: number, columns: number, rows: number) => Float32Array} */
function strainOf(splats, reach, columns, rows) {
  const sum = new Float32Array(columns * rows), weight = new Float32Array(columns * rows).fill(0.25);
  for (const [x, y, amount] of splats) {
    for (let row = Math.max(Math.ceil(y - 2 * reach), 0); row < Math.min(y + 2 * reach, rows); row++) {
      for (let column = Math.max(Math.ceil(x - 2 * reach), 0); column < Math.min(x + 2 * reach, columns); column++) {
        const near = Math.max(1 - ((column - x) ** 2 + (row - y) ** 2) / (4 * reach * reach), 0) ** 2;
        sum[row * columns + column] += near * amount;
        weight[row * columns + column] += near;
      }
    }
  }
  return sum.map((value, k) => clamp(value / weight[k], -1, 1));
}

/** Fill a shape with its skin.
 * @type {(context: CanvasRenderingContext2D, shape: Pick<Skinned, 'fill' | 'path'>) => void} */
export function fillSkin(context, { fill, path }) {
  if (!fill) return;
  context.fillStyle = fill;
  context.fill(path, 'evenodd');
}

/** Of each kind of line: the line around it and its own colour.
 * @type {Record<string, [line: string | null, own: string] | []>} */
const LINES = {
  rope: ['#5b3d20', '#c89b62'], cable: ['#3a4252', '#a3adbf'], deck: ['#4a2e16', '#c48e58'], chain: [],
  wood: ['#3a2614', '#c99258'], thread: [null, '#aeb5c2'], silk: [null, '#8c9bb2'], steel: ['#161b26', '#96a3ba'],
  brass: ['#3a2a10', '#e2b04e'], rubber: ['#3a1418', '#eb605c'], bone: ['#4a3a28', '#f0e4cc'],
};
const ALONG = 32, HALF_TILE = 8;
// Lines narrower than this have no texture, nor has any where there are so many.
const THIN = 1.1, MOST_STRIPS = 1500;

/** Keep the pictures of a scene: textures of lines and sheets.
 * @type {(pictures: Scene['pictures']) => void} */
export function keepPictures(pictures) {
  for (const [name, { rows, bytes }] of Object.entries(pictures)) {
    const values = Uint8ClampedArray.from(atob(bytes), (letter) => letter.charCodeAt(0));
    if (!textures.has(name)) textures.set(name, patternOf(new ImageData(values, values.length / 4 / rows)));
  }
}

/** Fill a strip from a to b with a style, in the coordinates of a tile: between two places along it, and lit from above.
 * within: a path in those coordinates, of what there is of it.
 * @type {(context: CanvasRenderingContext2D, style: string | CanvasPattern, piece: LinePiece, half: number,
 *   within?: Path2D) => void} */
function strip(context, style, [ax, ay, bx, by, from = 0, to = 1], half, within) {
  const dx = bx - ax, dy = by - ay, length = Math.hypot(dx, dy), wide = half / HALF_TILE / length;
  if (!(length > 0) || !(to > from)) return;
  const side = dx < 0 || (dx === 0 && dy > 0) ? -wide : wide, long = 1 / (to - from), before = context.getTransform();
  context.transform((dx * long) / ALONG, (dy * long) / ALONG, -dy * side, dx * side,
    ax - dx * long * from + dy * side * HALF_TILE, ay - dy * long * from - dx * side * HALF_TILE);
  context.fillStyle = style;
  if (within) context.fill(within);
  else context.fillRect(ALONG * from, 0, ALONG * (to - from), 2 * HALF_TILE);
  context.setTransform(before);
}

/** Draw pieces [ax, ay, bx, by, from, to, spring] as a bar of a kind, or of a colour, along a path through them.
 * tintOf(spring): a colour over it and how much of that, or nothing.
 * @type {(context: CanvasRenderingContext2D, pieces: LinePiece[], path: Path2D, half: number, kind: string,
 *   tintOf?: TintOf) => void} */
export function drawBar(context, pieces, path, half, kind, tintOf) {
  const [line, own] = LINES[kind] ?? [outlineOf(kind), kind];
  context.lineCap = context.lineJoin = 'round';
  if (line && half > 0.7) stroke(context, path, line, half + 0.9, 0.8);
  if (own) stroke(context, path, own, half);
  const style = half >= THIN && pieces.length < MOST_STRIPS && textures.get(kind);
  for (const piece of pieces) {
    if (style) strip(context, style, piece, half);
    const tint = tintOf?.(piece[6] ?? -1);
    if (!tint) continue;
    [, context.globalAlpha] = tint;
    strip(context, tint[0], piece, kind === 'chain' ? 0.3 * half : half);
    context.globalAlpha = 1;
  }
}

/** A muscle between two places, as thick as its belly.
 * @type {(context: CanvasRenderingContext2D, ends: [number, number, number, number], belly: number) => void} */
export function drawMuscle(context, ends, belly) {
  const lens = new Path2D('M0 6C19 -2.4 45 -2.4 64 6V10C45 18.4 19 18.4 0 10Z');
  strip(context, '#4a1622', [...ends, 0, 2], belly + 1.2, lens);
  strip(context, textureOf('muscle'), [...ends, 0, 2], belly, lens);
}

/** Turf on those of the pieces [ax, ay, bx, by] of the ground's outline that face up.
 * @type {(context: CanvasRenderingContext2D, pieces: LinePiece[], theme: Theme, scale: number) => void} */
export function drawTurf(context, pieces, theme, scale) {
  let along = 0;
  /** @type {LinePiece[]} */
  const turf = [];
  for (const [ax, ay, bx, by] of pieces) {
    const length = Math.hypot(bx - ax, by - ay), from = along;
    along += length / (46 * scale);
    if ((ax - bx) / length > 0.8) turf.push([ax, ay + 2 * scale, bx, by + 2 * scale, from, along]);
  }
  context.lineCap = 'butt';
  stroke(context, linesOf(turf), mixed(...theme.turf, 0.55), 3.2 * scale);
  const grass = textureOf(`turf ${theme.name}`);
  for (const piece of turf) strip(context, grass, piece, 12 * scale);
}

/** A path of lines [ax, ay, bx, by].
 * @type {(pieces: (LinePiece | Float64Array)[]) => Path2D} */
export function linesOf(pieces) {
  const path = new Path2D();
  for (const [ax, ay, bx, by] of /** @type {LinePiece[]} */ (pieces)) {
    path.moveTo(ax, ay);
    path.lineTo(bx, by);
  }
  return path;
}

/** @type {(context: CanvasRenderingContext2D, path: Path2D, colour: string, half: number, alpha?: number) => void} */
export function stroke(context, path, colour, half, alpha = 1) {
  context.globalAlpha = alpha;
  context.strokeStyle = colour;
  context.lineWidth = 2 * half;
  context.stroke(path);
  context.globalAlpha = 1;
}

/** @type {(context: CanvasRenderingContext2D, x: number, y: number, radius: number, colour: string,
 *   alpha?: number) => void} */
export function disc(context, x, y, radius, colour, alpha = 1) {
  context.globalAlpha = alpha;
  context.fillStyle = colour;
  context.beginPath();
  context.arc(x, y, radius, 0, 2 * Math.PI);
  context.fill();
  context.globalAlpha = 1;
}

/** Waves that tile, of about so many to a picture: how many across, how many down, and where they begin.
 * @type {(count: number) => Point3[]} */
const wavesOf = (count) => [1, 2, 3, 4, 5, 6, 7].map((k) => {
  const way = 2.4 * k + count;
  return [Math.round(count * Math.cos(way)), Math.round(count * Math.sin(way)), k * k];
});
const FINE = wavesOf(10), COARSE = wavesOf(4);
/** Waves together look like noise; u and v: angles across and down.
 * @type {(u: number, v: number, waves: Point3[]) => number} */
function noise(u, v, waves) {
  let sum = 0;
  for (const [across, down, start] of waves) sum += Math.sin(across * u + down * v + start);
  return sum / 1.9;
}
const GRAIN = 256, PEBBLES = 16, LARGEST_PEBBLE = 4;
/** @type {(k: number) => number} */
const chance = (k) => ((Math.sin(12.99 * k) * 43758.55) % 1 + 1) % 1;
/** @type {Record<string, (u: number, v: number) => number>} */
const GRAINS = {
  wood: (u, v) => 5 * Math.sin(18 * v + 1.5 * Math.sin(u)) + 3 * Math.sin(46 * v + Math.sin(2 * u)),
  earth: (u, v) => 1.3 * noise(u, v, FINE)
    + 4 * Math.tanh(2 * Math.sin(4 * v + Math.sin(u) + 0.6 * noise(u, v, COARSE))),
};

/** Strew pebbles over the rows of a grain.
 * @type {(values: Float64Array) => void} */
function strew(values) {
  for (let k = 0; k < PEBBLES; k++) {
    const [left, top, size] = [1, 40, 80].map((from) => chance(k + from)), x = GRAIN * left, y = GRAIN * top;
    const [first, above] = [x, y].map((middle) => Math.max(Math.ceil(middle - LARGEST_PEBBLE), 0));
    for (let row = above; row < Math.min(y + LARGEST_PEBBLE, GRAIN); row++) {
      for (let column = first; column < Math.min(x + LARGEST_PEBBLE, GRAIN); column++) {
        values[GRAIN * row + column] += (k % 2 ? 18 : -15) * clamp(1.4 + 2 * size - Math.hypot(column - x, row - y));
      }
    }
  }
}

/** What a grain makes lighter, and what it makes darker.
 * @type {(kind: string) => CanvasPattern[]} */
function grainOf(kind) {
  const unit = (2 * Math.PI) / GRAIN, values = new Float64Array(GRAIN * GRAIN);
  for (let k = 0; k < values.length; k++) {
    values[k] = 3 * chance(k) - 1.5 + GRAINS[kind](unit * (k % GRAIN), unit * Math.floor(k / GRAIN));
  }
  if (kind === 'earth') strew(values);
  return [1, -1].map((sign) => {
    const image = new ImageData(GRAIN, GRAIN), pixels = new Uint32Array(image.data.buffer);
    for (let k = 0; k < pixels.length; k++) {
      pixels[k] = 0xff000000 | (0x010101 * clamp(Math.round(sign * values[k]), 0, 255));
    }
    return patternOf(image);
  });
}

/** Lay the grain of earth or wood over a path; its place on the page moves with x and y.
 * @type {(context: CanvasRenderingContext2D, path: Path2D, kind: string, x: number, y: number) => void} */
export function layGrain(context, path, kind, x, y) {
  const grain = once(`grain ${kind}`, () => grainOf(kind));
  /** What is lighter is added, and what is darker taken away.
   * @type {const} */ (['lighter', 'difference']).forEach((how, k) => {
    context.globalCompositeOperation = how;
    grain[k].setTransform(new DOMMatrix([1, 0, 0, 1, x, y]));
    context.fillStyle = grain[k];
    context.fill(path);
  });
  context.globalCompositeOperation = 'source-over';
}

/** A picture that is drawn once, between -1 and 1 each way.
 * @type {(name: string, size: number, draw: (context: CanvasRenderingContext2D) => void) => HTMLCanvasElement} */
function sprite(name, size, draw) {
  return once(`${name} ${size}`, () => {
    const context = canvasOf(size, size);
    context.setTransform(size / 2, 0, 0, size / 2, size / 2, size / 2);
    draw(context);
    return context.canvas;
  });
}

/** Fill the square with a colour that changes from a place to the rim of a disc.
 * @type {(context: CanvasRenderingContext2D, from: Point, rim: [x: number, y: number, radius: number],
 *   stops: [at: number, colour: string][]) => void} */
export function radial(context, [x, y], [middleX, middleY, radius], stops) {
  const fade = context.createRadialGradient(x, y, 0, middleX, middleY, radius);
  stops.forEach(([at, colour]) => fade.addColorStop(at, colour));
  context.fillStyle = fade;
  context.fillRect(-1, -1, 2, 2);
}

/** A disc of a colour that fades out towards its rim.
 * @type {(context: CanvasRenderingContext2D, x: number, y: number, radius: number, colour: string,
 *   alpha: number) => void} */
export function glow(context, x, y, radius, colour, alpha) {
  /** @type {(k: number) => [number, string]} */
  const stop = (k) => {
    const fall = 1 - k / 8, share = Math.round(255 * fall * fall * (3 - 2 * fall));
    return [k / 8, colour + share.toString(16).padStart(2, '0')];
  };
  const shape = sprite(`glow ${colour}`, 64, (own) => radial(own, [0, 0], [0, 0, 1],
    Array.from({ length: 9 }, (_, k) => stop(k))));
  context.globalAlpha = alpha;
  context.drawImage(shape, x - radius, y - radius, 2 * radius, 2 * radius);
  context.globalAlpha = 1;
}

/** @type {(context: CanvasRenderingContext2D) => void} */
const band = (own) => own.fillRect(-1, -0.26, 2, 0.52);
/** @type {Record<string, (context: CanvasRenderingContext2D) => void>} */
const MARKS = {
  stripe: band, sand: band,
  marble: (own) => stroke(own, new Path2D('M-1 0.12C-0.5 0.8 0.5 -0.8 1 -0.12'), '#ffffff', 0.2),
  steel: (own) => {
    stroke(own, new Path2D('M0.62 0A0.62 0.62 0 1 1 0.62 -0.01'), '#39435a', 0.05, 0.5);
    disc(own, 0.62, 0, 0.13, '#39435a');
  },
};

/** A ball of a kind, lit from above, with its mark turned by an angle (anticlockwise).
 * @type {(context: CanvasRenderingContext2D, x: number, y: number, radius: number, angle: number, kind: string,
 *   colour: string) => void} */
export function ball(context, x, y, radius, angle, kind, colour) {
  if (radius < 3) {
    disc(context, x, y, radius, colour);
    return;
  }
  // At most twice as fine as it is shown.
  const size = Math.min(2 ** Math.ceil(Math.log2(4 * radius)), 256);
  /** @type {(name: string, draw: (context: CanvasRenderingContext2D) => void) => HTMLCanvasElement} */
  const whole = (name, draw) => sprite(name, size, (own) => {
    own.beginPath();
    own.arc(0, 0, 0.98, 0, 7);
    own.clip();
    draw(own);
  });
  const turning = whole(`ball ${kind} ${colour}`, (own) => {
    disc(own, 0, 0, 1, colour);
    own.fillStyle = kind === 'sand' ? '#b97f3a' : '#ffffff';
    MARKS[kind]?.(own);
  });
  const light = whole('light', (own) => {
    radial(own, [-0.3, -0.45], [-0.1, -0.15, 1.12], [[0, '#ffffff38'], [0.35, '#ffffff08'], [0.6, '#00000028'],
      [0.85, '#0000006a'], [1, '#00000080']]);
    radial(own, [-0.38, -0.5], [-0.38, -0.5, 0.3], [[0, '#ffffffd0'], [0.5, '#ffffff60'], [1, '#ffffff00']]);
  });
  context.save();
  context.translate(x, y);
  context.rotate(-angle);
  context.drawImage(turning, -radius, -radius, 2 * radius, 2 * radius);
  context.rotate(angle);
  context.drawImage(light, -radius, -radius, 2 * radius, 2 * radius);
  context.restore();
}

/** The corners of two triangles that are a cell of a sheet, around it, or null. texels: places of corners in its picture.
 * @type {(triangles: number[][], texels: number[][]) => SheetPart | null} */
function cellOf(triangles, texels) {
  /** @type {Map<number, number[]>} */
  const at = new Map(triangles.flatMap((slots, n) =>
    slots.map((slot, k) => [slot, texels[n].slice(2 * k, 2 * k + 2).map(Math.round)])));
  const [across, down] = [0, 1].map((axis) => [...new Set([...at.values()].map((place) => place[axis]))].sort(
    (one, other) => one - other));
  if (at.size !== 4 || across.length !== 2 || down.length !== 2) return null;
  /** @type {(u: number, v: number) => number[]} */
  const corner = (u, v) => [...at].filter(([, place]) => place[0] === across[u] && place[1] === down[v])
    .map(([slot]) => slot);
  const corners = [corner(0, 0), corner(1, 0), corner(1, 1), corner(0, 1)], slots = corners.flat();
  if (corners.some(({ length }) => length !== 1)) return null;
  return { slots, texels: [across[0], down[0], across[1], down[1]] };
}

/** Triangles of a sheet as its parts: pairs of them as cells, and the others.
 * @type {(triangles: number[][], texels: number[][]) => SheetPart[]} */
export function partsOf(triangles, texels) {
  const parts = [];
  for (let k = 0; k < triangles.length; k++) {
    const cell = k + 1 < triangles.length ? cellOf(triangles.slice(k, k + 2), texels.slice(k, k + 2)) : null;
    parts.push(cell ?? { slots: triangles[k], texels: texels[k] });
    if (cell) k += 1;
  }
  return parts;
}

// How far [pixels] a cell may be from a parallelogram that is drawn as one; what is drawn is larger by so many texels, so
// that no seam shows.
const ASKEW = 1, SEAM = 0.6;

/** Fill parts of a sheet with its picture; at: places on the page by slot.
 * @type {(context: CanvasRenderingContext2D, name: string, parts: SheetPart[], at: Numbers) => void} */
export function fillParts(context, name, parts, at) {
  const before = context.getTransform();
  context.fillStyle = textureOf(name);
  for (const { slots, texels } of parts) {
    const points = slots.flatMap((slot) => [at[2 * slot], at[2 * slot + 1]]);
    if (slots.length === 3) fillTriangle(context, points, texels);
    else fillCell(context, points, texels);
    context.setTransform(before);
  }
}

/** @type {(context: CanvasRenderingContext2D, points: number[], texels: number[]) => void} */
function fillCell(context, points, [left, top, right, bottom]) {
  const [x0, y0, x1, y1, x2, y2, x3, y3] = points;
  if (Math.max(Math.abs(x0 - x1 + x2 - x3), Math.abs(y0 - y1 + y2 - y3)) < ASKEW) {
    lay(context, [x0, y0, x1, y1, x3, y3], [left, top, right, top, left, bottom]);
    context.fillRect(left - SEAM, top - SEAM, right - left + 2 * SEAM, bottom - top + 2 * SEAM);
    return;
  }
  const before = context.getTransform();
  fillTriangle(context, points.slice(0, 6), [left, top, right, top, right, bottom]);
  context.setTransform(before);
  fillTriangle(context, [x2, y2, x3, y3, x0, y0], [right, bottom, left, bottom, left, top]);
}

/** Go over to the coordinates of a picture, of which three places lie on the page there.
 * @type {(context: CanvasRenderingContext2D, points: number[], texels: number[]) => void} */
function lay(context, [x0, y0, x1, y1, x2, y2], [u0, v0, u1, v1, u2, v2]) {
  const area = (u1 - u0) * (v2 - v0) - (u2 - u0) * (v1 - v0);
  // How x and y change across and down the picture.
  const a = ((x1 - x0) * (v2 - v0) - (x2 - x0) * (v1 - v0)) / area;
  const b = ((y1 - y0) * (v2 - v0) - (y2 - y0) * (v1 - v0)) / area;
  const c = ((x2 - x0) * (u1 - u0) - (x1 - x0) * (u2 - u0)) / area;
  const d = ((y2 - y0) * (u1 - u0) - (y1 - y0) * (u2 - u0)) / area;
  context.transform(a, b, c, d, x0 - a * u0 - c * v0, y0 - b * u0 - d * v0);
}

/** Fill a triangle of the picture that the context fills with.
 * @type {(context: CanvasRenderingContext2D, points: number[], texels: number[]) => void} */
export function fillTriangle(context, points, texels) {
  lay(context, points, texels);
  const [u0, v0, u1, v1, u2, v2] = texels, u = (u0 + u1 + u2) / 3, v = (v0 + v1 + v2) / 3;
  // A little larger, so that no seam shows; tips of what is narrow stay near.
  const [left, top, right, bottom] = boxOf(points), by = Math.min(0.1, 5 / Math.hypot(right - left, bottom - top));
  context.beginPath();
  for (const [cu, cv] of [[u0, v0], [u1, v1], [u2, v2]]) context.lineTo(cu + by * (cu - u), cv + by * (cv - v));
  context.fill();
}
