import { effect } from '@preact/signals';
import type { Pixel } from '../camera/vector';
import type { PickResult } from '../generated/surfcast_pb';
import { vectorFrom } from '../protocol/pictures';
import * as store from '../state/store';

const restTime = 80; // ms without a movement after which the pointer rests
const pause = 150; // ms from one request to the next

/** What decides when the server is asked for the point under the pointer. Times as of performance.now(). */
export interface CursorState {
  /** Undefined: not over the picture, or a button is pressed. */
  readonly pointer: { readonly pixel: Pixel; readonly since: number } | undefined;
  readonly settled: boolean; // the picture is final: the server draws nothing that a pick could delay
  readonly asking: boolean;
  readonly answered: boolean; // for this pixel of this picture
  readonly askedAt: number;
}

/** How long to wait before asking, ms; undefined: until something changes. */
export function waitBeforeAsking(state: CursorState, now: number): number | undefined {
  const { pointer, settled, asking, answered, askedAt } = state;
  if (!pointer || !settled || asking || answered) return undefined;
  return Math.max(0, pointer.since + restTime - now, askedAt + pause - now);
}

/** Keeps the store's cursor the point under the resting pointer. One request at a time; none while the view changes. */
export class CursorProbe {
  private state: CursorState = {
    pointer: undefined,
    settled: false,
    asking: false,
    answered: false,
    askedAt: -Infinity,
  };
  private timer: ReturnType<typeof setTimeout> | undefined;

  constructor(private readonly pick: (pixel: Pixel) => Promise<PickResult | undefined>) {
    effect(() => this.follow(store.pictureSettled.value));
    effect(() => {
      void store.model.value;
      store.cursor.value = undefined;
    });
  }

  /** The pointer is at a pixel of the picture, without a button pressed. */
  moved(pixel: Pixel): void {
    const { pointer } = this.state;
    if (pointer?.pixel.x === pixel.x && pointer.pixel.y === pixel.y) return;
    this.change({ pointer: { pixel, since: performance.now() }, answered: false });
  }

  /** The pointer has left the picture, or a button is pressed. */
  left(): void {
    this.change({ pointer: undefined, answered: false });
    store.cursor.value = undefined;
  }

  /** An answer on its way is of the picture before. */
  private follow(settled: boolean): void {
    const { pointer } = this.state;
    this.change({ settled, answered: false, pointer: pointer && { ...pointer } });
  }

  private change(change: Partial<CursorState>): void {
    this.state = { ...this.state, ...change };
    const shown = store.cursor.peek();
    if (shown && !this.state.answered && !shown.stale) store.cursor.value = { ...shown, stale: true };
    clearTimeout(this.timer);
    const wait = waitBeforeAsking(this.state, performance.now());
    if (wait !== undefined) this.timer = setTimeout(() => void this.ask(), wait);
  }

  private async ask(): Promise<void> {
    const { pointer } = this.state;
    if (!pointer) return;
    this.change({ asking: true, askedAt: performance.now() });
    const result = await this.pick(pointer.pixel).catch(() => undefined);
    const current = pointer === this.state.pointer && this.state.settled;
    if (current) store.cursor.value = pointOf(result);
    this.change({ asking: false, answered: current });
  }
}

function pointOf(result: PickResult | undefined): store.CursorPoint | undefined {
  if (!result?.hit || !result.position) return undefined;
  const source = result.sourcePosition && vectorFrom(result.sourcePosition);
  return { at: source ?? vectorFrom(result.position), ofSource: source !== undefined, stale: false };
}
