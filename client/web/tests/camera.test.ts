import { describe, expect, it } from 'vitest';
import { between, fly, orbit, pan, turnBetween, zoom } from '../src/camera/motion';
import { cameraOf, flipped, poseAxes, poseOf, skyOf, type Pose, type UpAxis } from '../src/camera/pose';
import { pointAt, project, projectionOf, projectLine, type Projection } from '../src/camera/projection';
import { corners, fit, standardView, viewAlong, viewNames } from '../src/camera/standard_views';
import { distance, dot, vector, type Vector } from '../src/camera/vector';
import { expectNear, expectPixel } from './support/near';

const pose: Pose = { position: vector(10, -20, 5), yaw: 0.4, pitch: -0.3, distance: 25, viewAngle: 40 };
const ups: readonly UpAxis[] = ['y', 'z', '-y', '-z'];

function seen(from: Pose, up: UpAxis): Projection {
  const axes = poseAxes(from, up);
  const focalPoint = pointAt({ eye: from.position, axes, eta: 1, width: 0, height: 0 }, { x: 0, y: 0 }, 1);
  return projectionOf({ position: from.position, focalPoint, viewUp: axes.up, viewAngle: from.viewAngle }, skyOf(up), 800, 600);
}

describe('a pose', () => {
  it.each(ups)('has orthonormal axes with a level horizon (%s up)', (up) => {
    const { right, up: above, forward } = poseAxes(pose, up);
    for (const [a, b] of [[right, above], [above, forward], [forward, right]] as const) {
      expect(dot(a, b)).toBeCloseTo(0, 12);
    }
    expect(Math.abs(dot(right, skyOf(up)))).toBe(0); // exactly, of either sign
    expect(dot(above, skyOf(up))).toBeGreaterThan(0);
  });

  it.each(ups)('comes back from its camera (%s up)', (up) => {
    const back = poseOf(cameraOf(pose, up, false), up);
    expectNear(back.position, pose.position, 1e-4);
    expect(back.yaw).toBeCloseTo(pose.yaw, 5);
    expect(back.pitch).toBeCloseTo(pose.pitch, 5);
    expect(back.distance).toBeCloseTo(pose.distance, 4);
  });

  it.each(ups)('keeps its heading when it looks straight down (%s up)', (up) => {
    const down = { ...pose, pitch: -Math.PI / 2, yaw: 2.1 };
    const camera = cameraOf(down, up, false);
    expect(camera.viewUp).toBeDefined();
    expect(poseOf(camera, up).yaw).toBeCloseTo(2.1, 5);
  });

  it.each(ups)('states its vertical axis where the server assumes another one (%s up)', (up) => {
    expect(cameraOf(pose, up, false).viewUp).toBeUndefined();
    const { viewUp } = cameraOf(pose, up, true);
    expect(dot(viewUp!, skyOf(up))).toBeGreaterThan(0);
    expect(dot(viewUp!, skyOf(flipped(up)))).toBeLessThan(0);
    expect(flipped(flipped(up))).toBe(up);
  });

  it.each(ups)('asks with the very camera that it was made from until it moves (%s up)', (up) => {
    for (let i = 0; i < 500; ++i) {
      const pitch = Math.sin(i) * 1.57;
      const far = 10 ** (3 * Math.sin(i * 2.3));
      const there = vector(4_500_000 + i * 1.37, 300_000 - i, 17.123456789 * i);
      const camera = cameraOf({ ...pose, position: there, yaw: i * 0.7, pitch, distance: far }, up, false);
      const made = poseOf(camera, up);
      expect(cameraOf(made, up, false)).toBe(camera);
      const moved = cameraOf({ ...made, position: vector(0, 0, 0) }, up, false);
      expect(moved.position).toEqual(vector(0, 0, 0));
    }
  });
});

describe('orbiting', () => {
  it.each(ups)('keeps the pivot where it is on the screen (%s up)', (up) => {
    const pivot = pointAt(seen(pose, up), { x: 500, y: 250 }, 12);
    const turned = orbit(pose, up, pivot, 0.7, -0.4);
    expectPixel(project(seen(turned, up), pivot), project(seen(pose, up), pivot)!);
    expect(distance(turned.position, pivot)).toBeCloseTo(distance(pose.position, pivot), 9);
  });

  it('stops at the vertical', () => {
    expect(orbit(pose, 'z', vector(0, 0, 0), 0, -9).pitch).toBe(-Math.PI / 2);
  });
});

