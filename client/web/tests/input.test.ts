import { describe, expect, it } from 'vitest';
import { coast, coastDecay, releaseVelocity } from '../src/camera/inertia';
import { vector } from '../src/camera/vector';
import { projectionOf, project } from '../src/camera/projection';
import { isClick, isDouble, pinchBetween, wheelPixels } from '../src/input/gestures';
import { handleAt, handlesOf, pulled, pullOf } from '../src/overlay/clip_handles';
import { CameraAnimator } from '../src/view/camera_animator';
import type { Pose } from '../src/camera/pose';

describe('two fingers', () => {
  const a = { x: 100, y: 100 };
  const b = { x: 200, y: 100 };

  it('move together', () => {
    const pinch = pinchBetween([a, b], [{ x: 110, y: 120 }, { x: 210, y: 120 }]);
    expect(pinch).toEqual({ center: { x: 160, y: 120 }, moved: { x: 10, y: 20 }, spread: 1, twist: 0 });
  });

  it('spread and twist', () => {
    const pinch = pinchBetween([a, b], [{ x: 150, y: 0 }, { x: 150, y: 200 }]);
    expect(pinch.spread).toBe(2);
    expect(pinch.twist).toBeCloseTo(Math.PI / 2, 12);
  });

  it('that touch each other neither zoom nor turn wildly', () => {
    const pinch = pinchBetween([a, { x: 101, y: 100 }], [a, b]);
    expect([pinch.spread, pinch.twist]).toEqual([1, 0]);
  });
});

describe('a wheel', () => {
  it('counts lines, pages and pinches as pixels', () => {
    expect(wheelPixels({ deltaY: 3, deltaMode: 1, ctrlKey: false })).toBe(99);
    expect(wheelPixels({ deltaY: 1, deltaMode: 2, ctrlKey: false })).toBe(400);
    expect(wheelPixels({ deltaY: -2, deltaMode: 0, ctrlKey: true })).toBe(-14);
    expect(wheelPixels({ deltaY: 90_000, deltaMode: 0, ctrlKey: false })).toBe(400);
  });
});

describe('a press', () => {
  const down = { at: { x: 10, y: 10 }, time: 1000 };

  it('is a click if the hand hardly moves and soon lets go', () => {
    expect(isClick(down, { at: { x: 12, y: 12 }, time: 1200 })).toBe(true);
    expect(isClick(down, { at: { x: 16, y: 10 }, time: 1200 })).toBe(false);
    expect(isClick(down, { at: { x: 10, y: 10 }, time: 1600 })).toBe(false);
  });

  it('is double if another came just before, near it', () => {
    expect(isDouble(down, { at: { x: 14, y: 10 }, time: 1250 })).toBe(true);
    expect(isDouble(down, { at: { x: 60, y: 10 }, time: 1250 })).toBe(false);
    expect(isDouble(undefined, down)).toBe(false);
  });
});

describe('a hand that lets go', () => {
  const moved = [0, 20, 40].map((time) => ({ time, at: { x: time * 2, y: 0 } }));

  it('leaves its speed behind', () => {
    expect(releaseVelocity(moved, 45)).toEqual({ x: 2, y: 0 });
  });

  it('leaves none if it had stopped', () => {
    expect(releaseVelocity(moved, 90)).toEqual({ x: 0, y: 0 });
    expect(releaseVelocity([], 0)).toEqual({ x: 0, y: 0 });
  });

  it('coasts as far in one step as in many', () => {
    const once = coast({ x: 2, y: 0 }, 100, coastDecay);
    const half = coast({ x: 2, y: 0 }, 50, coastDecay);
    const rest = coast(half.velocity, 50, coastDecay);
    expect(half.moved.x + rest.moved.x).toBeCloseTo(once.moved.x, 12);
    expect(rest.velocity.x).toBeCloseTo(once.velocity.x, 12);
  });
});

describe('the motor', () => {
  const pose: Pose = { position: vector(0, 0, 0), yaw: 0, pitch: 0, distance: 10, viewAngle: 30 };
  const there: Pose = { ...pose, position: vector(5, 0, 0) };

  it('travels, arrives exactly, and stops', () => {
    const animator = new CameraAnimator();
    animator.travel(pose, there, 1000, 400);
    expect(animator.step(pose, 'z', 1000)).toEqual(pose);
    expect(animator.step(pose, 'z', 1200).position.x).toBeCloseTo(2.5, 9);
    expect(animator.step(pose, 'z', 1400)).toBe(there);
    expect(animator.moving).toBe(false);
  });

  it('coasts on after a drag until nobody would see it', () => {
    const animator = new CameraAnimator();
    let at: Pose = pose;
    let far = 0;
    animator.coastOn({ x: 1, y: 0 }, (p, by) => {
      far += by.x;
      return p;
    });
    let time = 0;
    for (; animator.moving; time += 16) at = animator.step(at, 'z', time);
    expect(far).toBeGreaterThan(coastDecay * 0.9);
    expect(far).toBeLessThan(coastDecay);
    expect(time).toBeLessThan(2000);
  });

  it('flies while keys are held, as far in a second whatever the frame rate', () => {
    const gone = (step: number): number => {
      const animator = new CameraAnimator();
      let at: Pose = pose;
      animator.flyAlong({ right: 0, forward: 1, up: 0 }, 0.01);
      for (let time = 0; time <= 1000; time += step) at = animator.step(at, 'z', time);
      return at.position.y;
    };
    expect(gone(10)).toBeCloseTo(10, 9);
    expect(gone(50)).toBeCloseTo(10, 9);
  });
});

describe('a handle of a clip box', () => {
  const box = { min: vector(-1, -2, -3), max: vector(1, 2, 3) };
  const view = projectionOf({ position: vector(0, -20, 0), focalPoint: vector(0, 0, 0), viewAngle: 40 }, vector(0, 0, 1), 800, 600);
  const right = handlesOf(box).find((handle) => handle.axis === 'x' && handle.end === 'max')!;

  it('is found near its side', () => {
    const at = project(view, right.at)!;
    expect(handleAt(box, view, { x: at.x + 5, y: at.y - 5 }, 10)).toEqual(right);
    expect(handleAt(box, view, { x: at.x + 50, y: at.y }, 10)).toBeUndefined();
  });

  it('follows the hand along its axis', () => {
    const from = project(view, right.at)!;
    const to = project(view, vector(1.5, 0, 0))!;
    expect(pullOf(right, view, { x: to.x - from.x, y: 99 }, 10)).toBeCloseTo(0.5, 2);
  });

  it('stays when its axis points at the eye', () => {
    const back = handlesOf(box).find((handle) => handle.axis === 'y')!;
    expect(pullOf(back, view, { x: 10, y: 10 }, 10)).toBe(0);
  });

  it('pushes the other side rather than turning the box inside out', () => {
    expect(pulled(box, { axis: 'x', end: 'max' }, -5)).toEqual({ min: vector(-5, -2, -3), max: vector(-5, 2, 3) });
    expect(pulled(box, { axis: 'z', end: 'min' }, 0)).toEqual({ min: vector(-1, -2, 0), max: box.max });
  });
});
