// Paint: colours, lit skins, bars and balls on a canvas. All sizes are pixels of the page.

const parse = (colour) => [1, 3, 5].map((at) => parseInt(colour.slice(at, at + 2), 16));
// The colour that has `share` (0..1) of the second in it; colours are '#rrggbb'.
export function mixed(first, second, share) {
  const other = parse(second), mix = parse(first).map((value, k) => Math.round(value + (other[k] - value) * share));
  return `#${mix.map((value) => value.toString(16).padStart(2, '0')).join('')}`;
}

export const outlineOf = (colour) => mixed(colour, '#28003c', 0.46);
export const darkEdge = (colour) => mixed(colour, '#180a00', 0.66);

// Of each skin: how light and how dark it gets, with what, how it gleams, and how little shows through.
const SKINS = {
  jelly: ['#ffffff', 0.62, '#5a0a6e', 0.4, 0.75, 0.9], balloon: ['#ffffff', 0.5, '#3c0046', 0.42, 0, 0.9],
  tyre: ['#ffffff', 0.3, '#000000', 0.6, 0.15, 1], window: ['#ffffff', 0.7, '#3c6e96', 0.4, 0.5, 0.92],
  wood: ['#ffffff', 0.25, '#1e0a00', 0.45, 0, 1], stone: ['#ffffff', 0.25, '#1e0a00', 0.45, 0, 1],
  brick: ['#ffffff', 0.25, '#1e0a00', 0.45, 0, 1], rubber: ['#ffffff', 0.32, '#140028', 0.38, 0.15, 1],
};
// Light and shade of a skin are thin crescents laid over each other: one for so many pixels of its depth, so many at
// most, and how far inwards they reach, in depths.
const CRESCENT = 2.5, MOST_CRESCENTS = 9, REACH = 1.2;

// Closed loops of points [x, y, ...] as one path, with their corners cut by `keep` of their sides.
export function pathOf(loops, keep = 0, rounds = 0) {
  const path = new Path2D(), cut = rounds ? Math.min(2 * keep, 0.5) : 0;
  for (const points of loops) {
    const count = points.length / 2;
    for (let k = 0; k < count; k++) {
      const x = points[2 * k], y = points[2 * k + 1], before = 2 * ((k + count - 1) % count),
        after = 2 * ((k + 1) % count);
      const startX = x + (points[before] - x) * cut, startY = y + (points[before + 1] - y) * cut;
      if (k === 0) path.moveTo(startX, startY);
      else path.lineTo(startX, startY);
      if (cut) path.quadraticCurveTo(x, y, x + (points[after] - x) * cut, y + (points[after + 1] - y) * cut);
    }
    path.closePath();
  }
  return path;
}

// Points of a loop moved outwards by so much.
export function grown(points, by) {
  const count = points.length / 2, result = new Float64Array(points.length);
  let area = 0;
  for (let k = 0; k < count; k++) {
    const next = (k + 1) % count;
    area += points[2 * k] * points[2 * next + 1] - points[2 * next] * points[2 * k + 1];
  }
  const side = area > 0 ? by : -by;
  for (let k = 0; k < count; k++) {
    const before = 2 * ((k + count - 1) % count), after = 2 * ((k + 1) % count);
    const dx = points[after] - points[before], dy = points[after + 1] - points[before + 1],
      length = Math.hypot(dx, dy) || 1;
    result[2 * k] = points[2 * k] + (dy / length) * side;
    result[2 * k + 1] = points[2 * k + 1] - (dx / length) * side;
  }
  return result;
}

// Fill a path with a skin that bulges: `depth` is how far its edge is rounded. over: what is drawn on it, unlit.
export function fillSkin(context, path, box, skin, colour, depth, over) {
  const [light, up, shade, down, gloss, alpha] = SKINS[skin] ?? SKINS.rubber;
  context.save();
  context.globalAlpha = alpha;
  context.fillStyle = colour;
  context.fill(path, 'evenodd');
  context.clip(path, 'evenodd');
  over?.();
  crescents(context, path, box, light, 0.8 * up, 0.22 * depth, 0.8 * depth);
  crescents(context, path, box, shade, down, -0.22 * depth, -0.8 * depth);
  if (gloss && depth > 5) {
    const gleam = new Path2D();
    gleam.addPath(path, new DOMMatrix([1, 0, 0, 1, 0.12 * depth, 0.3 * depth]));
    context.clip(gleam);
    crescents(context, gleam, box, '#ffffff', 0.8 * gloss, 0.14 * depth, 0.5 * depth);
  }
  context.restore();
}

