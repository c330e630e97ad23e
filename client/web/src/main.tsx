import '@fontsource-variable/inter/wght.css';
import './styles/base.css';
import './styles/stage.css';
import './styles/layout.css';
import './styles/controls.css';
import './styles/cards.css';
import './styles/pages.css';
import { render } from 'preact';
import { Keyboard } from './input/keyboard';
import { StageInput } from './input/stage_input';
import { Tools } from './input/tools';
import { acceptDrops, Uploader } from './input/uploads';
import { startOverlay } from './overlay/overlay';
import { startAnnotationStorage } from './state/annotation_storage';
import { currentLink, openModel, startRoutes } from './state/routes';
import * as store from './state/store';
import { startViewStorage } from './state/view_storage';
import { ActionsContext, type Actions } from './ui/actions';
import { App } from './ui/app';
import { copyText } from './ui/clipboard';
import { ViewController } from './view/view_controller';
import { CameraNavigator } from './view/camera_navigator';
import { CursorProbe } from './view/cursor_probe';
import { Probe } from './view/probe';
import { followSize } from './view/stage_size';
import { startSwipe } from './view/swipe_picture';

function canvas(className: string): HTMLCanvasElement {
  const element = document.createElement('canvas');
  element.className = className;
  return element;
}

interface Stage {
  readonly stage: HTMLDivElement; // receives pointer and key events
  readonly picture: HTMLCanvasElement;
  readonly warped: HTMLCanvasElement; // over the picture, while it is warped
  readonly swiped: HTMLCanvasElement; // over both, on the right of the line between two models
  readonly overlay: HTMLCanvasElement;
}

function makeStage(): Stage {
  const stage = document.createElement('div');
  stage.className = 'canvases';
  stage.tabIndex = 0;
  stage.setAttribute('role', 'application');
  stage.setAttribute('aria-label', 'The model. Arrow keys turn it, plus and minus zoom.');
  const picture = canvas('picture');
  const warped = canvas('warped');
  const swiped = canvas('swiped');
  const overlay = canvas('overlay');
  stage.append(picture, warped, swiped, overlay);
  return { stage, picture, warped, swiped, overlay };
}

/** It names the open model, by which a proxy before several servers chooses one. */
function socketUrl(): string {
  const url = new URL('ws', location.href.replace(/[?#].*$/, ''));
  url.protocol = url.protocol === 'https:' ? 'wss:' : 'ws:';
  const model = store.model.peek();
  if (model !== undefined) url.searchParams.set('model', model);
  return url.href;
}

const copyLink = (): Promise<void> =>
  copyText(currentLink(), 'Link copied.', 'The browser denies access to the clipboard. Copy the address instead.');

function start(): void {
  const { stage, picture, warped, swiped, overlay } = makeStage();
  const eye = new CameraNavigator();
  startRoutes();
  const controller = new ViewController(socketUrl, { picture, warped }, (now) => eye.step(now));
  const probe = new Probe(controller);
  const uploader = new Uploader(() => controller.refreshModels());
  acceptDrops(
    () => store.uploads.peek(),
    (held) => (store.dropping.value = held),
    (files, rules) => uploader.add(files, rules),
  );
  const actions: Actions = { controller, navigator: eye, stage, uploader, copyLink: () => void copyLink() };
  const cursor = new CursorProbe((pixel) => probe.pick(pixel));
  new StageInput(stage, eye, probe, new Tools(eye, probe), cursor);
  new Keyboard(stage, eye, {
    toggleFlight: () => (store.flying.value = !store.flying.peek()),
    copyLink: actions.copyLink,
  });
  followSize(stage, (before, after) => eye.resized(before, after));
  startOverlay(overlay);
  startSwipe(swiped, controller);
  startViewStorage();
  startAnnotationStorage();
  openTheOnly();
  const root = document.getElementById('root');
  if (root) {
    render(
      <ActionsContext.Provider value={actions}>
        <App />
      </ActionsContext.Provider>,
      root,
    );
  }
}

/** Opens the model of a server that has only one. */
function openTheOnly(): void {
  const stop = store.models.subscribe((models) => {
    if (!models) return;
    queueMicrotask(() => stop());
    const [only] = models;
    if (models.length === 1 && only !== undefined && store.model.peek() === undefined) openModel(only);
  });
}

start();
