// Camera: which part of the world a picture shows.
import { clamp } from './paint.js';
/** @import { Box, Point } from './types.js' */

/** Which parts of width and height a box takes that is shown as large as it goes.
 * @type {Point} */
export const FIT = [0.92, 0.88];
// Which part of the height that is left is above a box.
const LOW = 0.7;

// The place in the middle of the picture [m], pixels to a metre, and the size of the picture [pixels].
export class Camera {
  x = 0;
  y = 0;
  zoom = 50;
  width = 1;
  height = 1;

  /** Show a box [m] as large as it goes in a part of the picture that nothing covers [pixels]; null: in all of it, with
   * room around it. Where height is left it stands low: more of the sky is seen than of the ground.
   * @type {(box: Box, room: Box | null) => void} */
  fit([left, low, right, high], room) {
    const beside = (this.width * (1 - FIT[0])) / 2, above = (this.height * (1 - FIT[1])) / 2;
    const [first, top, last, bottom] = room ?? [beside, above, this.width - beside, this.height - above];
    const wide = Math.max(right - left, 0.5), tall = Math.max(high - low, 0.5);
    this.zoom = Math.max(Math.min((last - first) / wide, (bottom - top) / tall), 0.5);
    const share = room ? LOW : 0.5, spare = bottom - top - tall * this.zoom;
    this.x = (left + right) / 2 - ((first + last - this.width) / 2) / this.zoom;
    this.y = (low + high) / 2 + (top + share * spare + (tall * this.zoom) / 2 - this.height / 2) / this.zoom;
  }

  /** @type {(x: number, y: number) => Point} */
  toWorld(x, y) {
    return [this.x + (x - this.width / 2) / this.zoom, this.y - (y - this.height / 2) / this.zoom];
  }

  /** @type {(x: number, y: number) => Point} */
  toPixels(x, y) {
    return [this.width / 2 + (x - this.x) * this.zoom, this.height / 2 - (y - this.y) * this.zoom];
  }

  /** @type {(x: number, y: number, factor: number) => void} */
  zoomAbout(x, y, factor) {
    const [heldX, heldY] = this.toWorld(x, y);
    this.zoom = clamp(this.zoom * factor, 0.5, 20000);
    const [nowX, nowY] = this.toWorld(x, y);
    this.x += heldX - nowX;
    this.y += heldY - nowY;
  }
}
