import { computed } from '@preact/signals';
import { appearance, east, north, scalePoint, unitPixelsAt } from '../camera/orientation';
import { description, lastPick, shownCamera, shownProjection } from './store';
import { lengthUnitOf } from './units';
import { systemFacts } from './wkt';

/** What the scale bar and the compass show. Like the overlay, they match the picture on the screen. */

/** Of the model's world coordinates; undefined: not known. */
const lengthUnit = computed(() => description.value && lengthUnitOf(description.value));

/** North is y, and level. */
const northIsKnown = computed(() => {
  const { system, zUp } = description.value ?? {};
  return zUp === true && system !== undefined && systemFacts(system.wkt).northIsY;
});

/** What the scale bar is drawn from: the model's unit of length, and the pixels of one at a point of the picture. */
export const pictureScale = computed(() => {
  const view = shownProjection.value;
  const camera = shownCamera.value;
  const unit = lengthUnit.value;
  if (!view || !camera || !unit) return undefined;
  const { at, picked } = scalePoint(view, camera.focalPoint, lastPick.value);
  return { unit, picked, unitPixels: unitPixelsAt(view, at), height: view.height };
});

/** How east and north look in the middle of the picture; undefined where they are not known. */
export const compass = computed(() => {
  const view = shownProjection.value;
  const camera = shownCamera.value;
  if (!view || !camera || !northIsKnown.value) return undefined;
  const [toEast, toNorth] = [east, north].map((direction) => appearance(view, camera.focalPoint, direction));
  return toEast && toNorth ? { east: toEast, north: toNorth } : undefined;
});
