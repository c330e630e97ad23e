import { describe, expect, it } from 'vitest';
import { vector } from '../src/camera/vector';
import { defaultDisplay, type DisplayOptions } from '../src/state/display_options';
import { formatPlace, parsePlace } from '../src/state/place';

const camera = {
  position: vector(4_500_123.25, -300_000.5, 17),
  focalPoint: vector(1e-7, 2, 3),
  viewUp: vector(0, 1, 0),
  viewAngle: 45,
};

const display: DisplayOptions = {
  source: 'intensity',
  map: 'turbo',
  range: [-5.5, 1200],
  hiddenClasses: [7, 18],
  clips: [
    { box: { min: vector(0, 1, 2), max: vector(3, 4, 5.5) }, inverted: false },
    { box: { min: vector(-1, -1, -1), max: vector(1, 1, 1) }, inverted: true },
  ],
  eyeDome: { strength: 0.75, radius: 2 },
  background: { red: 255, green: 0, blue: 9 },
  spacing: 0,
  transfer: {
    preset: 'gray',
    range: undefined,
    points: [
      { value: -1000, color: { red: 0, green: 0, blue: 0 }, opacity: 0 },
      { value: 400.5, color: { red: 255, green: 240, blue: 9 }, opacity: 0.25 },
    ],
  },
  shaded: true,
  splatConvention: 'exact',
};

describe('a link', () => {
  it('is read back as it was written', () => {
    const place = { model: 'Müller & Söhne/100% ?', camera, display };
    expect(parsePlace(formatPlace(place))).toEqual(place);
  });

  it('says nothing that is as usual', () => {
    expect(formatPlace({ model: 'lion', camera: undefined, display: defaultDisplay })).toBe('#/lion');
    expect(formatPlace({ model: undefined, camera: undefined, display: defaultDisplay })).toBe('#/');
  });

  it.each([
    '#/lion?position=1,2&focal_point=3,4,5',
    '#/lion?position=1,2,&focal_point=3,4,5',
    '#/lion?position=1,2,Infinity&focal_point=3,4,5',
    '#/lion?color_by=smell&color_map=&color_range=1&hide_classes=x,-1,70000&clip_box=1,2,3&eye_dome=-1&background=1,2,256',
    '#/lion?spacing=-3&eye_dome=1,0',
    '#/lion?transfer=bone&shaded=yes&splat_convention=inria',
    '#/lion?&&=&',
  ])('with nonsense shows the model as usual: %s', (hash) => {
    expect(parsePlace(hash)).toEqual({ model: 'lion', camera: undefined, display: defaultDisplay });
  });

  it('with an impossible view angle takes the usual one', () => {
    const { camera: parsed } = parsePlace('#/a?position=1,2,3&focal_point=0,0,0&view_angle=180');
    expect(parsed?.viewAngle).toBe(30);
  });

  it('that cannot be decoded names no other model', () => {
    expect(parsePlace('#/%E0%A4%A').model).toBe('%E0%A4%A');
  });
});
