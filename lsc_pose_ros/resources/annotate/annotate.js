// Copyright 2026 lsc_pose_ros contributors
// SPDX-License-Identifier: Apache-2.0

// The page of `lsc_pose annotate`: its keys, its buttons, and its beginning.

import { act, say } from './actions.js';
import { draw } from './drawing.js';
import { accept, copyPrevious, goTo, redo, refresh, show, step, undo } from './frames.js';
import {
  addBody, nudge, removeBody, removeJoint, select, setDepth, shiftDepth, toggleHidden,
} from './joints.js';
import { listenToPointer } from './pointer.js';
import { ask } from './requests.js';
import { element, jointOf, placeOf, state } from './state.js';
import { people, whole, zoom } from './view.js';

const CLOSER = 1.5;

function enlarge(factor) {
  const joint = jointOf(state.selected);
  zoom(factor, joint && joint.pixel);
  draw();
}
const VIEWS = {
  closer: () => enlarge(CLOSER),
  farther: () => enlarge(1 / CLOSER),
  people: () => { people(); draw(); },
  whole: () => { whole(); draw(); },
};

const KEYS = {
  Enter: accept, PageUp: () => step(-1), PageDown: () => step(1),
  ArrowLeft: (event) => nudge(event.shiftKey ? -10 : -1, 0),
  ArrowRight: (event) => nudge(event.shiftKey ? 10 : 1, 0),
  ArrowUp: (event) => nudge(0, event.shiftKey ? -10 : -1),
  ArrowDown: (event) => nudge(0, event.shiftKey ? 10 : 1),
  '+': () => shiftDepth(0.01), '-': () => shiftDepth(-0.01),
  h: toggleHidden, Delete: removeJoint, c: copyPrevious, a: addBody,
  i: VIEWS.closer, o: VIEWS.farther, p: VIEWS.people, w: VIEWS.whole,
  g: () => element('goto').select(),
};

document.addEventListener('keydown', (event) => {
  if ((event.ctrlKey || event.metaKey) && !event.altKey) {
    const key = event.key.toLowerCase();
    if (key !== 'z' && key !== 'y') return;
    event.preventDefault();
    act(key === 'y' || event.shiftKey ? redo : undo);
    return;
  }
  const action = KEYS[event.key] || KEYS[event.key.toLowerCase()];
  const isWriting = event.target.matches('input, select') && !event.key.startsWith('Page');
  const isPressing = event.target.matches('button, summary') && event.key === 'Enter';
  if (!action || event.altKey || isWriting || isPressing) return;
  event.preventDefault();
  act(() => action(event));
});

for (const [id, action] of Object.entries({
  previous: () => step(-1), next: () => step(1), accept, copy: copyPrevious, add: addBody,
  undo, redo, remove: removeJoint, removeBody, closer: VIEWS.closer, farther: VIEWS.farther,
  fit: VIEWS.people, whole: VIEWS.whole,
})) element(id).addEventListener('click', () => act(action));

element('finish').addEventListener('click', () => act(async () => {
  element('caption').textContent = 'The recording is being written.';
  const { text } = await ask('finish', {});
  draw();
  state.isWritten = true;
  for (const id of ['image', 'views', 'panel']) element(id).inert = true;
  say(`${text}. This page can be closed.`, true);
}));
element('joint').addEventListener('change', (event) => select(placeOf(event.target.value)));
element('goto').addEventListener('change', (event) => {
  const { value } = event.target;
  act(() => goTo(value));
});
element('depth').addEventListener('change', (event) => {
  const { value } = event.target;
  act(() => setDepth(value.trim() === '' ? NaN : Number(value)));
});
element('hidden').addEventListener('change', () => act(toggleHidden));
element('panel').addEventListener('submit', (event) => event.preventDefault());
window.addEventListener('resize', () => {
  if (state.picture) draw();
});
document.addEventListener('visibilitychange', () => {
  if (!document.hidden && state.picture) act(refresh);
});
listenToPointer();

act(async () => {
  state.recording = await ask('recording');
  document.title = `Annotate ${state.recording.name}`;
  element('name').textContent = state.recording.name;
  const open = state.recording.done.indexOf(false);
  await show(open < 0 ? 0 : open);
});