// What of a clipped path is within so much of its edge, on the side from which light comes; box: around the path.
function crescents(context, path, box, colour, strength, x, y) {
  const count = Math.min(Math.max(Math.round(Math.hypot(x, y) / CRESCENT), 2), MOST_CRESCENTS);
  context.fillStyle = colour;
  context.globalAlpha = Math.min((1.5 * strength) / count, 1);
  for (let k = 1; k <= count; k++) {
    const share = REACH * (k / count) ** 1.3, moved = new Path2D();
    moved.rect(...box);
    moved.addPath(path, new DOMMatrix([1, 0, 0, 1, share * x, share * y]));
    context.fill(moved, 'evenodd');
  }
}

// Fill a path with ground: from `near` its edge to `deep` inside.
export function fillGround(context, path, box, near, deep, depth, light, dark, alpha = 1, grain = null) {
  context.save();
  context.globalAlpha = alpha;
  context.fillStyle = deep;
  context.fill(path);
  context.clip(path);
  context.strokeStyle = near;
  for (let k = 10; k > 0; k--) {
    context.globalAlpha = 0.16 * alpha;
    context.lineWidth = 0.22 * k * depth;
    context.stroke(path);
  }
  crescents(context, path, box, '#ffffff', 0.8 * light, 0.1 * depth, 0.3 * depth);
  crescents(context, path, box, '#000000', 0.8 * dark, -0.1 * depth, -0.3 * depth);
  context.globalAlpha = 1;
  if (grain) {
    context.fillStyle = context.createPattern(grains(grain), 'repeat');
    context.fill(path);
  }
  context.restore();
}

// Of each kind of line: its outline, its colour, a pattern: [colour, part of the width, dash, gap in half widths].
const LINES = {
  rope: ['#5b3d20', '#c89b62', ['#80542c', 0.9, 0.9, 2.3]], cable: ['#3a4252', '#a3adbf', ['#5c667a', 0.9, 0.6, 1.5]],
  deck: ['#4a2e16', '#c48e58', ['#4a2e16', 1, 0.25, 1.75]],
  thread: [null, '#aeb5c2', null], silk: [null, '#ccd4e0', null], steel: ['#161b26', '#96a3ba', null],
  brass: ['#3a2a10', '#e2b04e', null], wood: ['#3a2614', '#c99258', null], rubber: ['#3a1418', '#eb605c', null],
  bone: ['#4a3a28', '#f0e4cc', null], muscle: ['#4a1622', '#de5462', null], piston: ['#161b26', '#96a3ba', null],
};

// Draw a path as a round bar of a kind; colour: of what is painted, and of bars of no kind.
export function drawBar(context, path, half, kind, colour) {
  if (kind === 'chain') {
    drawChain(context, path, half);
    return;
  }
  const [line, own, pattern] = LINES[kind] ?? [outlineOf(colour), colour, null];
  context.lineCap = context.lineJoin = 'round';
  if (line && half > 0.7) stroke(context, path, line, half + 0.9, 0.85);
  stroke(context, path, own, half);
  if (half < 1.2) return;
  if (pattern) {
    const [tone, width, dash, gap] = pattern;
    context.setLineDash([dash * half, gap * half]);
    context.lineCap = 'butt';
    stroke(context, path, tone, width * half);
    context.setLineDash([]);
    context.lineCap = 'round';
  }
  context.save();
  context.translate(-0.12 * half, -0.36 * half);
  stroke(context, path, '#ffffff', 0.26 * half, 0.36);
  context.restore();
}

// Links on edge, thin, and between them links seen flat.
function drawChain(context, path, half) {
  stroke(context, path, '#1c222e', 0.45 * half, 0.7);
  stroke(context, path, '#b0bccd', 0.3 * half);
  context.setLineDash([1.8 * half, 3.8 * half]);
  stroke(context, path, '#1c222e', 0.95 * half, 0.7);
  stroke(context, path, '#b0bccd', 0.8 * half);
  stroke(context, path, '#1c222e', 0.34 * half);
  context.setLineDash([]);
}

export function stroke(context, path, colour, half, alpha = 1) {
  context.globalAlpha = alpha;
  context.strokeStyle = colour;
  context.lineWidth = 2 * half;
  context.stroke(path);
  context.globalAlpha = 1;
}

export function disc(context, x, y, radius, colour, alpha = 1) {
  context.globalAlpha = alpha;
  context.fillStyle = colour;
  context.beginPath();
  context.arc(x, y, radius, 0, 2 * Math.PI);
  context.fill();
  context.globalAlpha = 1;
}

