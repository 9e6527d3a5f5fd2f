// Types of the tables of Python. Made by `python -m sandbox.page.bundle`.
import type { Kit } from './types.js';
export interface StateArrays {
  position: Float64Array;
  velocity: Float64Array;
  origin: Float64Array;
  mass: Float64Array;
  inverse_mass: Float64Array;
  radius: Float64Array;
  gravity_scale: Float64Array;
  particle_active: Uint8Array;
  slow_velocity: Float64Array;
  energy_bank: Float64Array;
  friction: Float64Array;
  restitution: Float64Array;
  owner: Int32Array;
  group: BigInt64Array;
  collides: BigInt64Array;
  parting_reserve: Float64Array;
  angle: Float64Array;
  spin: Float64Array;
  rolls: Uint8Array;
  rolling: Float64Array;
  slow_change: Float64Array;
  unmoved: Uint8Array;
  untouchable: Uint8Array;
  unreturnable: Float64Array;
  split_from: Int32Array;
  particle_a: Int32Array;
  particle_b: Int32Array;
  rest_length: Float64Array;
  natural_length: Float64Array;
  stiffness: Float64Array;
  damping: Float64Array;
  law: Int8Array;
  hooke_stiffness: Float64Array;
  hooke_damping: Float64Array;
  material: Int32Array;
  spring_active: Uint8Array;
  impulse: Float64Array;
  tension: Float64Array;
  edge: Int8Array;
  lowest_mode: Float64Array;
  stiffness_now: Float64Array;
  damping_now: Float64Array;
  lowest_mode_now: Float64Array;
  ramp_ticks: Int32Array;
  belt: Float64Array;
  spring_untouchable: Uint8Array;
  is_split: Uint8Array;
  constraint_kind: Int8Array;
  constraint_first: Int32Array;
  constraint_corners: Int32Array;
  constraint_rest: Float64Array;
  constraint_stiffness: Float64Array;
  constraint_damping: Float64Array;
  constraint_material: Int32Array;
  constraint_active: Uint8Array;
  constraint_lowest_mode: Float64Array;
  constraint_stiffness_now: Float64Array;
  constraint_damping_now: Float64Array;
  constraint_lowest_mode_now: Float64Array;
  constraint_ramp_ticks: Int32Array;
  constraint_area_now: Float64Array;
  constraint_area_ticks: Int32Array;
  corner_particle: Int32Array;
  corner_weight: Float64Array;
  corner_form: Float64Array;
  actuator_value: Float64Array;
  actuator_impulse: Float64Array;
  contact_particle: Int32Array;
  contact_feature: BigInt64Array;
  contact_impulse: Float64Array;
  contact_impact: Float64Array;
  hand_strength: Float64Array;
  hand_radius: Float64Array;
  hand_force: Float64Array;
  setting_now: Float64Array;
  setting_ticks: Int32Array;
  rule_held: Int32Array;
  rule_fired: Int32Array;
  rule_first: BigInt64Array;
  rule_last: BigInt64Array;
  rule_due: Uint8Array;
  rule_stars: Int8Array;
  counter: Float64Array;
  probe_position: Float64Array;
  still_ticks: Int32Array;
  key_down: Uint8Array;
  deed_refused: Uint8Array;
  deed_budget: Int32Array;
}

export interface Commands {
  grab: {
    type: 'grab';
    grab: number;
    particle: number;
    target: [number, number];
    strength?: number;
    radius?: number;
  };
  move_grab: {
    type: 'move_grab';
    grab: number;
    target: [number, number];
  };
  release: {
    type: 'release';
    grab: number;
  };
  pin: {
    type: 'pin';
    particle: number;
  };
  unpin: {
    type: 'unpin';
    particle: number;
  };
  cut_springs: {
    type: 'cut_springs';
    springs: number[];
    at?: number[];
  };
  break_springs: {
    type: 'break_springs';
    springs: number[];
  };
  part_bodies: {
    type: 'part_bodies';
    springs: number[];
  };
  set_coefficients: {
    type: 'set_coefficients';
    stiffness?: number | null;
    damping?: number | null;
    material?: number | null;
    duration?: number;
  };
  set_gravity: {
    type: 'set_gravity';
    gravity: [number, number];
    duration?: number;
  };
  set_air: {
    type: 'set_air';
    wind?: [number, number] | null;
    drag?: number | null;
    duration?: number;
  };
  set_drive: {
    type: 'set_drive';
    part: number;
    value: number;
  };
  hold_key: {
    type: 'hold_key';
    key: number;
    down: boolean;
  };
  push: {
    type: 'push';
    position: [number, number];
    radius: number;
    impulse?: [number, number];
    outward?: number;
  };
  shake: {
    type: 'shake';
    acceleration: [number, number];
  };
  set_inflation: {
    type: 'set_inflation';
    body: number;
    value: number;
    duration?: number;
  };
  scale_mass: {
    type: 'scale_mass';
    particle: number;
    factor: number;
  };
  move_body: {
    type: 'move_body';
    particle: number;
    by: [number, number];
    at_rest?: boolean;
  };
  free: {
    type: 'free';
    particle: number;
  };
  set_firmness: {
    type: 'set_firmness';
    body: number;
    sag?: number | null;
    hz?: number | null;
    ratio?: number | null;
    duration?: number;
  };
  soften: {
    type: 'soften';
    body: number[];
    whole: number[];
    way: number[];
    duration: number[];
    value: number;
    second: number;
    gravity: number;
    nearest: number;
  };
  set_solver: {
    type: 'set_solver';
    solver?: 'single_pass' | 'iterative' | 'direct' | null;
    iterations?: number | null;
    substeps?: 1 | 2 | 4 | 8 | 16 | 32 | 64 | 'auto' | null;
    warm_start?: number | null;
    duration?: number;
  };
  add_particle: {
    type: 'add_particle';
    position: [number, number];
    mass?: number;
    radius?: number;
    pinned?: boolean;
    velocity?: [number, number] | null;
    friction?: number | null;
    restitution?: number | null;
  };
  add_spring: {
    type: 'add_spring';
    particle_a: number;
    particle_b: number;
    rest_length?: number | null;
    stiffness?: number;
    damping?: number;
  };
  remove: {
    type: 'remove';
    body?: string | null;
    particle?: number | null;
  };
  add_body: {
    type: 'add_body';
    kit: Kit;
  };
}
