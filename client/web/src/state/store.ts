import { computed, signal } from '@preact/signals';
import type { Camera, UpAxis, Pose } from '../camera/pose';
import { flipped, skyOf } from '../camera/pose';
import { projectionOf, type Projection } from '../camera/projection';
import { diagonal, type Box } from '../camera/standard_views';
import { decimalsOf } from '../measure/format';
import type { ModelDescription, PickResult, ScanStatus, Uploads, ViewFrame } from '../generated/surfcast_pb';
import type { LinkState } from '../protocol/link';
import { boxFrom, cameraFrom, type Size } from '../protocol/pictures';
import type { Figures } from '../view/figures';
import type { MeasureKind, Measurement } from '../measure/measurement';
import type { Vector } from '../camera/vector';
import type { Annotation } from './annotations';
import { defaultDisplay, type DisplayOptions } from './display_options';
import { membersOf, shownName, type Swipe } from './joined';

/** The shared state of the page. Every part may read it; the headings below name the part that writes each signal. */

// ---- written by view/view_controller.ts ----

export const link = signal<LinkState>({ kind: 'connecting' });
export const models = signal<readonly string[] | undefined>(undefined);
/** Scans whose models are not complete, by name. */
export const scans = signal<ReadonlyMap<string, ScanStatus>>(new Map());
/** Which scans the server takes; undefined: none. */
export const uploads = signal<Uploads | undefined>(undefined);
export const descriptions = signal<ReadonlyMap<string, ModelDescription>>(new Map());
/** Why there is no picture; `again`: a retry is scheduled. */
export const viewProblem = signal<{ readonly message: string; readonly again: boolean } | undefined>(undefined);
/** The newest frame on the screen, without its data. */
export const shownFrame = signal<ViewFrame | undefined>(undefined);
/** The camera of the picture on the screen: that of the frame, or the one to which the frame is warped. */
export const shownCamera = signal<Camera | undefined>(undefined);
/** The frame on the screen belongs to the open view, not to one that ended with its connection. */
export const frameIsCurrent = signal(false);
/** The first update that requested the current view. A frame of an older update shows an earlier view. */
export const wantedUpdate = signal(0n);
/** The view has changed, and the server has not been told yet. */
export const updatePending = signal(false);
export const figures = signal<Figures>({ framesPerSecond: 0, bytesPerSecond: 0, latency: undefined, stages: undefined });
/** The current pose; undefined until the server has chosen the initial view. */
export const pose = signal<Pose | undefined>(undefined);
/** A drag, an animation, inertia or flight is in progress. */
export const moving = signal(false);

// ---- written by state/routes.ts and the gallery ----

export const model = signal<string | undefined>(undefined);
/** The initial camera given by a link. It is applied once the model's vertical axis is known. */
export const firstCamera = signal<Camera | undefined>(undefined);

// ---- written by the panels ----

export const display = signal<DisplayOptions>(defaultDisplay);
/** The models between which the view is divided; see `swipe`. */
export const wantedSwipe = signal<Swipe | undefined>(undefined);
/** Where the line is, as a share of the width of the picture. */
export const swipeAt = signal(0.5);
export type Tool = 'navigate' | 'inspect' | MeasureKind | 'clip' | 'window';
export const tool = signal<Tool>('navigate');
export const flying = signal(false);
export type Panel = 'look' | 'measure' | 'clip' | 'views' | 'model';
export const panel = signal<Panel | undefined>(undefined);
/** The gallery of models covers the open model. */
export const galleryOpen = signal(false);
export type Dialog = 'screenshot' | 'points' | 'help';
export const dialog = signal<Dialog | undefined>(undefined);
/** Files are held over the page that the server would take. */
export const dropping = signal(false);
export const figuresOpen = signal(false);
/** One line of text, shown for a short time. */
export const notice = signal<string | undefined>(undefined);

const noticeTime = 2600; // ms
let noticeTimer: ReturnType<typeof setTimeout> | undefined;

