import { create } from '@bufbuild/protobuf';
import { afterEach, beforeEach, describe, expect, it, vi } from 'vitest';
import { WebSocket } from 'ws';
import { DrawPictureSchema, ErrorCode } from '../src/generated/surfcast_pb';
import { backoff } from '../src/protocol/backoff';
import { Connection } from '../src/protocol/connection';
import { decodeHello, encodeHello, refusalIn, type Refusal } from '../src/protocol/hello';
import { Link, type LinkState } from '../src/protocol/link';
import { ViewSession } from '../src/view/view_session';
import type { ArrivedFrame } from '../src/view/frame_decoder';
import { FakeServer, serverHello } from './support/fake_server';

Object.assign(globalThis, { WebSocket });

describe('a hello', () => {
  it('is laid out as the protocol says', () => {
    const bytes = Buffer.from(encodeHello('page'));
    expect(bytes.toString('hex')).toBe('f553555246435354' + '0100' + '0000' + '0000' + '0400' + '0000' + '70616765');
  });

  it('of a server is read whole', () => {
    const hello = decodeHello(serverHello(2, 1, 'this server speaks 2.0'));
    expect(hello).toMatchObject({ major: 2, status: 1, program: 'surfcastd 9.9', message: 'this server speaks 2.0' });
  });

  it('is not seen in anything else, or in its own beginning', () => {
    const whole = serverHello(1, 0, 'message');
    for (let size = 0; size < whole.length; ++size) expect(decodeHello(whole.subarray(0, size))).toBeUndefined();
    expect(decodeHello(Buffer.from('HTTP/1.1 200 OK and more'))).toBeUndefined();
  });

  it('with another version is refused with both named', () => {
    const refusal = refusalIn(decodeHello(serverHello(2, 1, 'get a newer page')));
    expect(refusal?.again).toBe(false);
    expect(refusal?.message).toContain('version 1 ');
    expect(refusal?.message).toContain('version 2');
    expect(refusal?.message).toContain('get a newer page');
  });

  it('of a busy server may be welcome later', () => {
    expect(refusalIn(decodeHello(serverHello(1, 2, 'too many connections')))).toEqual({
      message: 'too many connections',
      again: true,
    });
  });
});

describe('trying again', () => {
  it('waits longer each time, up to a limit, and never all at once', () => {
    expect([0, 1, 2].map((n) => backoff(n, 0))).toEqual([500, 1000, 2000]);
    expect(backoff(1000, 0)).toBe(15_000);
    expect(backoff(1, 1)).toBe(500);
  });
});

let server: FakeServer;
beforeEach(async () => (server = await FakeServer.start()));
afterEach(() => server.stop());

/** Waits until a check passes, however busy the machine. */
const eventually = (check: () => void): Promise<void> => vi.waitFor(check, { timeout: 20_000 });

function connect(): Promise<Connection> {
  return new Promise((resolve, reject) => {
    const connection: Connection = new Connection(server.url, {
      opened: () => resolve(connection),
      closed: reject,
      received: () => undefined,
    });
  });
}

describe('a connection', () => {
  it('says hello first, then asks and is answered', async () => {
    server.answer = () => ({ case: 'modelList', value: { models: ['a', 'b'] } });
    const connection = await connect();
    const list = await connection.ask({ case: 'listModels', value: {} }, 'modelList');
    expect(list.models).toEqual(['a', 'b']);
    expect(server.clientHellos[0]?.subarray(0, 4).toString('hex')).toBe('f5535552');
    connection.close();
  });

  it('tells answers that come in another order apart', async () => {
    const connection = await connect();
    const first = connection.ask({ case: 'describeModel', value: { model: 'a' } }, 'modelDescription');
    const second = connection.ask({ case: 'ping', value: {} }, 'pong');
    await eventually(() => expect(server.requests).toHaveLength(2));
    server.send(server.requests[1]!.id, { case: 'pong', value: {} });
    await second;
    server.send(server.requests[0]!.id, { case: 'modelDescription', value: { model: 'a' } });
    expect((await first).model).toBe('a');
    connection.close();
  });

  it("rejects with the server's error", async () => {
    server.answer = () => ({ case: 'error', value: { code: ErrorCode.NOT_FOUND, message: 'no model x' } });
    const connection = await connect();
    const asked = connection.ask({ case: 'describeModel', value: { model: 'x' } }, 'modelDescription');
    await expect(asked).rejects.toMatchObject({ code: ErrorCode.NOT_FOUND, message: 'no model x' });
    connection.close();
  });

  it('rejects what is outstanding when it ends', async () => {
    const refused: (Refusal | undefined)[] = [];
    const connection = await new Promise<Connection>((resolve) => {
      const made: Connection = new Connection(server.url, {
        opened: () => resolve(made),
        closed: (refusal) => refused.push(refusal),
        received: () => undefined,
      });
    });
    const asked = connection.ask({ case: 'ping', value: {} }, 'pong');
    await eventually(() => expect(server.requests).toHaveLength(1));
    await server.stop();
    await expect(asked).rejects.toMatchObject({ code: ErrorCode.UNAVAILABLE });
    expect(refused).toEqual([undefined]);
  });

  it('ends with a reason when a server talks nonsense', async () => {
    server.hello = Buffer.from('hello, world, this is not the protocol');
    await expect(connect()).rejects.toMatchObject({ again: false });
    server.hello = serverHello(1, 0, '');
    const closed = new Promise<Refusal | undefined>((resolve) => {
      new Connection(server.url, {
        opened: () => server.sendRaw(Buffer.from('ff'.repeat(40), 'hex')),
        closed: resolve,
        received: () => undefined,
      });
    });
    expect((await closed)?.again).toBe(true);
  });
});