// Noise that tiles, of patches about `reach` texels wide.
function noise(size, reach) {
  let values = Float32Array.from({ length: size * size },
    ((seed) => () => (seed = (seed * 16807) % 2147483647) / 1073741824 - 1)(7));
  for (const step of [1, size, 1, size]) {
    const at = (k, by) =>
      (step === 1 ? (k & ~(size - 1)) | ((k + by) & (size - 1)) : (k + by * size) & (size * size - 1));
    const smooth = values.slice();
    for (let k = 0; k < values.length; k++) {
      let sum = 0;
      for (let by = -reach; by <= reach; by++) sum += values[at(k, by)];
      smooth[k] = sum / (2 * reach + 1);
    }
    values = smooth;
  }
  const spread = Math.sqrt(values.reduce((sum, value) => sum + value * value, 0) / values.length);
  return values.map((value) => value / spread);
}

// The grain of earth or wood: what is lighter and darker of it, as a picture to lay over.
function grains(kind) {
  return sprite(`grain ${kind}`, 256, (own) => {
    const size = 256, picture = own.createImageData(size, size), fine = noise(size, 2), coarse = noise(size, 9),
      wide = noise(size, 16);
    for (let k = 0; k < size * size; k++) {
      const x = ((k & 255) * Math.PI) / 128, y = ((k >> 8) * Math.PI) / 128, bent = 0.6 * Math.sin(x) + 0.3 * wide[k];
      const earth = 1.2 * fine[k] + 1.8 * coarse[k] + 4 * Math.tanh(2 * Math.sin(4 * y + 1.6 * bent))
        + (fine[k] > 3.6 ? 18 : fine[k] < -3.6 ? -15 : 0);
      const wood = 5 * Math.sin(18 * y + 1.5 * Math.sin(x)) + 3 * Math.sin(46 * y + Math.sin(2 * x)) + fine[k];
      const value = kind === 'wood' ? wood : earth;
      picture.data.fill(value > 0 ? 255 : 0, 4 * k, 4 * k + 3);
      picture.data[4 * k + 3] = Math.min(Math.abs(value) * (value > 0 ? 1.7 : 2.4), 90);
    }
    own.putImageData(picture, 0, 0);
  });
}

// A piece of turf that tiles, as long as 64 texels and 24 high; its middle lies on the ground.
export function turfOf(context, [light, dark]) {
  return context.createPattern(sprite(`turf ${light}`, 64, (own) => {
    own.setTransform(1, 0, 0, 1, 0, 0);
    const fade = own.createLinearGradient(0, 0, 0, 24);
    fade.addColorStop(0, light);
    fade.addColorStop(1, dark);
    own.fillStyle = fade;
    for (let x = 0; x < 64; x++) {
      const u = ((x + 0.5) / 64) * Math.PI;
      const top = -0.45 + 0.38 * Math.abs(Math.sin(5 * u)) + 0.16 * Math.sin(6 * u + 0.7),
        low = 0.52 + 0.2 * Math.sin(4 * u + 0.5) + 0.1 * Math.sin(10 * u);
      own.fillRect(x, 12 + 12 * top, 1, 12 * (low - top));
    }
  }), 'repeat');
}

const sprites = new Map();

function sprite(name, size, draw) {
  if (!sprites.has(name)) {
    const canvas = document.createElement('canvas');
    canvas.width = canvas.height = size;
    const context = canvas.getContext('2d');
    context.scale(size / 2, size / 2);
    context.translate(1, 1);
    draw(context);
    sprites.set(name, canvas);
  }
  return sprites.get(name);
}

// A disc of a colour that fades out towards its rim.
export function glow(context, x, y, radius, colour, alpha) {
  const picture = sprite(`glow ${colour}`, 64, (own) => {
    const fade = own.createRadialGradient(0, 0, 0, 0, 0, 1);
    for (let k = 0; k <= 8; k++) {
      const fall = 1 - k / 8, share = fall * fall * (3 - 2 * fall);
      fade.addColorStop(k / 8, colour + Math.round(255 * share).toString(16).padStart(2, '0'));
    }
    own.fillStyle = fade;
    own.fillRect(-1, -1, 2, 2);
  });
  context.globalAlpha = alpha;
  context.drawImage(picture, x - radius, y - radius, 2 * radius, 2 * radius);
  context.globalAlpha = 1;
}

