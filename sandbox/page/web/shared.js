// Shared: values that the window goes by too. Made by `python -m sandbox.app.site.shared_values`.
export const RECORDING = {
  TICK_DIGITS: 16,
  ARRAY_DIGITS: 6,
  STATE_TICKS: 600,
  CHAIN_DIGITS: 8,
};
export const LINK = {
  MARK: 'scene=',
  BEAT: 'beat=',
  VERSION: 2,
  LONGEST: 32000,
  UNPACKED_LIMIT: 4194304,
  RUN_LIMIT: 216000,
  COMMAND_LIMIT: 200000,
  FARTHEST: 549755813888,
  PER_METRE: 1000,
  HANDS: 10,
  MOVE: 'move_grab',
};
export const CHECKS = {
  STILL: 0.05,
  STRAIN_WINDOW: 2,
};
export const TUNING = {
  KINDS: ['set_coefficients', 'set_firmness', 'set_inflation', 'set_gravity', 'set_air', 'set_solver'],
  SUBJECTS: ['material', 'body'],
};
export const PACE = {
  LONGEST: 0.1,
  BUDGET: 0.05,
};
export const HANDS = {
  STRENGTH: 100,
  SOFT_REACH: 2,
  AT_LIMIT: 0.99,
  PICK_RADIUS: 14,
  UNITS: [[1000000000, 'GN'], [1000000, 'MN'], [1000, 'kN'], [1, 'N'], [0.001, 'mN']],
  TIME_STANDS: 'Time stands: here a hand only pulls, once time goes on (Space).',
  SOLID: 2,
  SHARES: 100000,
};
export const GAMEPAD = {
  ACROSS: [['a', 'd'], ['left', 'right']],
  UPWARDS: [['s', 'w'], ['down', 'up']],
  BUTTONS: ['A', 'B', 'X', 'Y'],
  PRESSES: 0.5,
  LETS_GO: 0.35,
};
export const MAKING = {
  SEGMENTS: 12,
  ROPE_MASS: 2,
  SHARE: 0.3,
  PIN_RADIUS: 0.05,
  PIN_SHARE: 0.05,
  TOO_SHORT: 'Drag from one thing to another, or to the air: what you let go of in the air is pinned there.',
  ROPE_RADIUS: 0.05,
  HAND_TOLERANCE: 0.12,
  SKIN: 0.15,
  THICKEST: 0.05,
  REFUSALS: ['', 'Draw a larger outline: press, draw around, and let go.', 'The outline crosses or touches itself. Draw it without.', 'This outline is too fine for triangles to fit in. Draw it simpler, or wider where it is thin.'],
};
export const MESH = {
  NUMBERS: 1,
  PLACES: 3,
  TRIANGLES: 5,
  PAIRS: 7,
};
export const PAD = {
  NUMBERED: [1e-05, 0.0001, 0.001, 0.003, 0.01, 0.03, 0.1, 0.3, 0.5, 0.7, 0.9, 0.97, 0.99, 0.997, 0.999, 1],
  DIGITS: 3,
  END: 0.997,
  LOWEST: 0.003,
  REST: 0.02,
  RIGID: 'rigid',
  UNSEEN: 1e-05,
};
export const SOLVING = {
  LABELS: {'single_pass': 'Single pass', 'iterative': 'Iterative', 'direct': 'Direct'},
  TIPS: {'single_pass': 'The article\'s loop: solves each spring once a tick; stiff things may explode', 'iterative': 'Solves each spring several times a tick; more iterations make things firmer', 'direct': 'Solves all springs at once; stiff things stay stiff and nothing explodes'},
};
export const SOUND = {
  SOFTEST: 0.35,
  HARDEST: 9,
  NEWS: 1.5,
  MEMORY: 0.25,
  MOST: 4,
  JERK: 1,
  HARD_JERK: 8,
  TUNED: 24,
  HIGHEST_STRING: 700,
  SNAP_PITCH: 420,
  MOTOR_PITCH: 70,
  MOTOR_RISE: 9,
  SOFT_SPLASH: 0.7,
  HARD_SPLASH: 7,
  SPLASH_PITCH: 260,
  SCALE: [0, 2, 4, 7, 9],
  LOWEST: 65.41,
  STEPS: 26,
  VOICES: 12,
  REST: 0.09,
  MOTOR_FADE: 0.12,
  WIDTH: 0.7,
  LEVELS: {'thud': 0.8, 'splash': 0.5, 'pluck': 0.45, 'snap': 0.85, 'squeak': 0.16, 'motor': 0.22},
};
export const THINGS = {
  STRANDS: ['rope', 'cable', 'chain', 'deck', 'thread', 'silk'],
  WORKING: ['coil', 'muscle', 'piston'],
  LAID: ['wood', 'stone', 'brick'],
  HANGER: 0.62,
  TRUSS: [0.11, 1.6, 4.2],
  MESH: [0.075, 1, 3.4],
  LOOSE: [0.1, 1.2, 2.6],
  BRACE: 0.62,
};
export const STRAIN = {
  FLUSH_FROM: 0.03,
  FLUSH_RANGE: 0.22,
  LEAST_FLUSH: 0.02,
};
export const LINES = {
  HALF: {'rope': 3.4, 'cable': 2.6, 'chain': 4.6, 'deck': 6, 'thread': 1.2, 'silk': 0.9},
  PERIOD: {'chain': 5.6, 'deck': 2},
  USUAL_PERIOD: 6.5,
  MOST_OF_STEP: 0.45,
  LEAST: 0.55,
  LEAST_BEND: 2.5,
  PLANKS: 3,
  BOLTS_FROM: 9,
  CYLINDER: '#f6b83e',
};
export const SHAPES = {
  LEAST_ROUNDING: 6,
  MOST_ROUNDING: 34,
  MOST_GROWN: 40,
  LINE_HALF: 0.75,
  CLOTH_TEXELS: 16,
  LAID_TEXELS: 14,
  HEM_HALF: 1.5,
};
export const TREADS = {
  STRAP_HALF: 3.6,
  CHEVRON: 2.6,
  CHEVRON_HALF: 0.85,
  SIDE: 0.5,
  APART: 20,
  MOST_PASSING: 24,
  LEAST_APART: 0.001,
  BESIDE: 40,
  COLOUR: '#ffcf4d',
};
export const WHEELS = {
  RIM_FROM: 14,
  LUGS_FROM: 22,
  LUG: 0.075,
};
export const WATER = {
  CLEAR: 0.36,
  MURKY: 0.66,
  DEEP: 3,
  NEAR: 0.3,
  SLOWEST: 0.06,
  PER_SPEED: 0.03,
  HIGHEST: 0.1,
  LENGTH: 0.7,
  PERIOD: 0.75,
  FADE: 0.9,
  MOST: 24,
  STEP: 4,
  LINE_HALF: 1.1,
  LIGHT: 9,
  STREAKS: 18,
  STREAK: 0.5,
  SPLASH: 0.9,
  DROPS_A_SPEED: 2,
  FASTEST_DROP: 5,
  FALL: 9.8,
  PLACES: 16,
  MOST_DROPS: 200,
  DROP_LIFE: [0.35, 0.8],
};
export const FACES = {
  LARGEST: 120,
  SMALLEST: 24,
  SQUEEZED: 0.1,
  FAST: 2.5,
  BLINK: 0.13,
  BLINK_EVERY: 3.4,
  MOST_COMPARED: 1000000,
  TONGUE: '#f0708a',
};
export const COLOURS = {
  SQUEEZED: '#4a3fd8',
  STRETCHED: '#fff0b0',
  SANDS: ['#f2c879', '#e3ae58', '#f7da9a', '#d99a4a'],
};
export const RELEASE = {
  NUMBER: 14,
  RATE: 4,
  DONE: 5,
  HELD: 6,
  REST: 11,
  COUNT: 12,
  ERRORS: 17,
  MOST_SECONDS: 30,
  STEP: 0,
  BEGIN: 1,
  LET_GO: 3,
  FREE: 4,
  FOUND: 5,
};
export const RESPONSE = {
  TICK: 0,
  OVERSHOOT: 1,
  SETTLING: 2,
  SWINGS: 3,
  STIFFNESS: 4,
  DAMPING: 5,
  FREQUENCY: 6,
  RATIO: 7,
  DIFFERENCE: 8,
  RESPONSE: 9,
  SETTLED: 0.02,
};
export const SEARCH = {
  TRIED: 5,
  HAS: 7,
  GOT: 8,
  MISSED: 12,
  BEST_ROUND: 15,
  ROUND: 16,
  SOONEST: 17,
  SEARCH: 34,
  SOUGHT: 10,
  TRY: 0,
  OVER: 1,
};
export const FEEL = {
  HOOKE: 1,
  REASONS: {'-1': 'nothing of it is free to move', '-2': 'nothing holds it: pin it, or let it lie on something first', '-3': 'it has no size, or the way to pull it has no length', '6': 'it still moves after {seconds} s, or something else does: let all come to rest first', '7': 'it does not come back: let go, it goes further than it was pulled', '8': 'it does not come back: {left} % of the way is left, at rest, after {seconds} s'},
  CSS: 'transition: transform {milliseconds}ms linear({stops});',
  ALL_HOOKE: 'its springs are classic Hooke springs, which have no Cs and Cd',
  FEELS: [[0, 'It glides home: no overshoot, still after {time}.'], [0.05, 'It is firm: overshoots by {overshoot}, still after {time}.'], [0.3, 'It is springy: overshoots by {overshoot}, still after {time}.'], [2, 'It is bouncy: overshoots by {overshoot}, still after {time}.']],
  REFUSALS: {'3': 'an overshoot is from 0 up to 100 %, and settling takes more than two ticks', '4': 'no spring that swings so far settles before {} s here'},
  AS_ASKED: 0.02,
  CLOSEST: 'the closest that was found: {}, of {} asked',
  PAIR: '{} for the springs of {}',
  PAIR_OF_ALL: '{} for all springs',
  HINT: 'Drag the peak or the end of the curve, or type: then Cs and Cd are looked for.',
  NO_HANDS: 'Hands may not change springs in this level.',
  MEASURING: 'Measuring it: pulled in a copy of the run, held, and let go.',
  LOOKING: 'Looking for Cs and Cd.',
  WAYS: ['down', 'aside'],
};
