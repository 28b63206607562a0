// Copyright 2026 lsc_pose_ros contributors
// SPDX-License-Identifier: Apache-2.0

// Drags joints, and moves and enlarges the image.

import { act } from './actions.js';
import { circleOf, draw } from './drawing.js';
import { move, select } from './joints.js';
import { element, isSelected, placeOf, wordOf } from './state.js';
import { applyView, pan, zoom } from './view.js';

const WHEEL = 0.002;             // of the logarithm of the size, per pixel of the wheel
const LINE = 20;                 // pixels, for wheels that count lines

let isDragging = false;

function pixelAt(event) {
  const matrix = element('image').getScreenCTM().inverse();
  const point = new DOMPoint(event.clientX, event.clientY).matrixTransform(matrix);
  return [point.x, point.y];
}

function followPointer(follow, end) {
  isDragging = true;
  const ends = new AbortController();
  window.addEventListener('pointermove', follow, ends);
  for (const name of ['pointerup', 'pointercancel']) {
    window.addEventListener(name, () => {
      isDragging = false;
      ends.abort();
      end();
    }, ends);
  }
}

function dragJoint(place) {
  select(place);
  circleOf(wordOf(place)).focus({ preventScroll: true });
  let pixel = null;
  followPointer((event) => {
    pixel = pixelAt(event);
    // The ring is drawn before the joint; another action may draw both anew meanwhile.
    for (const circle of [circleOf(wordOf(place)), ...document.querySelectorAll('.ring')]) {
      if (!circle) continue;
      circle.setAttribute('cx', pixel[0]);
      circle.setAttribute('cy', pixel[1]);
    }
  }, () => {
    if (pixel) act(() => move(place, pixel));
  });
}

function dragImage(begin) {
  followPointer((event) => {
    const [column, row] = pixelAt(event);
    pan(begin[0] - column, begin[1] - row);
    applyView();
  }, draw);
}

export function listenToPointer() {
  const image = element('image');
  image.addEventListener('pointerdown', (event) => {
    if (event.button || isDragging) return;
    event.preventDefault();
    const place = placeOf(event.target.dataset.place);
    if (place) dragJoint(place);
    else dragImage(pixelAt(event));
  });
  image.addEventListener('focusin', (event) => {
    const place = placeOf(event.target.dataset.place);
    if (place && !isSelected(place)) select(place);
  });
  image.addEventListener('wheel', (event) => {
    event.preventDefault();
    if (isDragging) return;
    const way = event.deltaY * (event.deltaMode ? LINE : 1);
    zoom(Math.exp(-WHEEL * way), pixelAt(event));
    draw();
  }, { passive: false });
}
