import { equals } from '@bufbuild/protobuf';
import { batch, effect } from '@preact/signals';
import { cameraOf, poseOf, skyOf, type Camera } from '../camera/pose';
import type { Vector } from '../camera/vector';
import {
  DrawPictureSchema,
  ErrorCode,
  type DrawPicture,
  type ModelList,
  type PickResult,
  type Picture,
  type Profile,
} from '../generated/surfcast_pb';
import { backoff } from '../protocol/backoff';
import { RequestError, type Connection } from '../protocol/connection';
import { Link } from '../protocol/link';
import { pictureOf } from '../protocol/pictures';
import { hiddenAt } from '../state/joined';
import { awaited, failed, renewed } from '../state/scans';
import * as store from '../state/store';
import { FigureCollector } from './figures';
import { FrameDecoder, type ArrivedFrame, type DecodedFrame } from './frame_decoder';
import { decodesVideo } from './packet_decoder';
import { Screen, type Canvases } from './screen';
import { ViewSession, type ViewEvents } from './view_session';

/** A requested picture, and whether more requests will follow soon. */
interface ViewRequest {
  readonly picture: DrawPicture;
  readonly moving: boolean;
}

const sameRequest = (a: ViewRequest | undefined, b: ViewRequest): boolean =>
  a?.moving === b.moving && equals(DrawPictureSchema, a.picture, b.picture);

const figuresEvery = 500; // ms
const listEvery = 500; // ms, while scans are being built

/** A view whose connection is gone. The server may have kept it. */
interface LostView {
  readonly session: ViewSession;
  readonly sent: ViewRequest | undefined;
}

/**
 * Synchronizes the page and the server. Sends changes of the store's model, pose and display options, at most one
 * update per animation frame, and shows the frames received, warped to the present camera. Reopens the view when the
 * connection is lost.
 */
export class ViewController {
  private readonly link: Link;
  private readonly decoder: FrameDecoder;
  private readonly screen: Screen;
  private readonly collector = new FigureCollector();
  private connection: Connection | undefined;
  private session: ViewSession | undefined;
  private sent: ViewRequest | undefined;
  private lost: LostView | undefined;
  private readonly sentAt = new Map<bigint, number>(); // update: performance.now()
  private scheduled = false;
  private video = false; // the browser decodes videos
  private ticking = false; // an animation frame is requested
  private taken: DecodedFrame | undefined; // in this animation frame
  private failures = 0;
  private retryTimer: ReturnType<typeof setTimeout> | undefined;
  private listTimer: ReturnType<typeof setTimeout> | undefined;

  /** `step` advances animations of the eye to the given time. */
  constructor(
    url: () => string,
    canvases: Canvases,
    private readonly step: (now: number) => boolean,
  ) {
    this.screen = new Screen(canvases, () => this.tick());
    const events = {
      ready: () => this.tick(),
      skipped: (frame: ArrivedFrame) => this.skipped(frame),
      broken: (frame: ArrivedFrame) => this.broken(frame),
    };
    this.decoder = new FrameDecoder(events, () => this.screen.coarse);
    void decodesVideo().then((decodes) => (this.video = decodes));
    this.link = new Link(url, {
      changed: (state) => (store.link.value = state),
      opened: (connection, views) => this.opened(connection, views),
      closed: () => this.closed(),
      received: (bytes) => this.collector.bytes(bytes, performance.now()),
    });
    effect(() => this.follow(store.model.value));
    effect(() => {
      // Reading the signals subscribes this effect to them.
      void [store.pose.value, store.display.value, store.stageSize.value, store.moving.value, store.swipe.value];
      this.schedule();
    });
    addEventListener('pagehide', () => this.link.close());
    addEventListener('pageshow', (event) => {
      if (event.persisted) location.reload(); // restored from the back/forward cache, without a connection
    });
    setInterval(() => (store.figures.value = this.collector.figures(performance.now())), figuresEvery);
  }

  retry(): void {
    this.failures = 0;
    this.link.retry();
    this.openView();
  }

  /** With the next animation frame, advances animations and sends an update if something has changed. */
  schedule(): void {
    if (this.scheduled) return;
    this.scheduled = true;
    store.updatePending.value = true;
    this.tick();
  }

  private tick(): void {
    if (this.ticking) return;
    this.ticking = true;
    requestAnimationFrame((now) => batch(() => this.animate(now)));
  }

  /** One animation frame: the eye moves first, so that the screen shows where it is now. */
  private animate(now: number): void {
    this.ticking = false;
    const due = this.scheduled;
    this.scheduled = false;
    if (due && this.step(now)) this.schedule();
    const newest = this.decoder.newestFrame();
    if (newest) this.take(newest);
    if (due) {
      this.send();
      store.updatePending.value = this.scheduled;
    }
    const shown = this.screen.show(this.presentCamera(), skyOf(store.upAxis.peek()));
    if (shown) store.shownCamera.value = shown;
    this.report();
  }

