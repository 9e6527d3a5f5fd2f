// Treads: chevrons that run along belts at the speed of these, by the time of the picture alone.
import { linesOf, stroke } from './paint.js';
import { TREADS } from './shared.js';
/** @import { LinePiece, Point, Tread } from './types.js' */

const { STRAP_HALF, CHEVRON, CHEVRON_HALF, SIDE, COLOUR, APART, MOST_PASSING } = TREADS;

/** Where along its way chevrons of a belt are [m], with `zoom` pixels to a metre.
 * @type {(tread: Tread, zoom: number, scale: number, seconds: number) => number[]} */
export function placesOf({ arc, speed, closed: isClosed }, zoom, scale, seconds) {
  const length = arc[arc.length - 1], least = Math.max((APART * scale) / zoom, Math.abs(speed) / MOST_PASSING);
  let apart = 2 ** Math.ceil(Math.log2(least));
  // No seam where it comes back to its beginning.
  if (isClosed) apart = length / Math.max(1, Math.round(length / apart));
  const first = (((speed * seconds) % apart) + apart) % apart;
  return Array.from({ length: Math.max(0, Math.ceil((length - first) / apart)) }, (_, k) => first + k * apart);
}

/** Draw a belt, way: the ends of its edges [pixels]; isThere: whether a spring of it is.
 * @type {(context: CanvasRenderingContext2D, tread: Tread, way: Point[], isThere: (spring: number) => boolean,
 *   strap: string, zoom: number, scale: number, seconds: number) => void} */
export function drawTread(context, tread, way, isThere, strap, zoom, scale, seconds) {
  const { arc, speed, side, springs, radius } = tread, size = scale * (side ? SIDE : 1), ahead = CHEVRON * size;
  const inset = side ? side * STRAP_HALF * size : STRAP_HALF * size - radius * zoom;
  const edges = springs.map((spring, k) => {
    const [x, y] = way[k], dx = way[k + 1][0] - x, dy = way[k + 1][1] - y, length = Math.hypot(dx, dy);
    const ux = dx / (length || 1), uy = dy / (length || 1);
    return { x: x + inset * uy, y: y - inset * ux, dx, dy, ux, uy, length, isDrawn: spring < 0 || isThere(spring) };
  });
  /** @type {LinePiece[]} */
  const lines = [], chevrons = [];
  for (const { x, y, dx, dy, ux, uy, length } of edges.filter(({ isDrawn }) => isDrawn)) {
    // Round at its ends, it goes to the corners of what is solid and no farther.
    const trim = side ? 0 : Math.min(Math.max(0, inset), length / 2);
    lines.push([x + trim * ux, y + trim * uy, x + dx - trim * ux, y + dy - trim * uy]);
  }
  let k = 0;
  for (const place of placesOf(tread, zoom, scale, seconds)) {
    while (k < edges.length - 1 && place >= arc[k + 1]) k++;
    const { x, y, dx, dy, ux, uy, isDrawn } = edges[k];
    if (!isDrawn) continue;
    const share = (place - arc[k]) / (arc[k + 1] - arc[k] || 1), by = Math.sign(speed) * ahead;
    const tipX = x + share * dx + 0.5 * by * ux, tipY = y + share * dy + 0.5 * by * uy;
    for (const across of [-ahead, ahead]) {
      chevrons.push(/** @type {LinePiece} */ ([tipX - by * ux + across * uy, tipY - by * uy - across * ux, tipX, tipY]));
    }
  }
  context.lineCap = context.lineJoin = 'round';
  stroke(context, linesOf(lines), strap, STRAP_HALF * size);
  stroke(context, linesOf(chevrons), COLOUR, CHEVRON_HALF * scale);
}
