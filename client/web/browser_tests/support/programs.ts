import { execFile, spawn, type ChildProcess } from 'node:child_process';
import { createInterface } from 'node:readline';
import { promisify } from 'node:util';

const run = promisify(execFile);

/** Path of surfcastd, set by CMake. A plain `npm run browser-test` uses the release build. */
const surfcastd = process.env['SURFCASTD'] ?? '../../build/bin/surfcastd';

/** What the program prints. */
export async function surfcastdRun(...args: string[]): Promise<string> {
  return (await run(surfcastd, args)).stdout;
}

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
