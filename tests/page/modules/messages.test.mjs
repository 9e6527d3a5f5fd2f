import assert from 'node:assert/strict';
import test from 'node:test';
import { Messages, RANKS } from '../../../sandbox/page/web/messages.js';

const START = { tick: 100, gesture: 5, deed: 5, now: 10 };
/** One message of each rank that stands where others do. */
const all = () => {
  const messages = new Messages();
  for (const rank of Object.keys(RANKS).reverse()) messages.say({ rank, text: rank }, START);
  return messages;
};
const text = (messages, place = 'state') => messages.shown(place)?.text ?? null;

test('nothing that is said later takes the place of a verdict, and nothing ends it', () => {
  const messages = all();
  for (const rank of Object.keys(RANKS).filter((each) => each !== 'verdict')) messages.say({ rank, text: 'new' }, START);
  messages.end('tool');
  messages.end('jump');
  messages.follow({ tick: 0, gesture: 99, deed: 99, now: 1e9 });
  assert.equal(text(messages, 'verdict'), 'verdict');
  assert.equal(text(messages), null);
});

test('a higher rank is shown before a lower one, whichever was said first', () => {
  const messages = all();
  assert.equal(text(messages), 'fault');
  messages.end('jump');
  assert.equal(text(messages), 'rule');
  messages.follow({ ...START, tick: 99 });
  assert.equal(text(messages), 'tip');
  messages.end('tool');
  assert.equal(text(messages), null);
});

test('a refusal ends after some seconds, or when something is done after it', () => {
  for (const [moment, left] of [
    [{ ...START, now: 10 + RANKS.refusal.lasts - 0.1 }, 'no'],
    [{ ...START, now: 10 + RANKS.refusal.lasts }, null],
    [{ ...START, gesture: 7, deed: 5 }, 'no'],
    [{ ...START, gesture: 6, deed: 6 }, null],
  ]) {
    const messages = new Messages();
    messages.say({ rank: 'refusal', text: 'no' }, START);
    messages.follow(moment);
    assert.equal(text(messages), left);
  }
});

test('words of rules go with the moments at which they were said', () => {
  const messages = new Messages();
  messages.say({ rank: 'rule', text: 'The thread is cut.' }, { ...START, tick: 120 });
  messages.say({ rank: 'rule', text: 'The balloon is free.' }, { ...START, tick: 174 });
  assert.equal(text(messages), 'The balloon is free.');
  messages.follow({ ...START, tick: 150 });
  assert.equal(text(messages), 'The thread is cut.');
  messages.follow({ ...START, tick: 0 });
  assert.equal(text(messages), null);
});

test('what is refused in a panel stands there and not elsewhere', () => {
  const messages = new Messages();
  messages.say({ rank: 'rule', text: 'Go!' }, START);
  messages.say({ rank: 'refusal', text: 'no', place: 'panel' }, START);
  assert.deepEqual([text(messages), text(messages, 'panel')], ['Go!', 'no']);
});
