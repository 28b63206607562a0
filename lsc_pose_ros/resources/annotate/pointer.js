// Copyright 2026 lsc_pose_ros contributors
// SPDX-License-Identifier: Apache-2.0

// Drags joints, and moves and enlarges the image.

import { act } from './actions.js';
import { circleOf, draw } from './drawing.js';
import { move, select } from './joints.js';
import { element, isSelected, jointOf, placeOf, wordOf } from './state.js';
import { applyView, pan, zoom } from './view.js';

const WHEEL = 0.002;             // of the logarithm of the size, per pixel of the wheel
const LINE = 20;                 // pixels, for wheels that count lines
const FINGER = 24;               // pixels of the screen: so far from a joint a finger takes it
const STILL = 6;                 // pixels of the screen: a finger that only taps moves so far

// Where the pointers are that are down, by their numbers, and what they do together.
const pointers = new Map();
let gesture = null;

const pointOf = (event) => [event.clientX, event.clientY];
const distance = ([a, b], [c, d]) => Math.hypot(a - c, b - d);
const middle = ([[a, b], [c, d]]) => [(a + c) / 2, (b + d) / 2];

function pixelAt([x, y]) {
  const matrix = element('image').getScreenCTM().inverse();
  const point = new DOMPoint(x, y).matrixTransform(matrix);
  return [point.x, point.y];
}

function placeAt(event) {
  const exact = placeOf(event.target.dataset.place);
  if (exact || event.pointerType !== 'touch') return exact;
  const circles = [...element('skeletons').querySelectorAll('.joint')];
  const away = circles.map((circle) => {
    const { x, y, width, height } = circle.getBoundingClientRect();
    return distance(pointOf(event), [x + width / 2, y + height / 2]);
  });
  const nearest = away.indexOf(Math.min(...away));
  return away[nearest] <= FINGER ? placeOf(circles[nearest].dataset.place) : null;
}

function dragJoint(place, event) {
  select(place);
  circleOf(wordOf(place)).focus({ preventScroll: true });
  const begin = pointOf(event);
  const still = event.pointerType === 'touch' ? STILL : 0;
  const [column, row] = jointOf(place).pixel;
  const [beginColumn, beginRow] = pixelAt(begin);
  let pixel = null;
  return {
    move() {
      const [point] = pointers.values();
      if (!pixel && distance(point, begin) <= still) return;
      const [nowColumn, nowRow] = pixelAt(point);
      pixel = [column + nowColumn - beginColumn, row + nowRow - beginRow];
      // The ring is drawn before the joint; another action may draw both anew meanwhile.
      for (const circle of [circleOf(wordOf(place)), ...document.querySelectorAll('.ring')]) {
        if (!circle) continue;
        circle.setAttribute('cx', pixel[0]);
        circle.setAttribute('cy', pixel[1]);
      }
    },
    end() {
      if (pixel) act(() => move(place, pixel));
    },
    cancel: draw,
  };
}

function dragImage() {
  const begin = pixelAt([...pointers.values()][0]);
  return {
    move() {
      const [column, row] = pixelAt([...pointers.values()][0]);
      pan(begin[0] - column, begin[1] - row);
      applyView();
    },
    end: draw,
    cancel: draw,
  };
}

// Two fingers: what is between them follows them.
function pinch() {
  let before = [...pointers.values()];
  return {
    move() {
      const now = [...pointers.values()];
      const between = pixelAt(middle(before));
      const isPart = zoom(distance(...now) / Math.max(distance(...before), 1), between);
      applyView();
      if (isPart) {
        const [column, row] = pixelAt(middle(now));
        pan(between[0] - column, between[1] - row);
      }
      before = now;
      draw();
    },
    end() {},
    cancel() {},
  };
}

function press(event) {
  const isSecond = pointers.size === 1 && event.pointerType === 'touch';
  if (event.button || (pointers.size && !isSecond)) return;
  event.preventDefault();
  // What is under the pointer is drawn anew meanwhile.
  element('image').setPointerCapture(event.pointerId);
  pointers.set(event.pointerId, pointOf(event));
  if (isSecond) {
    gesture.cancel();
    gesture = pinch();
    return;
  }
  const place = placeAt(event);
  gesture = place ? dragJoint(place, event) : dragImage();
}

function release(event, isCancelled) {
  if (!pointers.delete(event.pointerId)) return;
  if (isCancelled) gesture.cancel();
  else gesture.end();
  gesture = pointers.size ? dragImage() : null;
}

export function listenToPointer() {
  const image = element('image');
  image.addEventListener('pointerdown', press);
  image.addEventListener('pointermove', (event) => {
    if (!pointers.has(event.pointerId)) return;
    pointers.set(event.pointerId, pointOf(event));
    gesture.move();
  });
  image.addEventListener('pointerup', (event) => release(event, false));
  image.addEventListener('pointercancel', (event) => release(event, true));
  image.addEventListener('focusin', (event) => {
    const place = placeOf(event.target.dataset.place);
    if (place && !isSelected(place)) select(place);
  });
  image.addEventListener('wheel', (event) => {
    event.preventDefault();
    if (gesture) return;
    const way = event.deltaY * (event.deltaMode ? LINE : 1);
    zoom(Math.exp(-WHEEL * way), pixelAt(pointOf(event)));
    draw();
  }, { passive: false });
}
