import { create, fromBinary, toBinary, type MessageInitShape } from '@bufbuild/protobuf';
import type { AddressInfo } from 'node:net';
import { WebSocketServer, type WebSocket as Socket } from 'ws';
import { AnswerSchema, RequestSchema, type Request } from '../../src/generated/surfcast_pb';

type AnswerInit = NonNullable<MessageInitShape<typeof AnswerSchema>['kind']>;

/** Bytes of a server's hello (protocol/PROTOCOL.md), encoded independently of the tested code. */
export function serverHello(major: number, status: number, message: string): Buffer {
  const program = Buffer.from('surfcastd 9.9');
  const fixed = Buffer.alloc(18);
  Buffer.from([0xf5, 0x53, 0x55, 0x52, 0x46, 0x43, 0x53, 0x54]).copy(fixed);
  fixed.writeUInt16LE(major, 8);
  fixed.writeUInt16LE(status, 12);
  fixed.writeUInt16LE(program.length, 14);
  fixed.writeUInt16LE(Buffer.byteLength(message), 16);
  return Buffer.concat([fixed, program, Buffer.from(message)]);
}

/** A server of the protocol whose answers a test determines. */
export class FakeServer {
  readonly requests: Request[] = [];
  hello: Buffer = serverHello(1, 0, '');
  /** The answer to a request; undefined: none. */
  answer: (request: Request) => AnswerInit | undefined = () => undefined;
  clientHellos: Buffer[] = [];
  /** Of the connections, as they were asked for. */
  readonly targets: string[] = [];
  private readonly server: WebSocketServer;
  private readonly sockets = new Set<Socket>();

  private constructor(port: number) {
    this.server = new WebSocketServer({ port, host: '127.0.0.1', handleProtocols: () => 'surfcast.v1' });
    this.server.on('connection', (socket, request) => {
      this.targets.push(request.url ?? '');
      this.serve(socket);
    });
  }

  static async start(port = 0): Promise<FakeServer> {
    const fake = new FakeServer(port);
    await new Promise((resolve) => fake.server.once('listening', resolve));
    return fake;
  }

  get port(): number {
    return (this.server.address() as AddressInfo).port;
  }

  get url(): string {
    return `ws://127.0.0.1:${this.port}/ws`;
  }

  send(id: bigint, kind: AnswerInit): void {
    const bytes = toBinary(AnswerSchema, create(AnswerSchema, { id, kind }));
    for (const socket of this.sockets) socket.send(bytes);
  }

  sendRaw(bytes: Buffer): void {
    for (const socket of this.sockets) socket.send(bytes);
  }

  /** Says that it goes away, as a server does that stops. */
  leave(): void {
    for (const socket of this.sockets) socket.close(1001);
  }

  async stop(): Promise<void> {
    for (const socket of this.sockets) socket.terminate();
    await new Promise((resolve) => this.server.close(resolve));
  }

  private serve(socket: Socket): void {
    this.sockets.add(socket);
    socket.on('close', () => this.sockets.delete(socket));
    socket.once('message', (hello: Buffer) => {
      this.clientHellos.push(hello);
      socket.send(this.hello);
      socket.on('message', (bytes: Buffer) => this.take(fromBinary(RequestSchema, bytes)));
    });
  }

  private take(request: Request): void {
    this.requests.push(request);
    const kind = this.answer(request);
    if (kind) this.send(request.id, kind);
  }
}
