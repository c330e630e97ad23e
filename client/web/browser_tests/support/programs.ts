import { execFile, spawn, type ChildProcess } from 'node:child_process';
import { connect, createServer, type AddressInfo } from 'node:net';
import { createInterface } from 'node:readline';
import { promisify } from 'node:util';

const run = promisify(execFile);

/** Path of surfcastd, set by CMake. A plain `npm run browser-test` uses the release build. */
const surfcastd = process.env['SURFCASTD'] ?? '../../build/bin/surfcastd';

/** What the program prints. */
export async function surfcastdRun(...args: string[]): Promise<string> {
  return (await run(surfcastd, args)).stdout;
}

/** The program beside it that emulates a link. */
const linkRelay = surfcastd.replace(/surfcastd$/, 'link_relay');

/** An emulated link to a server on this machine. */
export class LinkRelay {
  private constructor(
    private readonly process: ChildProcess,
    readonly port: number,
  ) {}

  static async start(server: Server, megabits: number, roundTrip: number): Promise<LinkRelay> {
    const port = await freePort();
    const process = spawn(linkRelay, [port, server.port, megabits, roundTrip].map(String), { stdio: 'ignore' });
    while (!(await accepts(port))) {
      if (process.exitCode !== null) throw new Error('link_relay ended before it was ready');
    }
    return new LinkRelay(process, port);
  }

  async stop(): Promise<void> {
    const ended = new Promise((resolve) => this.process.once('exit', resolve));
    this.process.kill('SIGTERM');
    await ended;
  }
}

/** A port on which nothing listens. */
async function freePort(): Promise<number> {
  const server = createServer();
  await new Promise<void>((resolve) => server.listen(0, '127.0.0.1', resolve));
  const { port } = server.address() as AddressInfo;
  await new Promise((resolve) => server.close(resolve));
  return port;
}

const accepts = (port: number): Promise<boolean> =>
  new Promise((resolve) => {
    const socket = connect(port, '127.0.0.1');
    const end = (accepted: boolean): void => {
      socket.destroy();
      resolve(accepted);
    };
    socket.once('connect', () => end(true));
    socket.once('error', () => end(false));
  });

export class Server {
  private constructor(
    private readonly process: ChildProcess,
    readonly url: string, // ends with a slash
  ) {}

  static async start(model: string, port = 0, ...more: string[]): Promise<Server> {
    const process = spawn(surfcastd, ['serve', model, '--listen', `127.0.0.1:${port}`, ...more], {
      stdio: ['ignore', 'pipe', 'ignore'],
    });
    for await (const line of createInterface({ input: process.stdout! })) {
      const url = /http:\S+/.exec(line)?.[0];
      if (url) return new Server(process, url);
    }
    throw new Error('surfcastd ended before it was ready');
  }

  get port(): number {
    return Number(new URL(this.url).port);
  }

  /** Kills the server, as a crash or power failure would. */
  async kill(): Promise<void> {
    const ended = new Promise((resolve) => this.process.once('exit', resolve));
    if (this.process.exitCode !== null || this.process.signalCode !== null) return;
    this.process.kill('SIGKILL');
    await ended;
  }
}