export function showNotice(text: string): void {
  clearTimeout(noticeTimer);
  notice.value = text;
  noticeTimer = setTimeout(() => (notice.value = undefined), noticeTime);
}

export interface Inspection {
  readonly result: PickResult;
  readonly at: Vector;
}
export const inspection = signal<Inspection | undefined>(undefined);
/** The annotation whose text is shown. */
export const shownAnnotation = signal<Annotation | undefined>(undefined);
export const picking = signal(false);
/** The point under the resting pointer; written by view/cursor_probe.ts. */
export interface CursorPoint {
  readonly at: Vector;
  readonly ofSource: boolean; // in the system of the source; otherwise in that of the model
  readonly stale: boolean; // the pointer or the picture has moved since
}
export const cursor = signal<CursorPoint | undefined>(undefined);
/** The last point that the server found at a pixel, world coordinates; written by view/probe.ts. */
export const lastPick = signal<Vector | undefined>(undefined);
export const measurements = signal<readonly Measurement[]>([]);
/** Id of the measurement to which clicks add points. */
export const growing = signal<number | undefined>(undefined);
/** Index of the clip box whose handles are shown. */
export const editedClip = signal<number | undefined>(undefined);

/** Size of the picture, device pixels; written by view/stage_size.ts. */
export const stageSize = signal<Size>({ width: 0, height: 0 });
/** The room for the picture has changed, and `stageSize` follows in a moment. */
export const resizing = signal(false);

export const description = computed(() =>
  model.value === undefined ? undefined : descriptions.value.get(model.value),
);
/** The names of the models in the view: one, or several that are shown together. */
export const members = computed(() => membersOf(model.value, description.value));
/** The models on both sides of the line, while both are in the view. */
export const swipe = computed(() => {
  const wanted = wantedSwipe.value;
  return wanted && members.value.includes(wanted.left) && members.value.includes(wanted.right) ? wanted : undefined;
});
/** The name of what is shown of the model: without the models that are hidden. */
export const shownModel = computed(() =>
  model.value === undefined ? undefined : shownName(members.value, display.value.hiddenModels),
);
/** The open model, if it is a scan whose model is not complete. */
export const openScan = computed(() => (model.value === undefined ? undefined : scans.value.get(model.value)));
export const upAxis = computed<UpAxis>(() => {
  const axis = description.value?.zUp === false ? 'y' : 'z';
  const turned = (description.value?.upsideDown ?? false) !== display.value.upsideDown;
  return turned ? flipped(axis) : axis;
});
export const bounds = computed<Box>(() => boxFrom(description.value?.bounds));

/** Number of decimals of lengths, from the point spacing of the model. */
export const lengthDecimals = computed(() =>
  decimalsOf(description.value?.spacing || diagonal(bounds.value) * 1e-4),
);

/** Projection of the picture on the screen. The overlay uses it, not the newest pose, so that it matches the picture. */
export const shownProjection = computed<Projection | undefined>(() => {
  const frame = shownFrame.value;
  const camera = shownCamera.value ?? cameraFrom(frame?.picture?.camera);
  if (!frame?.resolution || !camera) return undefined;
  return projectionOf(camera, skyOf(upAxis.value), frame.resolution.width, frame.resolution.height);
});

/** The picture on the screen is the final one of the current view: the server has nothing to draw. */
export const pictureSettled = computed(() => {
  const frame = shownFrame.value;
  if (!frame || !frameIsCurrent.value) return false;
  if (updatePending.value || resizing.value || moving.value) return false;
  return frame.update >= wantedUpdate.value && !frame.moving && !frame.more && frame.picture?.converged === true;
});

/** Colours and opacities by attribute belong to surfels. A server that does not count its items by kind has no others. */
export function hasSurfels(): boolean {
  const kinds = description.value?.kinds ?? [];
  return kinds.length === 0 || kinds.some(({ kind }) => kind === 'surfel');
}

/** The tensor fields and tables of ellipsoids of the open model. */
export const ellipsoids = computed(() => description.value?.ellipsoids ?? []);
