import { batch, effect } from '@preact/signals';
import { cameraOf, poseOf } from '../camera/pose';
import { formatPlace, parsePlace, type Place } from './place';
import { defaultDisplay } from './display_options';
import * as store from './store';

const settled = 250; // ms without a change after which the address is updated

/** Opens a model with default display options and the server's initial view. */
export function openModel(name: string | undefined): void {
  show(formatPlace({ model: name, camera: undefined, display: defaultDisplay }));
  history.pushState(null, '', location.href.replace(/#.*$/, '') + currentHash());
}

/** Shows other models in the view that is open: its camera, its look and what was measured stay. */
export function showInstead(name: string): void {
  const kept = name.split('+');
  const display = store.display.peek();
  const hiddenModels = display.hiddenModels.filter((hidden) => kept.includes(hidden));
  const camera = parsePlace(currentHash()).camera;
  batch(() => {
    store.display.value = { ...display, hiddenModels };
    store.firstCamera.value = camera;
    store.model.value = name;
  });
  history.pushState(null, '', currentLink());
}

function show(hash: string): void {
  const place = parsePlace(hash);
  const here = place.model === store.model.peek() && store.pose.peek() !== undefined;
  batch(() => {
    store.display.value = place.display;
    if (here && place.camera) store.pose.value = poseOf(place.camera, store.upAxis.peek());
  });
  if (!here || !place.camera) reopen(place);
}

/** Opens the view again, with the camera of the place or, without one, the server's initial view. */
function reopen(place: Place): void {
  if (place.model !== store.model.peek()) forgetModel();
  store.model.value = undefined;
  batch(() => {
    store.pose.value = undefined;
    store.firstCamera.value = place.camera;
    store.model.value = place.model;
  });
}

function forgetModel(): void {
  store.measurements.value = [];
  store.growing.value = undefined;
  store.inspection.value = undefined;
  store.shownAnnotation.value = undefined;
  store.lastPick.value = undefined;
  store.editedClip.value = undefined;
  store.tool.value = 'navigate';
}

/** The hash of a link to the current view. */
export function currentHash(): string {
  const pose = store.pose.peek();
  const camera = pose ? cameraOf(pose, store.upAxis.peek(), store.display.peek().upsideDown) : store.firstCamera.peek();
  return formatPlace({ model: store.model.peek(), camera, display: store.display.peek() });
}

export const currentLink = (): string => location.href.replace(/#.*$/, '') + currentHash();

/** Synchronizes the address and the store. */
export function startRoutes(): void {
  show(location.hash);
  // The user edited the address, or went back or forward.
  addEventListener('hashchange', () => {
    if (location.hash !== currentHash()) show(location.hash);
  });
  let timer: ReturnType<typeof setTimeout> | undefined;
  effect(() => {
    void [store.model.value, store.pose.value, store.display.value];
    clearTimeout(timer);
    timer = setTimeout(() => history.replaceState(null, '', currentLink()), settled);
  });
}