describe('a link', () => {
  const states: LinkState[] = [];
  const link: { current?: Link } = {};
  let url = '';
  afterEach(() => link.current?.close());
  const follow = (opened: (connection: Connection, views: readonly bigint[]) => void): void => {
    states.length = 0;
    url = server.url;
    link.current = new Link(() => url, {
      changed: (state) => states.push(state),
      opened,
      closed: () => undefined,
      received: () => undefined,
    });
  };

  it('comes back after the server was away', async () => {
    const opened: Connection[] = [];
    follow((connection) => opened.push(connection));
    await eventually(() => expect(opened).toHaveLength(1));
    const { port } = server;
    await server.stop();
    await eventually(() => expect(states.at(-1)?.kind).toBe('waiting'));
    server = await FakeServer.start(port);
    await eventually(() => expect(opened).toHaveLength(2));
  });

  it('connects anew to another URL, and only then', async () => {
    const opened: Connection[] = [];
    follow((connection) => opened.push(connection));
    await eventually(() => expect(opened).toHaveLength(1));
    link.current?.renew();
    expect(states.at(-1)?.kind).toBe('open');
    url = `${server.url}?model=church`;
    link.current?.renew();
    await eventually(() => expect(opened).toHaveLength(2));
    expect(states.map((state) => state.kind)).toEqual(['connecting', 'open', 'connecting', 'open']);
    expect(server.targets).toEqual(['/ws', '/ws?model=church']);
  });

  it('goes on with its session, and learns which views are open again', async () => {
    const secrets: string[] = [];
    const opened: (readonly bigint[])[] = [];
    const answer: FakeServer['answer'] = ({ kind }) => {
      if (kind.case !== 'resume') return undefined;
      secrets.push(kind.value.session);
      return { case: 'resumed', value: { session: `secret ${secrets.length}`, views: [7n] } };
    };
    server.answer = answer;
    follow((_, views) => opened.push(views));
    await eventually(() => expect(secrets).toEqual(['']));
    const { port } = server;
    await server.stop();
    server = await FakeServer.start(port);
    server.answer = answer;
    await eventually(() => expect(opened).toEqual([[], [7n]]));
    expect(secrets).toEqual(['', 'secret 1']);
  });

  it('comes back at once to whoever goes on for a server that leaves', async () => {
    const opened: Connection[] = [];
    follow((connection) => opened.push(connection));
    await eventually(() => expect(opened).toHaveLength(1));
    vi.spyOn(Date, 'now').mockReturnValue(1000);
    vi.spyOn(Math, 'random').mockReturnValue(0);
    server.leave();
    await eventually(() => expect(opened).toHaveLength(2));
    vi.restoreAllMocks();
    expect(states.find(({ kind }) => kind === 'waiting')).toMatchObject({ until: 1000 });
  });

  it('does not come back to a server of another version', async () => {
    server.hello = serverHello(7, 1, 'this server speaks version 7');
    follow(() => undefined);
    await eventually(() => expect(states.at(-1)?.kind).toBe('refused'));
    expect(states.at(-1)).toMatchObject({ message: expect.stringContaining('version 7') as string });
  });
});

describe('a view', () => {
  const picture = create(DrawPictureSchema, { model: 'a' });

  it('numbers its updates, joins pieces, and answers every message once', async () => {
    const frames: ArrivedFrame[] = [];
    const connection = await connect();
    const view = new ViewSession(connection, picture, {
      frame: (frame) => frames.push(frame),
      failed: () => undefined,
    });
    expect([view.update(picture, true), view.update(picture, false)]).toEqual([1n, 2n]);
    await eventually(() => expect(server.requests).toHaveLength(3));
    const { id } = server.requests[0]!;
    expect(server.requests.map((request) => request.id)).toEqual([id, id, id]);

    const piece = (frame: bigint, data: number[], more: boolean): void =>
      server.send(id, { case: 'viewFrame', value: { frame, more, picture: { data: Uint8Array.from(data) } } });
    piece(1n, [9], true); // never completed
    piece(2n, [1, 2], true);
    piece(2n, [3], true);
    piece(2n, [4, 5], false);
    await eventually(() => expect(frames).toHaveLength(1));
    expect([...frames[0]!.frame.picture!.data]).toEqual([1, 2, 3, 4, 5]);
    view.acknowledge(2n, 3.5);

    const painted = () => server.requests.filter((request) => request.kind.case === 'framePainted');
    await eventually(() => expect(painted()).toHaveLength(4));
    expect(painted().map((request) => (request.kind.value as { frame: bigint }).frame)).toEqual([1n, 2n, 2n, 2n]);
    connection.close();
  });

  it('goes on over another connection under its id', async () => {
    const frames: ArrivedFrame[] = [];
    const first = await connect();
    const view = new ViewSession(first, picture, { frame: (frame) => frames.push(frame), failed: () => undefined });
    view.update(picture, false);
    first.close();
    const second = await connect();
    view.goOn(second);
    server.send(view.id, { case: 'viewFrame', value: { frame: 1n, update: 1n, picture: {} } });
    await eventually(() => expect(frames).toHaveLength(1));
    expect(view.update(picture, false)).toBe(2n);
    await eventually(() => expect(server.requests.at(-1)?.id).toBe(view.id));
    second.close();
  });

  it('that the server ends says why', async () => {
    const connection = await connect();
    const failed = new Promise((resolve) => {
      new ViewSession(connection, picture, { frame: () => undefined, failed: resolve });
    });
    await eventually(() => expect(server.requests).toHaveLength(1));
    const { id } = server.requests[0]!;
    server.send(id, { case: 'error', value: { code: ErrorCode.UNAVAILABLE, message: 'busy' } });
    expect(await failed).toMatchObject({ code: ErrorCode.UNAVAILABLE, message: 'busy' });
    connection.close();
  });
});