const MARKS = {
  stripe: (own) => own.fillRect(-1, -0.26, 2, 0.52),
  sand: (own) => own.fillRect(-1, -0.26, 2, 0.52),
  marble: (own) => {
    own.lineWidth = 0.4;
    own.beginPath();
    own.moveTo(-1, 0.12);
    own.bezierCurveTo(-0.5, 0.8, 0.5, -0.8, 1, -0.12);
    own.stroke();
  },
  steel: (own) => {
    own.lineWidth = 0.1;
    own.globalAlpha = 0.5;
    own.beginPath();
    own.arc(0, 0, 0.62, 0, 7);
    own.stroke();
    own.globalAlpha = 1;
    own.beginPath();
    own.arc(0.62, 0, 0.13, 0, 7);
    own.fill();
  },
};
const MARK_COLOURS = { steel: '#39435a', sand: '#b97f3a' };

// A ball of a kind, lit from above, with its mark turned by an angle (anticlockwise).
export function ball(context, x, y, radius, angle, kind, colour) {
  if (radius < 3) {
    disc(context, x, y, radius, colour);
    return;
  }
  const turning = sprite(`ball ${kind} ${colour}`, 128, (own) => {
    own.beginPath();
    own.arc(0, 0, 0.98, 0, 7);
    own.clip();
    own.fillStyle = colour;
    own.fillRect(-1, -1, 2, 2);
    own.fillStyle = own.strokeStyle = MARK_COLOURS[kind] ?? '#ffffff';
    MARKS[kind]?.(own);
  });
  const light = sprite('light', 128, (own) => {
    own.beginPath();
    own.arc(0, 0, 0.98, 0, 7);
    own.clip();
    const shade = own.createRadialGradient(-0.3, -0.45, 0, -0.1, -0.15, 1.12);
    [[0, '#ffffff38'], [0.35, '#ffffff08'], [0.6, '#00000028'], [0.85, '#0000006a'],
      [1, '#00000080']].forEach((stop) => shade.addColorStop(...stop));
    own.fillStyle = shade;
    own.fillRect(-1, -1, 2, 2);
    const gleam = own.createRadialGradient(-0.38, -0.5, 0, -0.38, -0.5, 0.3);
    [[0, '#ffffffd0'], [0.5, '#ffffff60'], [1, '#ffffff00']].forEach((stop) => gleam.addColorStop(...stop));
    own.fillStyle = gleam;
    own.fillRect(-1, -1, 2, 2);
  });
  context.save();
  context.translate(x, y);
  context.rotate(-angle);
  context.drawImage(turning, -radius, -radius, 2 * radius, 2 * radius);
  context.rotate(angle);
  context.drawImage(light, -radius, -radius, 2 * radius, 2 * radius);
  context.restore();
}

// A square of cloth, planks, stones or bricks as a pattern of 64 texels.
export function sheetOf(context, skin, colour) {
  const picture = sprite(`sheet ${skin} ${colour}`, 64, (own) => {
    own.setTransform(1, 0, 0, 1, 0, 0);
    own.fillStyle = colour;
    own.fillRect(0, 0, 64, 64);
    if (skin === 'cloth') {
      own.fillStyle = '#f3e6cd';
      own.fillRect(0, 0, 20, 64);
      for (let x = 0; x < 64; x++) {
        const fold = 0.2 * Math.sin((x * Math.PI) / 32);
        own.fillStyle = fold > 0 ? `rgb(255 255 255 / ${fold})` : `rgb(0 0 0 / ${-fold})`;
        own.fillRect(x, 0, 1, 64);
      }
      own.fillStyle = 'rgb(0 0 0 / 0.06)';
      for (let k = 0; k < 1024; k += 2) own.fillRect(2 * ((k & 31) + ((k >> 5) & 1)), 2 * (k >> 5), 2, 2);
      return;
    }
    const isWood = skin === 'wood';
    for (let row = 0; row < 4; row++) {
      for (let k = 0; k < (isWood ? 1 : 2); k++) {
        const x = isWood ? (row % 2) * 32 : (row % 2) * 16 + 32 * k;
        own.fillStyle = isWood ? mixed(colour, '#000000', 0.36) : mixed(colour, '#b4b4b4', 0.5);
        own.fillRect(0, 16 * row, 64, isWood ? 1 : 2);
        own.fillRect(x, 16 * row, isWood ? 1 : 2, 16);
        if (isWood) own.fillRect((x + 3) % 64, 16 * row + 7, 3, 3);
      }
      own.fillStyle = row % 2 ? '#ffffff14' : '#00000012';
      own.fillRect(0, 16 * row + 1, 64, 15);
    }
  });
  return context.createPattern(picture, 'repeat');
}
