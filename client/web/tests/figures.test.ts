import { create } from '@bufbuild/protobuf';
import { describe, expect, it } from 'vitest';
import { ViewFrameSchema } from '../src/generated/surfcast_pb';
import { FigureCollector, median, stageNames, stagesOf } from '../src/view/figures';
import type { PaintedFrame } from '../src/view/frame_decoder';
import { pixelsOf } from '../src/view/stage_size';

const stages = [
  { name: 'queue', milliseconds: 1 },
  { name: 'select', milliseconds: 1 },
  { name: 'load', milliseconds: 4 },
  { name: 'decode', milliseconds: 40 }, // sum over the workers, during `load`
  { name: 'project', milliseconds: 5 },
  { name: 'splat', milliseconds: 10 },
  { name: 'encode', milliseconds: 3 },
];

const painted = (at: number, moving = true): PaintedFrame => ({
  frame: create(ViewFrameSchema, { moving, picture: { stages } }),
  bytes: 1000,
  arrived: at - 6,
  decoded: at - 2,
  painted: at,
});

describe('the time of a frame', () => {
  it('is parted so that the parts make up the whole', () => {
    const parts = stagesOf(painted(100), 40);
    expect(parts).toEqual({ wait: 2, load: 4, draw: 15, encode: 3, network: 30, decode: 4, paint: 2 });
    expect(stageNames.reduce((sum, name) => sum + parts[name], 0)).toBe(60);
  });
});

describe('figures', () => {
  it('count the frames and bytes of the last two seconds', () => {
    const collector = new FigureCollector();
    for (let at = 0; at <= 4000; at += 50) {
      collector.painted(painted(at), at - 60);
      collector.bytes(1000, at);
    }
    const figures = collector.figures(4000);
    expect(figures.framesPerSecond).toBeCloseTo(20, 9);
    expect(figures.bytesPerSecond).toBe(20_000);
    expect(figures.latency).toBe(60);
  });

  it('keep the latency of the last movement, but no rate at rest', () => {
    const collector = new FigureCollector();
    collector.painted(painted(0), -60);
    collector.painted(painted(50), -10);
    collector.painted(painted(900, false), 100); // the refined picture at rest, delayed on purpose
    expect(collector.figures(1000).latency).toBe(60);
    const later = collector.figures(9000);
    expect([later.framesPerSecond, later.bytesPerSecond, later.latency]).toEqual([0, 0, 60]);
  });

  it('have a median', () => {
    expect(median([5, 1, 100])).toBe(5);
    expect(median([])).toBeUndefined();
  });
});

describe('the size of the picture', () => {
  it('is that of the screen, within reason', () => {
    expect(pixelsOf(1440, 900, 1)).toEqual({ width: 1440, height: 900 });
    expect(pixelsOf(390, 700, 3)).toEqual({ width: 780, height: 1400 });
    const huge = pixelsOf(3840, 2160, 2);
    expect(huge.width * huge.height).toBeLessThan(2560 * 1600 * 1.001);
    expect(huge.width / huge.height).toBeCloseTo(3840 / 2160, 2);
  });
});
