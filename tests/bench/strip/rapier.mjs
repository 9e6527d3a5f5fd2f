// Runs a scene in Rapier: JSON on standard input, JSON on standard output. `rapier.py` calls it.
//
//     node rapier.mjs FOLDER < scene.json      FOLDER has node_modules with @dimforge/rapier2d-compat
import { readFileSync } from "node:fs";
import { createRequire } from "node:module";
import { join } from "node:path";

const RAPIER = createRequire(join(process.argv[2], "package.json"))("@dimforge/rapier2d-compat");
// The package warns of its own start.
console.warn = () => {};
await RAPIER.init();

function build({ position, mass, pinned, links, gravity, moment, method }) {
  const world = new RAPIER.World({ x: 0, y: -gravity });
  const bodies = position.map(([x, y], k) => {
    const body = pinned[k] ? RAPIER.RigidBodyDesc.fixed() : RAPIER.RigidBodyDesc.dynamic();
    body.setTranslation(x, y).setCanSleep(false);
    if (!pinned[k]) body.setAdditionalMassProperties(mass[k], { x: 0, y: 0 }, moment);
    return world.createRigidBody(body);
  });
  for (const [a, b] of links) {
    const back = { x: position[a][0] - position[b][0], y: position[a][1] - position[b][1] };
    const joint = RAPIER.JointData.revolute({ x: 0, y: 0 }, back);
    const create = method === "multibody" ? "createMultibodyJoint" : "createImpulseJoint";
    world[create](joint, bodies[a], bodies[b], true);
  }
  return { world, bodies };
}

const scene = JSON.parse(readFileSync(0, "utf8"));
const seconds = [];
let places = [];
for (let run = 0; run < scene.runs; run++) {
  const { world, bodies } = build(scene);
  const times = [];
  for (let frame = 0; frame < scene.frames; frame++) {
    const began = process.hrtime.bigint();
    world.step();
    times.push(Number(process.hrtime.bigint() - began) / 1e9);
  }
  places = bodies.map((body) => [body.translation().x, body.translation().y]);
  seconds.push(times);
  world.free();
}
console.log(JSON.stringify({ version: RAPIER.version(), seconds, places }));
