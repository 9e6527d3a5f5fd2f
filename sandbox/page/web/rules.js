// Rules: what a level's rules do once they have fired, and how a run ended for who plays it.
import { Refusal } from './commands.js';
/** @import { About, Action, Command, Outcome } from './types.js' */
/** @import { World } from './world.js' */

const MOST_STARS = 3;

/** What rules that fired in the last tick do, as session/actions.py has it; what cannot be done is left out.
 * @type {(world: World, about: About) => void} */
export function act(world, { rules, givers }) {
  rules.forEach((actions, rule) => {
    if (!world.view('state.rule_due')[rule]) return;
    world.view('state.rule_due')[rule] = 0;
    for (const action of actions) {
      const stars = world.view('state.rule_stars'), { count, by = 1, commands = [] } = action;
      if (action.win !== undefined && !stars[rule]) {
        stars[rule] = starsOf(world, action, Number(world.view('state.rule_first')[rule]));
      }
      if (count !== undefined) world.view('state.counter')[count] += by;
      commands.forEach((command) => actBy(world, command, givers.RULE));
    }
  });
}

/** @type {(world: World, command: Command, giver: number) => void} */
function actBy(world, command, giver) {
  const record = command.type === 'cut_springs' ? { ...command,
    springs: command.springs.filter((spring) => world.isInUse('spring', spring)) } : command;
  if (record.type === 'cut_springs' && !record.springs.length) return;
  try {
    world.command(record, giver);
  } catch (error) {
    if (!(error instanceof Refusal)) throw error;
  }
}

/** How many stars a win at the end of a tick earns, as session/outcome.py has it.
 * @type {(world: World, action: Action, tick: number) => number} */
function starsOf(world, { stars }, tick) {
  if (!stars) return MOST_STARS;
  const { counter, second, third } = stars;
  const value = counter === null ? tick / world.settings().tick_rate : world.view('state.counter')[counter];
  return 1 + [second, third].filter((bound) => (third > second ? value >= bound : value <= bound)).length;
}

/** The actions of the rules that fired in the last tick.
 * @type {(world: World) => Action[]} */
export const fired = (world) => world.rules.flatMap((actions, rule) =>
  (Number(world.view('state.rule_last')[rule]) === world.time ? actions : []));

/** Whether the level is won or lost; null: neither yet. The rule that fired first counts, of two in one tick the one that
 * stands first in the file.
 * @type {(world: World) => Outcome | null} */
export function outcome(world) {
  const first = world.view('state.rule_first'), stars = world.view('state.rule_stars');
  /** @type {Outcome | null} */
  let found = null;
  world.rules.forEach((actions, rule) => {
    const tick = Number(first[rule]), action = actions.find((each) => each.win !== undefined || each.fail !== undefined);
    if (tick < 0 || !action || (found && found.tick <= tick)) return;
    const isWon = action.win !== undefined;
    found = { isWon, text: action.win ?? action.fail ?? '', stars: isWon ? stars[rule] || starsOf(world, action, tick) : 0,
      tick, rule };
  });
  return found;
}
