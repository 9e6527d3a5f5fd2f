// Worn: pictures that bodies wear, each cut to its outline.
import { boxOf, canvasOf, fillTriangle, grown, tiled } from './paint.js';
/** @import { Body, Box, Numbers, Scene, Worn, WornPicture } from './types.js' */

// Texels of a side at most, and how far a picture goes on beyond its edges, as a part of itself.
const MOST = 1024, EDGE = 0.05;
// How far a picture goes on beyond the particles at the rim [pixels], beside so many of their radii.
const BEYOND = 3, ROOM = 1.5;
// How much of the height of a picture that shows.
const RIM = 0.02;

/** By their text.
 * @type {Map<string, WornPicture>} */
const kept = new Map();

/** The pictures of a scene by their names; each is there once it is unpacked, after which `draw` is called.
 * @type {(pictures: Scene['worn'], draw: () => void) => Map<string, WornPicture>} */
export function unpacked(pictures, draw) {
  return new Map(Object.entries(pictures).map(([name, text]) => {
    const before = kept.get(text);
    if (before) return [name, before];
    /** @type {WornPicture} */
    const picture = { image: null, over: new Map() };
    kept.set(text, picture);
    const bytes = Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));
    createImageBitmap(new Blob([bytes], { type: 'image/png' })).then((image) => {
      picture.image = image;
      draw();
    }, () => {});
    return [name, picture];
  }));
}

/** A picture over a colour as what fills triangles, whose texels are parts of it; it goes on beyond its edges.
 * @type {(picture: WornPicture, colour: string) => CanvasPattern | null} */
function filling({ image, over }, colour) {
  let made = over.get(colour);
  if (!made && image) {
    const [wide, high] = [image.width, image.height].map((side) => Math.max(Math.min(side, MOST), 64));
    const context = canvasOf(Math.round(wide * (1 + 2 * EDGE)), Math.round(high * (1 + 2 * EDGE)));
    const { width, height } = context.canvas, x = (width - wide) / 2, y = (height - high) / 2;
    context.imageSmoothingQuality = 'high';
    context.fillStyle = colour;
    context.fillRect(0, 0, width, height);
    // The pixels at its edges go on, then comes the picture itself.
    context.drawImage(image, 0, 0, width, height);
    const { width: across, height: down } = image;
    context.drawImage(image, 0, 0, 1, down, 0, y, x, high);
    context.drawImage(image, across - 1, 0, 1, down, x + wide, y, x, high);
    context.drawImage(image, 0, 0, across, 1, x, 0, wide, y);
    context.drawImage(image, 0, down - 1, across, 1, x, y + high, wide, y);
    context.drawImage(image, x, y, wide, high);
    made = tiled(context);
    made.setTransform(new DOMMatrix([1 / wide, 0, 0, 1 / high, -x / wide, -y / high]));
    over.set(colour, made);
  }
  return made ?? null;
}

/** Places of slots, where -1 is the middle of the first of these loops.
 * @type {(placeOf: (slot: number) => number[], loops: number[][]) => (slot: number) => number[]} */
function withMiddle(placeOf, [loop]) {
  const places = loop.map(placeOf), middle = [0, 1].map((axis) =>
    places.reduce((sum, place) => sum + place[axis], 0) / places.length);
  return (slot) => (slot < 0 ? middle : placeOf(slot));
}

/** Triangles [x, y, ...] in a band around each of these loops of places, so wide.
 * @type {(loops: number[][], wide: number) => number[][]} */
const bandOf = (loops, wide) => loops.flatMap((loop) => {
  const outer = grown(Float64Array.from(loop), wide);
  return Array.from({ length: loop.length / 2 }, (_, k) => {
    const [a, b] = [2 * k, (2 * k + 2) % loop.length], pair = (/** @type {Numbers} */ of, /** @type {number} */ n) => [of[n], of[n + 1]];
    return [[...pair(loop, a), ...pair(loop, b), ...pair(outer, b)], [...pair(loop, a), ...pair(outer, b), ...pair(outer, a)]];
  }).flat();
});

/** Where particles of a body were before it was turned [m], y downwards.
 * @type {(body: { angle: number }, origin: Numbers) => (slot: number) => number[]} */
export function upright({ angle }, origin) {
  const cosine = Math.cos(angle), sine = Math.sin(angle);
  return (slot) => [origin[2 * slot] * cosine + origin[2 * slot + 1] * sine,
    origin[2 * slot] * sine - origin[2 * slot + 1] * cosine];
}

/** The boxes of bodies that wear pictures, as they were before cuts moved particles. */
export class Forms {
  /** By the first slot.
   * @type {Map<number, Box>} */
  #boxes = new Map();

  /** @type {(bodies: Body[], origin: Numbers) => void} */
  note(bodies, origin) {
    for (const body of bodies) {
      const [first] = body.slots;
      if (body.picture && !this.#boxes.has(first)) this.#boxes.set(first, boxOf(body.slots.flatMap(upright(body, origin))));
    }
  }

  /** Where the corners of what is worn lie in the picture, 0..1 to the right and down.
   * @type {(worn: Worn, origin: Numbers) => number[][]} */
  places({ body, triangles, loops }, origin) {
    const [left, top, right, low] = this.#boxes.get(body.slots[0]) ?? [0, 0, 1, 1], turned = upright(body, origin);
    const place = (/** @type {number} */ value, /** @type {number} */ k) =>
      (k % 2 ? (value - top) / (low - top || 1) : (value - left) / (right - left || 1));
    const band = bandOf(loops.map((loop) => loop.flatMap(turned)), RIM * (low - top));
    return [...band, ...triangles.map((corners) => corners.flatMap(withMiddle(turned, loops)))].map((each) => each.map(place));
  }
}

/** Draw what a body wears; at: places on the page by slot, zoom: pixels of a metre.
 * @type {(context: CanvasRenderingContext2D, worn: Worn, picture: WornPicture | undefined, at: Numbers,
 *   zoom: number) => void} */
export function drawWorn(context, { body: { colour }, shape, triangles, texels, loops }, picture, at, zoom) {
  const pattern = picture && filling(picture, colour), before = context.getTransform();
  if (!pattern) {
    context.fillStyle = colour;
    context.fill(shape.path, 'evenodd');
    return;
  }
  const place = (/** @type {number} */ slot) => [at[2 * slot], at[2 * slot + 1]], placeOf = withMiddle(place, loops);
  const band = bandOf(loops.map((loop) => loop.flatMap(place)), ROOM * shape.grown * zoom + BEYOND);
  context.save();
  context.clip(shape.path, 'evenodd');
  context.fillStyle = pattern;
  context.imageSmoothingQuality = 'medium';
  // The band comes first, as triangles are drawn a little larger than they are.
  [...band, ...triangles.map((slots) => slots.flatMap(placeOf))].forEach((points, k) => {
    fillTriangle(context, points, texels[k]);
    context.setTransform(before);
  });
  context.restore();
}
