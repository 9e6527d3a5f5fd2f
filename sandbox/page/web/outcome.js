// Outcome: which rules fired, whether a level is won or lost, and how many stars that earns.
/** @import { Action, Outcome } from './types.js' */
/** @import { World } from './world.js' */

const MOST_STARS = 3;

/** How many stars a win at the end of a tick earns, as session/outcome.py has it.
 * @type {(world: World, action: Action, tick: number) => number} */
export function starsOf(world, { stars }, tick) {
  if (!stars) return MOST_STARS;
  const { counter, second, third } = stars;
  const value = counter === null ? tick / world.settings().tick_rate : world.view('state.counter')[counter];
  return 1 + [second, third].filter((bound) => (third > second ? value >= bound : value <= bound)).length;
}

/** The actions of the rules that fired in the last tick.
 * @type {(world: World, rules: Action[][]) => Action[]} */
export function firedIn(world, rules) {
  return rules.flatMap((actions, rule) => (Number(world.view('state.rule_last')[rule]) === world.time ? actions : []));
}

/** Whether a level is won or lost; null: neither yet. The rule that fired first counts, of two in one tick the one that
 * stands first in the file.
 * @type {(world: World, rules: Action[][]) => Outcome | null} */
export function outcomeOf(world, rules) {
  const first = world.view('state.rule_first'), stars = world.view('state.rule_stars');
  /** @type {Outcome | null} */
  let found = null;
  rules.forEach((actions, rule) => {
    const tick = Number(first[rule]), action = actions.find((each) => each.win !== undefined || each.fail !== undefined);
    if (tick < 0 || !action || (found && found.tick <= tick)) return;
    const isWon = action.win !== undefined, earned = isWon ? stars[rule] || starsOf(world, action, tick) : 0;
    found = { isWon, text: action.win ?? action.fail ?? '', stars: earned, tick };
  });
  return found;
}