  /** Once for each frame, when it is on the GPU: the time steers the server. Later warps of it do not count. */
  private report(): void {
    const { taken } = this;
    this.taken = undefined;
    if (!taken) return;
    const { frame, arrived } = taken;
    const painted = performance.now();
    if (!frame.more) {
      this.collector.painted({ ...taken, painted }, this.sentAt.get(frame.update));
      this.session?.acknowledge(frame.frame, painted - arrived);
    }
    // Later frames of the same update are refinements, whose delay is not a latency.
    for (const update of this.sentAt.keys()) if (update <= frame.update) this.sentAt.delete(update);
  }

  async pick(picture: DrawPicture, x: number, y: number): Promise<PickResult> {
    return this.connected().ask({ case: 'pickSurfel', value: { picture, x, y } }, 'pickResult');
  }

  /** The points of the scan in a band along a line, at most `maxPoints` of them. */
  async profile(model: string, line: readonly Vector[], width: number, maxPoints: number): Promise<Profile> {
    const value = { model, line: line.map(({ x, y, z }) => ({ x, y, z })), width, maxPoints };
    return this.connected().ask({ case: 'getProfile', value }, 'profile');
  }

  /** `started` receives a function that cancels the request. */
  async draw(picture: DrawPicture, started: (cancel: () => void) => void): Promise<Picture> {
    const connection = this.connected();
    return connection.ask({ case: 'drawPicture', value: picture }, 'picture', (id) =>
      started(() => {
        void connection.ask({ case: 'cancel', value: { requestId: id } }, 'cancelResult').catch(() => undefined);
      }),
    );
  }

  private connected(): Connection {
    if (this.connection) return this.connection;
    throw new RequestError(ErrorCode.UNAVAILABLE, 'There is no connection to the server.');
  }

  private opened(connection: Connection, views: readonly bigint[]): void {
    this.connection = connection;
    const kept = this.lost && views.includes(this.lost.session.id) ? this.lost : undefined;
    this.lost = undefined;
    if (kept) this.goOn(connection, kept);
    for (const view of views.filter((id) => id !== kept?.session.id)) {
      void connection.ask({ case: 'closeView', value: { view } }, 'viewClosed').catch(() => undefined);
    }
    void this.listModels(connection);
    this.openView();
  }

  /** The server has opened the view again; what has changed meanwhile is sent. */
  private goOn(connection: Connection, { session, sent }: LostView): void {
    clearTimeout(this.retryTimer);
    store.viewProblem.value = undefined;
    this.decoder.reset();
    this.session = session;
    this.sent = sent;
    session.goOn(connection);
    this.schedule();
  }

  private closed(): void {
    const { lost } = this;
    this.connection = undefined;
    this.endView();
    this.lost = lost;
  }

  /** Asks for the models now, and again as long as scans are being built. */
  refreshModels(): void {
    if (this.connection) void this.listModels(this.connection);
  }

  private async listModels(connection: Connection): Promise<void> {
    clearTimeout(this.listTimer);
    try {
      this.takeModels(await connection.ask({ case: 'listModels', value: {} }, 'modelList'));
    } catch {
      return; // The connection has ended; the next one repeats the request.
    }
    const building = [...store.scans.peek().values()].some((scan) => !failed(scan));
    if (building) this.listTimer = setTimeout(() => this.refreshModels(), listEvery);
  }

  private takeModels(list: ModelList): void {
    const scans = new Map(list.scans.map((scan) => [scan.model, scan]));
    const names = renewed(store.scans.peek(), scans);
    batch(() => {
      store.scans.value = scans;
      store.uploads.value = list.uploads;
      store.models.value = list.models;
    });
    for (const name of names) {
      if (store.descriptions.peek().has(name)) this.describe(name).catch(() => undefined);
    }
    const open = store.model.peek();
    if (open !== undefined && !this.session && (names.includes(open) || scans.has(open))) this.openView();
  }

  async describe(name: string): Promise<void> {
    const description = await this.connected().ask(
      { case: 'describeModel', value: { model: name } },
      'modelDescription',
    );
    store.descriptions.value = new Map(store.descriptions.value).set(name, description);
  }

  private follow(model: string | undefined): void {
    this.failures = 0;
    this.endView();
    store.viewProblem.value = undefined;
    store.shownFrame.value = undefined;
    store.shownCamera.value = undefined;
    this.decoder.reset(); // a frame of the former model that is still being decoded must not be shown
    this.screen.freeze();
    if (model === undefined) return;
    if ((store.models.peek()?.length ?? 0) > 1) this.link.renew();
    this.openView();
  }

