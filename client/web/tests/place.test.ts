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
  ...defaultDisplay,
  source: 'attribute',
  attribute: 'mean, of 2 & 3 #',
  map: 'turbo',
  range: [-5.5, 1200],
  hiddenClasses: [7, 18],
  hiddenModels: ['tower 2', 'crypt & nave'],
  clips: [
    { box: { min: vector(0, 1, 2), max: vector(3, 4, 5.5) }, inverted: false },
    { box: { min: vector(-1, -1, -1), max: vector(1, 1, 1) }, inverted: true },
  ],
  eyeDome: { strength: 0.75, radius: 2 },
  background: { red: 255, green: 0, blue: 9 },
  spacing: 0,
  transfer: {
    preset: 'auto',
    range: undefined,
    points: [
      { value: -1000, color: { red: 0, green: 0, blue: 0 }, opacity: 0 },
      { value: 400.5, color: { red: 255, green: 240, blue: 9 }, opacity: 0.25 },
    ],
  },
  shaded: true,
  surfaces: [
    { value: -500.5, color: undefined, opacity: 1 },
    { value: 300, color: { red: 230, green: 220, blue: 9 }, opacity: 0.5 },
  ],
  slices: [
    { axis: 'k', index: 40.5 },
    { axis: undefined, point: vector(1, 2, 3), normal: vector(0, 0, -1) },
  ],
  medium: false,
  opacity: 0.25,
  classOpacities: [
    { code: 5, opacity: 0.3 },
    { code: 6, opacity: 0 },
  ],
  ghost: 0.1,
  xray: 'sorted',
  shading: 'lit',
  upsideDown: true,
  splatConvention: 'exact',
  glyphs: {
    shape: 'superquadric',
    sharpness: 2.5,
    radius: 'root',
    scale: 0.125,
    thresholds: [
      { attribute: 'fa', smallest: 0.2, largest: undefined },
      { attribute: 'a,b', smallest: -1, largest: 3.5 },
    ],
  },
  lighting: {
    ambient: 0.08,
    specular: 0.25,
    exponent: 32,
    lights: [
      { direction: vector(0.5, 0.7, -0.6), power: 0.75 },
      { direction: vector(-1, 0, 0), power: 0 },
    ],
  },
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
    '#/lion?iso=1,2&slice=x,3&medium=yes&opacity=2',
    '#/lion?iso=5;1,2,3,256&slice=k,1;1,2,3,0,0,0&opacity=-1',
    '#/lion?opacity_by_class=5,6=2,256=0.5,a=1&ghost=2&xray=yes&shading=bright',
    '#/lion?glyph=cube,3&glyph_radius=2&glyph_scale=-1&threshold=fa,2,1&lights=1,1,1',
    '#/lion?glyph_scale=Infinity&threshold=fa;mode,1&lights=1,1;0,0,1,1&color_by=attribute:',
    '#/lion?glyph=superq&threshold=,1&lights=1,1,1;0,0,0,1&color_by=attribute',
    '#/lion?&&=&',
  ])('with nonsense shows the model as usual: %s', (hash) => {
    expect(parsePlace(hash)).toEqual({ model: 'lion', camera: undefined, display: defaultDisplay });
  });

  it('has the names of the command line for what ellipsoids are coloured by', () => {
    const of = (part: Partial<DisplayOptions>): string =>
      formatPlace({ model: 'a', camera: undefined, display: { ...defaultDisplay, ...part } });
    expect(of({ source: 'direction' })).toBe('#/a?color_by=direction');
    expect(of({ source: 'attribute', attribute: 'fa' })).toBe('#/a?color_by=fa');
    expect(of({ source: 'attribute', attribute: 'trace' })).toBe('#/a?color_by=attribute:trace');
    expect(parsePlace('#/a?color_by=mode').display).toMatchObject({ source: 'attribute', attribute: 'mode' });
  });

  it('with an impossible view angle takes the usual one', () => {
    const { camera: parsed } = parsePlace('#/a?position=1,2,3&focal_point=0,0,0&view_angle=180');
    expect(parsed?.viewAngle).toBe(30);
  });

  it('that cannot be decoded names no other model', () => {
    expect(parsePlace('#/%E0%A4%A').model).toBe('%E0%A4%A');
  });
});
