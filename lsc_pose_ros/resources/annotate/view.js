// Copyright 2026 lsc_pose_ros contributors
// SPDX-License-Identifier: Apache-2.0

// Which part of the image is shown. All numbers are pixels of the depth image.

import { element, state } from './state.js';

const MARGIN = 0.08;      // around people, of the larger side
const CLOSEST = 12;       // no less of the image is shown
const OUTSIDE = 0.25;     // so far outside of the image joints are shown, of its size
const BORDER = 0.06;      // a selected joint is at least so far inside, of what is shown

// The part that is shown at least: what fits the element around it is shown, too.
let box = { x: 0, y: 0, width: 1, height: 1 };
let mode = 'people';      // what the next frame shows: 'people', 'whole', or 'same'
let size = '';

export function whole() {
  mode = 'whole';
  box = { x: 0, y: 0, width: state.width, height: state.height };
}

// All people, by their mask and their joints; without any, the whole image.
export function people() {
  const columns = [], rows = [];
  if (state.people) {
    const [left, top, right, bottom] = state.people;
    columns.push(left, right);
    rows.push(top, bottom);
  }
  for (const { joints } of state.bodies) {
    for (const { pixel } of Object.values(joints)) {
      if (!pixel) continue;
      columns.push(limited(pixel[0], -OUTSIDE * state.width, (1 + OUTSIDE) * state.width));
      rows.push(limited(pixel[1], -OUTSIDE * state.height, (1 + OUTSIDE) * state.height));
    }
  }
  whole();
  mode = 'people';
  if (!columns.length) return;
  const [left, right] = [Math.min(...columns), Math.max(...columns)];
  const [top, bottom] = [Math.min(...rows), Math.max(...rows)];
  const around = Math.max(MARGIN * Math.max(right - left, bottom - top), CLOSEST / 2);
  box = {
    x: left - around, y: top - around,
    width: right - left + 2 * around, height: bottom - top + 2 * around,
  };
}

export function beginFrame() {
  const before = size;
  size = `${state.width} ${state.height}`;
  if (mode === 'people') people();
  else if (mode === 'whole' || size !== before) whole();
}

// Shows `factor` times as much in detail; `pixel` stays where it is. Returns whether only a part
// of the image is shown.
export function zoom(factor, pixel) {
  const seen = shown();
  const least = CLOSEST / Math.min(seen.width, seen.height);
  const share = Math.max(1 / factor, least);
  if (seen.width * share >= state.width && seen.height * share >= state.height) {
    whole();
    return false;
  }
  mode = 'same';
  const [x, y] = pixel || [seen.x + seen.width / 2, seen.y + seen.height / 2];
  box = {
    x: x - (x - seen.x) * share, y: y - (y - seen.y) * share,
    width: seen.width * share, height: seen.height * share,
  };
  keepImageInside();
  return true;
}

export function pan(right, down) {
  mode = 'same';
  box = shown();
  box.x += right;
  box.y += down;
  keepImageInside();
}

// Moves what is shown until a joint is in it; the next frame is shown as it would be otherwise.
export function reveal(pixel) {
  const seen = shown();
  const move = (at, begin, length) => {
    const border = BORDER * length;
    return at - limited(at, begin + border, begin + length - border);
  };
  const [right, down] = [move(pixel[0], seen.x, seen.width), move(pixel[1], seen.y, seen.height)];
  if (right || down) box = { ...seen, x: seen.x + right, y: seen.y + down };
}

// What the element shows: `box`, and more if it has another aspect ratio.
export function shown() {
  const image = element('image');
  const aspect = (image.clientWidth || 4) / (image.clientHeight || 3);
  const width = Math.max(box.width, box.height * aspect);
  const height = width / aspect;
  return {
    x: box.x - (width - box.width) / 2, y: box.y - (height - box.height) / 2, width, height,
  };
}

// How many pixels of the image a pixel of the screen is.
export const unit = () => shown().width / (element('image').clientWidth || 1);

export function applyView() {
  const { x, y, width, height } = shown();
  element('image').setAttribute('viewBox', `${x} ${y} ${width} ${height}`);
}

function keepImageInside() {
  box.x = limited(box.x + box.width / 2, 0, state.width) - box.width / 2;
  box.y = limited(box.y + box.height / 2, 0, state.height) - box.height / 2;
}

function limited(value, least, most) {
  return Math.min(Math.max(value, least), most);
}