  private openView(): void {
    clearTimeout(this.retryTimer);
    const model = store.model.peek();
    const connection = this.connection;
    if (model === undefined || !connection || this.session) return;
    const scan = store.scans.peek().get(model);
    if (awaited(scan)) {
      store.viewProblem.value = undefined;
      return; // the list of models tells when there is a preview
    }
    this.describe(model).then(
      () => {
        if (connection === this.connection && model === store.model.peek()) this.start(connection);
      },
      (error: unknown) => this.failed(error),
    );
  }

  private start(connection: Connection): void {
    const camera = store.firstCamera.peek();
    if (camera) store.pose.value = poseOf(camera, store.upAxis.peek());
    store.firstCamera.value = undefined;
    const request = this.currentRequest();
    if (!request || this.session) return;
    store.viewProblem.value = undefined;
    this.decoder.reset();
    this.sentAt.clear();
    store.wantedUpdate.value = 0n;
    this.sent = { ...request, moving: false };
    const events: ViewEvents = {
      frame: (frame) => {
        if (this.sharpens(frame)) void this.decoder.take(frame);
      },
      failed: (error) => {
        this.lost = { session, sent: this.sent };
        this.session = undefined;
        this.failed(error);
      },
    };
    const session = new ViewSession(connection, request.picture, events, {
      depth: this.screen.warps,
      video: this.video,
    });
    this.session = session;
    this.lost = undefined;
    this.schedule();
  }

  /** A frame of which more follows is sharper than one in motion, but not than another one at rest. */
  private sharpens({ frame }: ArrivedFrame): boolean {
    const shown = store.shownFrame.peek();
    return !frame.more || !shown || shown.moving || shown.frame === frame.frame;
  }

  private skipped({ frame, arrived }: ArrivedFrame): void {
    if (!frame.more) this.session?.acknowledge(frame.frame, performance.now() - arrived);
  }

  /** A frame that cannot be decoded is not shown. If it is a packet of a video, the view goes on without one. */
  private broken(broken: ArrivedFrame): void {
    const { frame } = broken;
    this.skipped(broken);
    if (!frame.video || !this.video) return;
    this.video = false;
    this.endView();
    this.openView();
  }

  private endView(): void {
    clearTimeout(this.retryTimer);
    this.session?.close();
    this.session = undefined;
    this.sent = undefined;
    this.lost = undefined;
    store.frameIsCurrent.value = false;
  }

  private failed(error: unknown): void {
    if (!this.connection) return; // the link reports the problem and reconnects
    const again = error instanceof RequestError && error.code === ErrorCode.UNAVAILABLE;
    store.viewProblem.value = { message: error instanceof Error ? error.message : String(error), again };
    if (again) this.retryTimer = setTimeout(() => this.openView(), backoff(this.failures++, Math.random()));
  }

  private currentRequest(): ViewRequest | undefined {
    const model = store.model.peek();
    const size = store.stageSize.peek();
    if (model === undefined || size.width < 1 || size.height < 1) return undefined;
    const display = store.display.peek();
    const hiddenModels = hiddenAt('left', display.hiddenModels, store.swipe.peek());
    const picture = pictureOf(model, this.presentCamera(), { ...display, hiddenModels }, size);
    return { picture, moving: store.moving.peek() };
  }

  /** The camera that is asked for; undefined until the server has chosen one. */
  private presentCamera(): Camera | undefined {
    const pose = store.pose.peek();
    return pose && cameraOf(pose, store.upAxis.peek(), store.display.peek().upsideDown);
  }

  private send(): void {
    const request = this.currentRequest();
    if (!request) return;
    if (!this.session) {
      if (this.connection && store.description.peek() && !store.viewProblem.peek()) this.start(this.connection);
      return;
    }
    if (sameRequest(this.sent, request)) return;
    const same = this.sent !== undefined && equals(DrawPictureSchema, this.sent.picture, request.picture);
    this.sent = request;
    const update = this.session.update(request.picture, request.moving);
    this.sentAt.set(update, performance.now());
    if (!same) store.wantedUpdate.value = update;
  }

  private take(decoded: DecodedFrame): void {
    const { frame } = decoded;
    this.failures = 0;
    this.taken = decoded;
    store.shownFrame.value = withoutData(decoded);
    store.frameIsCurrent.value = this.session !== undefined;
    this.screen.take(decoded, skyOf(store.upAxis.peek()));
    if (!store.pose.peek() && frame.update >= store.wantedUpdate.peek()) this.adopt(decoded);
  }

  /** Adopts the view that the server chose, without requesting it again. */
  private adopt({ camera }: DecodedFrame): void {
    const untouched = this.sent && sameRequest(this.sent, this.currentRequest() ?? this.sent);
    store.pose.value = poseOf(camera, store.upAxis.peek());
    if (untouched) this.sent = this.currentRequest();
  }
}

function withoutData({ frame }: ArrivedFrame): ArrivedFrame['frame'] {
  return frame.picture ? { ...frame, picture: { ...frame.picture, data: new Uint8Array() } } : frame;
}
