// Copyright 2026 lsc_pose_ros contributors
// SPDX-License-Identifier: Apache-2.0

// One action after the other: a change is kept before the next one begins.

import { draw } from './drawing.js';
import { element, state } from './state.js';

let queue = Promise.resolve();
let waiting = 0;

function count(more) {
  waiting += more;
  element('image').setAttribute('aria-busy', String(waiting > 0));
}

// An action may return what there is to say, or throw it. Then fields and joints are drawn as they
// were, since nothing was kept.
export function act(action) {
  if (state.isWritten) return;
  count(1);
  queue = queue.then(action).then((text) => say(text || ''), (error) => {
    say(error.message);
    if (state.recording) draw();
  }).finally(() => count(-1));
}

export function say(text, good = false) {
  if (!text && element('message').classList.contains('good')) return;
  element('message').textContent = text;
  element('message').classList.toggle('good', good);
}
