// Treads: chevrons that run along belts at the speed of these, by the time of the picture alone.
import { linesOf, stroke } from './paint.js';
import { TREADS } from './shared.js';
/** @import { LinePiece, Point, Tread } from './types.js' */

const { STRAP_HALF, CHEVRON, CHEVRON_HALF, SIDE, COLOUR, APART, MOST_PASSING, LEAST_APART, BESIDE } = TREADS;

/** How far apart chevrons of a belt are [m], with `zoom` pixels to a metre, and where the first one is.
 * @type {(tread: Tread, zoom: number, scale: number, seconds: number) => [apart: number, first: number]} */
function spacingOf({ arc, speed, closed: isClosed }, zoom, scale, seconds) {
  const length = arc[arc.length - 1];
  let apart = 2 ** Math.ceil(Math.log2(Math.max((APART * scale) / zoom, Math.abs(speed) / MOST_PASSING)));
  // No seam where it comes back to its beginning.
  if (isClosed) apart = Math.max(length / Math.max(1, Math.round(length / apart)), LEAST_APART);
  return [apart, (((speed * seconds) % apart) + apart) % apart];
}

/** The share from which to which an edge lies in a picture of that size, or close by; null: it does not.
 * @type {(begin: Point, way: Point, size: Point) => [number, number] | null} */
function seenOf(begin, way, size) {
  let low = 0, high = 1;
  for (const axis of [0, 1]) {
    const step = Math.abs(way[axis]) > 1e-9 ? way[axis] : 1e-9;
    const ends = [-BESIDE, size[axis] + BESIDE].map((end) => (end - begin[axis]) / step);
    low = Math.max(low, Math.min(...ends));
    high = Math.min(high, Math.max(...ends));
  }
  return low < high ? [low, high] : null;
}

/** Draw a belt in a picture of that size, way: the ends of its edges [pixels]; isThere: whether a spring of it is.
 * @type {(context: CanvasRenderingContext2D, tread: Tread, way: Point[], isThere: (spring: number) => boolean,
 *   strap: string, size: Point, zoom: number, scale: number, seconds: number) => void} */
export function drawTread(context, tread, way, isThere, strap, size, zoom, scale, seconds) {
  const { arc, speed, side, springs, radius } = tread, large = scale * (side ? SIDE : 1), ahead = CHEVRON * large;
  const inset = side ? side * STRAP_HALF * large : STRAP_HALF * large - radius * zoom;
  const [apart, first] = spacingOf(tread, zoom, scale, seconds), by = Math.sign(speed) * ahead;
  /** @type {LinePiece[][]} */
  const [lines, chevrons] = [[], []];
  springs.forEach((spring, k) => {
    const dx = way[k + 1][0] - way[k][0], dy = way[k + 1][1] - way[k][1], length = Math.hypot(dx, dy);
    const ux = dx / (length || 1), uy = dy / (length || 1), x = way[k][0] + inset * uy, y = way[k][1] - inset * ux;
    const seen = spring < 0 || isThere(spring) ? seenOf([x, y], [dx, dy], size) : null;
    if (!seen) return;
    // Round at its ends, a strap goes to the corners of what is solid and no farther.
    const trim = side ? 0 : Math.min(Math.max(0, inset) / (length || 1), 0.5);
    const [from, to] = seen.map((share) => Math.min(Math.max(share, trim), 1 - trim));
    lines.push([x + from * dx, y + from * dy, x + to * dx, y + to * dy]);
    const rest = arc[k + 1] - arc[k], end = arc[k] + seen[1] * rest;
    for (let n = Math.ceil((arc[k] + seen[0] * rest - first) / apart); first + n * apart < end; n++) {
      const share = (first + n * apart - arc[k]) / rest;
      const tipX = x + share * dx + 0.5 * by * ux, tipY = y + share * dy + 0.5 * by * uy;
      for (const across of [-ahead, ahead]) {
        chevrons.push([tipX - by * ux + across * uy, tipY - by * uy - across * ux, tipX, tipY]);
      }
    }
  });
  context.lineCap = context.lineJoin = 'round';
  stroke(context, linesOf(lines), strap, STRAP_HALF * large);
  stroke(context, linesOf(chevrons), COLOUR, CHEVRON_HALF * scale);
}
