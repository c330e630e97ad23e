import { create } from '@bufbuild/protobuf';
import { describe, expect, it } from 'vitest';
import { FileFormat, ViewFrameSchema, type ViewFrame } from '../src/generated/surfcast_pb';
import * as store from '../src/state/store';
import { FrameAssembler } from '../src/view/assembler';
import { endedAt, showableBytes } from '../src/view/jpeg_scans';
import { progressiveJpeg as file } from './support/jpeg';

const lengths = Array.from({ length: file.length + 1 }, (_, length) => length);
const showable = lengths.map((length) => showableBytes(file.subarray(0, length)));

describe('what can be shown of a progressive JPEG file', () => {
  it('grows with the file and ends where a marker follows', () => {
    for (const [length, shown] of showable.entries()) {
      expect(shown).toBeLessThanOrEqual(length);
      expect(shown).toBeGreaterThanOrEqual(showable[length - 1] ?? 0);
      if (shown > 0) expect(file[shown]).toBe(0xff);
    }
    expect(showable.at(-1)).toBe(file.length - 2);
    expect(new Set(showable).size).toBeGreaterThanOrEqual(5);
  });

  it('ends as a file', () => {
    const shown = showable.find((bytes) => bytes > 0)!;
    const ended = endedAt(file, shown);
    expect([...ended.subarray(0, shown)]).toEqual([...file.subarray(0, shown)]);
    expect([...ended.subarray(shown)]).toEqual([0xff, 0xd9]);
  });

  it('is nothing of other bytes', () => {
    const header = [0xff, 0xd8, 0xff, 0xc2, 0, 1]; // of a length that is none
    for (const bytes of [[], [0xff], [0xff, 0xd8], header, [0x89, 0x50], new Array<number>(64).fill(0xff)]) {
      expect(showableBytes(Uint8Array.from(bytes))).toBe(0);
    }
  });

  it('lies within a damaged file', () => {
    for (let at = 0; at < file.length; ++at) {
      for (const value of [0, 0xff, 0xda]) {
        const damaged = Uint8Array.from(file);
        damaged[at] = value;
        expect(showableBytes(damaged)).toBeLessThanOrEqual(damaged.length);
      }
    }
  });
});

describe('a frame in pieces', () => {
  const piece = (data: Uint8Array, more: boolean, format = FileFormat.JPEG): ViewFrame =>
    create(ViewFrameSchema, { frame: 1n, more, picture: { data, format } });
  const first = showable.find((bytes) => bytes > 0)! + 2;

  it('is handed on before it is whole, once for each part that can be shown', () => {
    const assembler = new FrameAssembler();
    const early = assembler.take(piece(file.subarray(0, first), true), 5, 1);
    expect(early?.frame.more).toBe(true);
    expect([...early!.frame.picture!.data]).toEqual([...endedAt(file, first - 2)]);
    expect(assembler.take(piece(file.subarray(first, first + 1), true), 1, 2)).toBeUndefined();
    const whole = assembler.take(piece(file.subarray(first + 1), false), 4, 3);
    expect(whole).toMatchObject({ frame: { more: false }, bytes: 10, arrived: 3 });
    expect([...whole!.frame.picture!.data]).toEqual([...file]);
  });

  it('is not the final picture of a view before its last piece', () => {
    store.frameIsCurrent.value = true;
    for (const more of [true, false]) {
      store.shownFrame.value = create(ViewFrameSchema, { more, picture: { converged: true } });
      expect(store.pictureSettled.value).toBe(!more);
    }
  });

  it('begins anew with the next one', () => {
    const assembler = new FrameAssembler();
    assembler.take(piece(file.subarray(0, first), true), 5, 1);
    const next = create(ViewFrameSchema, { ...piece(file.subarray(0, first), true), frame: 2n });
    expect(assembler.take(next, 5, 1)?.frame.more).toBe(true);
  });

  it('of another format waits for its last piece', () => {
    const assembler = new FrameAssembler();
    expect(assembler.take(piece(file.subarray(0, -1), true, FileFormat.PNG), 5, 1)).toBeUndefined();
  });
});
