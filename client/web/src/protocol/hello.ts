/**
 * The first message of each side. Its layout is the same in every version of the protocol (protocol/PROTOCOL.md), so
 * that a page and a server of different versions can report why the connection is refused.
 */
export interface Hello {
  readonly major: number;
  readonly minor: number;
  readonly status: number;
  readonly program: string;
  readonly message: string;
}

export const protocolMajor = 1;
export const protocolMinor = 0;
export const statusWelcome = 0;
export const statusVersionRefused = 1;
export const statusBusy = 2;

const magic = [0xf5, 0x53, 0x55, 0x52, 0x46, 0x43, 0x53, 0x54];
const fixedBytes = 18;

export function encodeHello(program: string): Uint8Array {
  const text = new TextEncoder().encode(program);
  const bytes = new Uint8Array(fixedBytes + text.length);
  bytes.set(magic);
  const view = new DataView(bytes.buffer);
  view.setUint16(8, protocolMajor, true);
  view.setUint16(10, protocolMinor, true);
  view.setUint16(14, text.length, true);
  bytes.set(text, fixedBytes);
  return bytes;
}

/** Undefined if the bytes are not a hello. */
export function decodeHello(bytes: Uint8Array): Hello | undefined {
  if (bytes.length < fixedBytes || magic.some((byte, i) => bytes[i] !== byte)) return undefined;
  const view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
  const programBytes = view.getUint16(14, true);
  const messageBytes = view.getUint16(16, true);
  if (bytes.length < fixedBytes + programBytes + messageBytes) return undefined;
  const text = (from: number, size: number): string => new TextDecoder().decode(bytes.subarray(from, from + size));
  return {
    major: view.getUint16(8, true),
    minor: view.getUint16(10, true),
    status: view.getUint16(12, true),
    program: text(fixedBytes, programBytes),
    message: text(fixedBytes + programBytes, messageBytes),
  };
}

/** Why a connection ends; `again`: a retry may succeed. */
export interface Refusal {
  readonly message: string;
  readonly again: boolean;
}

/** The reason to end the connection after the server's hello; undefined if the connection can be used. */
export function refusalIn(hello: Hello | undefined): Refusal | undefined {
  if (!hello) return { message: 'There is no Surfcast server at this address.', again: false };
  if (hello.status === statusBusy) return { message: hello.message || 'The server is busy.', again: true };
  if (hello.major !== protocolMajor || hello.status === statusVersionRefused) {
    const versions = `This page speaks version ${protocolMajor} of the protocol, the server (${hello.program}) version ${hello.major}.`;
    return { message: hello.message ? `${versions} The server says: ${hello.message}` : versions, again: false };
  }
  if (hello.status !== statusWelcome) return { message: hello.message || 'The server refused.', again: false };
  return undefined;
}