describe('panning', () => {
  it('lets a point follow the hand', () => {
    const point = pointAt(seen(pose, 'z'), { x: 300, y: 200 }, 31);
    const moved = pan(pose, 'z', { x: 57, y: -23 }, 31, 600);
    expectPixel(project(seen(moved, 'z'), point), { x: 357, y: 177 });
  });
});

describe('zooming', () => {
  it('keeps the point under the cursor under it', () => {
    const point = pointAt(seen(pose, 'z'), { x: 620, y: 110 }, 42);
    const nearer = zoom(pose, point, 0.25, 1e-3, 1e6);
    expectPixel(project(seen(nearer, 'z'), point), { x: 620, y: 110 });
    expect(distance(nearer.position, point)).toBeCloseTo(distance(pose.position, point) / 4, 9);
  });

  it('goes no nearer and no farther than it may', () => {
    expect(zoom(pose, vector(0, 0, 0), 1e-9, 2, 100).distance).toBe(2);
    expect(zoom(pose, vector(0, 0, 0), 1e9, 2, 100).distance).toBe(100);
  });
});

describe('travelling', () => {
  const to: Pose = { position: vector(-4, 2, 60), yaw: 6.2, pitch: 0.9, distance: 3, viewAngle: 30 };

  it('begins and ends where it should', () => {
    expectNear(between(pose, to, 'z', 0).position, pose.position);
    expectNear(between(pose, to, 'z', 1).position, to.position);
  });

  it('turns the shorter way', () => {
    expect(turnBetween(0.1, 6.2)).toBeCloseTo(6.1 - 2 * Math.PI, 12);
    expect(turnBetween(-3, 3)).toBeCloseTo(6 - 2 * Math.PI, 12);
  });

  it('flies no faster along a diagonal', () => {
    const gone = fly(pose, 'z', { right: 1, forward: 1, up: 1 }, 10);
    expect(distance(gone.position, pose.position)).toBeLessThanOrEqual(10 + 1e-9);
  });
});

describe('a view of a box', () => {
  const box = { min: vector(-3, 2, 100), max: vector(50, 8, 130) };

  it.each(viewNames)('shows all of it from %s, and fills the picture', (name) => {
    for (const up of ups) {
      for (const aspect of [800 / 600]) {
        const pixels = corners(box).map((corner) => project(seen(standardView(name, pose, up, box, aspect), up), corner)!);
        const margin = (p: { x: number; y: number }): number => Math.min(p.x, 800 - p.x, p.y, 600 - p.y);
        const smallest = Math.min(...pixels.map(margin));
        expect(smallest).toBeGreaterThan(0);
        expect(smallest).toBeLessThan(30);
      }
    }
  });

  it('is found by the direction in which it looks', () => {
    expect(viewAlong(vector(0, 0, -1), 'z')).toBe('top');
    expect(viewAlong(vector(0, -1, 0), 'y')).toBe('top');
    expect(viewAlong(vector(0, 1, 0), 'z')).toBe('front');
    expect(viewAlong(vector(0, 0, -1), 'y')).toBe('front');
    expect(viewAlong(vector(-1, 0, 0), 'z')).toBe('right');
  });

  it('is not lost where the box is a point', () => {
    const point = { min: vector(1, 1, 1), max: vector(1, 1, 1) };
    expect(fit(pose, 'z', point, 1).position).toEqual(vector(1, 1, 1));
  });
});

describe('a line that passes the eye', () => {
  const view = seen({ ...pose, position: vector(0, 0, 0), yaw: 0, pitch: 0 }, 'z');
  const behind: Vector = vector(1, -5, 0);

  it('is drawn up to the eye', () => {
    const [from, to] = projectLine(view, vector(1, 10, 0), behind)!;
    expectPixel(from, project(view, vector(1, 10, 0))!);
    expect(to.x).toBeGreaterThan(1000);
  });

  it('is not drawn where it is behind it', () => {
    expect(project(view, behind)).toBeUndefined();
    expect(projectLine(view, behind, vector(0, -1, 0))).toBeUndefined();
  });
});
