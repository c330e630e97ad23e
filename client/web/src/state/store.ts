import { computed, signal } from '@preact/signals';
import type { Camera, UpAxis, Pose } from '../camera/pose';
import { skyOf } from '../camera/pose';
import { projectionOf, type Projection } from '../camera/projection';
import { diagonal, type Box } from '../camera/standard_views';
import { decimalsOf } from '../measure/format';
import type { ModelDescription, PickResult, ViewFrame } from '../generated/surfcast_pb';
import type { LinkState } from '../protocol/link';
import { boxFrom, cameraFrom, type Size } from '../protocol/pictures';
import type { Figures } from '../view/figures';
import type { MeasureKind, Measurement } from '../measure/measurement';
import type { Vector } from '../camera/vector';
import { defaultDisplay, type DisplayOptions } from './display_options';

/** What every part of the page may read. Each signal is written by one part, which its comment names. */

// ---- written by view/view_controller.ts ----

export const link = signal<LinkState>({ kind: 'connecting' });
export const models = signal<readonly string[] | undefined>(undefined);
export const descriptions = signal<ReadonlyMap<string, ModelDescription>>(new Map());
/** Why there is no picture; `again`: it is being tried again. */
export const viewProblem = signal<{ readonly message: string; readonly again: boolean } | undefined>(undefined);
/** The frame on the screen, without its data. */
export const shownFrame = signal<ViewFrame | undefined>(undefined);
/** The first update that asked for what is wanted now: a frame that shows an older one does not show it. */
export const wantedUpdate = signal(0n);
/** Something changed that has not been asked for yet. */
export const updatePending = signal(false);
export const figures = signal<Figures>({ framesPerSecond: 0, bytesPerSecond: 0, latency: undefined, stages: undefined });
/** Where the newest picture is to be seen from; nothing until the server has chosen a first view. */
export const pose = signal<Pose | undefined>(undefined);
/** The hand is down, or what it pushed is still coasting. */
export const moving = signal(false);

// ---- written by state/routes.ts and the gallery ----

export const model = signal<string | undefined>(undefined);
/** From where a link says the model is to be seen first; taken once the model's axes are known. */
export const firstCamera = signal<Camera | undefined>(undefined);

// ---- written by the panels ----

export const display = signal<DisplayOptions>(defaultDisplay);
export type Tool = 'navigate' | 'inspect' | MeasureKind | 'clip';
export const tool = signal<Tool>('navigate');
export const flying = signal(false);
export type Panel = 'look' | 'measure' | 'clip' | 'model';
export const panel = signal<Panel | undefined>(undefined);
/** The models are shown instead of the one that is open. */
export const galleryOpen = signal(false);
export type Dialog = 'screenshot' | 'help';
export const dialog = signal<Dialog | undefined>(undefined);
export const figuresOpen = signal(false);
/** One line that goes away by itself. */
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
export const picking = signal(false);
export const measurements = signal<readonly Measurement[]>([]);
/** The one that clicks add points to. */
export const growing = signal<number | undefined>(undefined);
/** Index of the clip box whose handles are shown. */
export const editedClip = signal<number | undefined>(undefined);

/** Of the picture, in device pixels; written by the stage. */
export const stageSize = signal<Size>({ width: 0, height: 0 });

export const description = computed(() =>
  model.value === undefined ? undefined : descriptions.value.get(model.value),
);
export const upAxis = computed<UpAxis>(() => (description.value?.zUp === false ? 'y' : 'z'));
export const bounds = computed<Box>(() => boxFrom(description.value?.bounds));

/** Decimals of lengths that the model's precision gives reason for. */
export const lengthDecimals = computed(() =>
  decimalsOf(description.value?.spacing || diagonal(bounds.value) * 1e-4),
);

/** Of the frame on the screen: what lies over the picture must match it, not the newest pose. */
export const shownProjection = computed<Projection | undefined>(() => {
  const frame = shownFrame.value;
  const camera = cameraFrom(frame?.picture?.camera);
  if (!frame?.resolution || !camera) return undefined;
  return projectionOf(camera, skyOf(upAxis.value), frame.resolution.width, frame.resolution.height);
});
