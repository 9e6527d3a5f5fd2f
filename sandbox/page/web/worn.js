// Worn: pictures that bodies wear, each cut to its outline.
import { canvasOf, fillTriangle, tiled } from './paint.js';
/** @import { Numbers, Scene, Worn, WornPicture } from './types.js' */

// Texels of a side at most, and how far a picture goes on beyond its edges, as a part of itself.
const MOST = 1024, EDGE = 0.05;
// How much larger triangles are drawn, so that no seam shows; how far beyond the outline those at it reach [pixels].
const SEAM = 0.1, BEYOND = 1.5, LARGEST = 2;

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
export function withMiddle(placeOf, [loop]) {
  const places = loop.map(placeOf), middle = [0, 1].map((axis) =>
    places.reduce((sum, place) => sum + place[axis], 0) / places.length);
  return (slot) => (slot < 0 ? middle : placeOf(slot));
}

/** Draw what a body wears; at: places on the page by slot, reach: how far its outline lies beyond its particles [pixels].
 * @type {(context: CanvasRenderingContext2D, worn: Worn, picture: WornPicture | undefined, at: Numbers,
 *   reach: number) => void} */
export function drawWorn(context, { body: { colour }, shape, triangles, texels, loops }, picture, at, reach) {
  const pattern = picture && filling(picture, colour), rim = new Set(loops.flat()), before = context.getTransform();
  if (!pattern) {
    context.fillStyle = colour;
    context.fill(shape.path, 'evenodd');
    return;
  }
  const placeOf = withMiddle((slot) => [at[2 * slot], at[2 * slot + 1]], loops);
  context.save();
  context.clip(shape.path, 'evenodd');
  context.fillStyle = pattern;
  context.imageSmoothingQuality = 'high';
  for (const isRim of [true, false]) {
    triangles.forEach((slots, k) => {
      if (isRim && slots.filter((slot) => rim.has(slot)).length < 2) return;
      const points = slots.flatMap(placeOf);
      fillTriangle(context, points, texels[k], isRim ? larger(points, reach + BEYOND) : SEAM);
      context.setTransform(before);
    });
  }
  context.restore();
}

/** By how much of itself a triangle grows when its sides move outwards so far.
 * @type {(points: number[], far: number) => number} */
function larger([x0, y0, x1, y1, x2, y2], far) {
  const area = Math.abs((x1 - x0) * (y2 - y0) - (x2 - x0) * (y1 - y0));
  const around = Math.hypot(x1 - x0, y1 - y0) + Math.hypot(x2 - x1, y2 - y1) + Math.hypot(x0 - x2, y0 - y2);
  return Math.min((far * around) / (area || 1), LARGEST);
}
