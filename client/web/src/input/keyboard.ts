import type { Course } from '../camera/motion';
import type { ViewName } from '../camera/standard_views';
import { finish, undoPoint } from '../measure/measurement_list';
import * as store from '../state/store';
import { nudgeWindow, openVolume } from '../state/volume';
import type { CameraNavigator } from '../view/camera_navigator';

/** Keys of the standard views, by `KeyboardEvent.key`. */
export const viewKeys: Readonly<Record<string, ViewName>> = {
  '1': 'front',
  '2': 'right',
  '3': 'back',
  '4': 'left',
  '5': 'top',
  '6': 'bottom',
  '7': 'iso',
};

const toolKeys: Readonly<Record<string, store.Tool>> = {
  n: 'navigate',
  i: 'inspect',
  m: 'distance',
  h: 'height',
  k: 'angle',
  b: 'area',
  p: 'profile',
  v: 'window',
};

/** By `KeyboardEvent.code`, so that the positions of the keys are the same with every keyboard layout. */
const flightKeys: Readonly<Record<string, Partial<Course>>> = {
  KeyW: { forward: 1 },
  KeyS: { forward: -1 },
  KeyD: { right: 1 },
  KeyA: { right: -1 },
  KeyE: { up: 1 },
  KeyQ: { up: -1 },
};

export function courseOf(codes: Iterable<string>): Course {
  const course = { right: 0, forward: 0, up: 0 };
  for (const code of codes) {
    const part = flightKeys[code];
    course.right += part?.right ?? 0;
    course.forward += part?.forward ?? 0;
    course.up += part?.up ?? 0;
  }
  return course;
}

export interface KeyActions {
  toggleFlight(): void;
  copyLink(): void;
}

const typing = (target: EventTarget | null): boolean =>
  target instanceof HTMLElement && target.closest('input, select, textarea, dialog') !== null;

export class Keyboard {
  private readonly held = new Set<string>();

  constructor(
    private readonly stage: HTMLElement,
    private readonly navigator: CameraNavigator,
    private readonly actions: KeyActions,
  ) {
    addEventListener('keydown', (event) => this.down(event));
    addEventListener('keyup', (event) => this.release(event));
    addEventListener('blur', () => this.releaseAll());
    store.flying.subscribe((flying) => {
      if (!flying) this.releaseAll();
    });
  }

  private down(event: KeyboardEvent): void {
    if (typing(event.target) || event.ctrlKey || event.metaKey || event.altKey || !store.model.peek()) return;
    // A focused button handles Enter and Space itself.
    if ((event.key === 'Enter' || event.key === ' ') && !this.onStage()) return;
    if (store.flying.peek() && flightKeys[event.code]) this.hold(event);
    else if (!this.arrow(event) && !this.press(event.key)) return;
    event.preventDefault();
  }

  private onStage(): boolean {
    return document.activeElement === this.stage || document.activeElement === document.body;
  }

  private hold(event: KeyboardEvent): void {
    this.held.add(event.code);
    this.steer(event.shiftKey);
  }

  private release(event: KeyboardEvent): void {
    const known = this.held.delete(event.code);
    if (known || event.key === 'Shift') this.steer(event.shiftKey);
  }

  private releaseAll(): void {
    this.held.clear();
    this.steer(false);
  }

  private steer(fast: boolean): void {
    this.navigator.flyAlong(courseOf(this.held), fast);
  }

  /** Arrow keys orbit, with Shift they pan. Only while the picture has the focus, because lists use arrow keys too. */
  private arrow(event: KeyboardEvent): boolean {
    const directions: Readonly<Record<string, readonly [number, number]>> = {
      ArrowLeft: [-1, 0],
      ArrowRight: [1, 0],
      ArrowUp: [0, -1],
      ArrowDown: [0, 1],
    };
    const direction = directions[event.key];
    if (!direction || !this.onStage()) return false;
    const { navigator } = this;
    if (store.tool.peek() === 'window') {
      const [right, down] = direction;
      const part = event.shiftKey ? 5 : 1;
      nudgeWindow(right * part, -down * part);
      return true;
    }
    const turning = store.flying.peek() ? navigator.looking : navigator.orbiting(() => undefined);
    navigator.nudge(event.shiftKey ? navigator.panning(() => undefined) : turning, direction[0] * 6, direction[1] * 6);
    return true;
  }

  private press(key: string): boolean {
    const lower = key.toLowerCase();
    const view = viewKeys[key];
    const tool = toolKeys[lower];
    if (view) this.navigator.standard(view);
    else if (tool) chooseTool(tool);
    else return this.command(lower);
    return true;
  }

  private command(key: string): boolean {
    const commands: Readonly<Record<string, () => void>> = {
      f: () => this.navigator.fit(),
      g: () => this.actions.toggleFlight(),
      l: () => this.actions.copyLink(),
      c: () => togglePanel('clip'),
      o: () => togglePanel('look'),
      s: () => togglePanel('views'),
      x: () => (store.dialog.value = 'screenshot'),
      e: () => openPointsDialog(),
      '?': () => (store.dialog.value = 'help'),
      '`': () => (store.figuresOpen.value = !store.figuresOpen.value),
      '+': () => this.navigator.zoomStep(-1),
      '=': () => this.navigator.zoomStep(-1),
      '-': () => this.navigator.zoomStep(1),
      enter: finish,
      backspace: undoPoint,
      escape: () => this.escape(),
    };
    const command = commands[key];
    command?.();
    return command !== undefined;
  }

  /** Ends the innermost active state: measurement, inspection, flight, tool, panel. One per key press. */
  private escape(): void {
    if (store.growing.peek() !== undefined) finish();
    else if (store.inspection.peek()) store.inspection.value = undefined;
    else if (store.flying.peek()) store.flying.value = false;
    else if (store.tool.peek() !== 'navigate') chooseTool('navigate');
    else store.panel.value = undefined;
  }
}

export function chooseTool(tool: store.Tool): void {
  if (tool === 'window' && !openVolume()) return;
  finish();
  store.tool.value = tool;
}

/** Only scans have points to save. */
export function openPointsDialog(): void {
  if (store.shownFrame.peek() && store.hasSurfels()) store.dialog.value = 'points';
}

export function togglePanel(panel: store.Panel): void {
  store.panel.value = store.panel.peek() === panel ? undefined : panel;
}
