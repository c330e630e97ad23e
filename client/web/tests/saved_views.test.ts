import { describe, expect, it } from 'vitest';
import { vector } from '../src/camera/vector';
import { defaultDisplay } from '../src/state/display_options';
import { formatPlace, parsePlace, type Place } from '../src/state/place';
import {
  filmCommand,
  formatViews,
  parseViews,
  usualName,
  viewsFile,
  withViews,
  type SavedView,
} from '../src/state/saved_views';

const place: Place = {
  model: 'église 2',
  camera: {
    position: vector(452_000.125, 5e6, 1e-7),
    focalPoint: vector(1, 2, 3),
    viewAngle: 45,
    viewUp: vector(0, 1, 0),
  },
  display: {
    ...defaultDisplay,
    source: 'attribute',
    attribute: 'mean, of 2 & 3 #%',
    hiddenClasses: [7],
    clips: [{ box: { min: vector(0, 1, 2), max: vector(3, 4, 5) }, inverted: true }],
    glyphs: { ...defaultDisplay.glyphs, thresholds: [{ attribute: 'a,b&c', smallest: -1, largest: 3.5 }] },
  },
};
const views: readonly SavedView[] = [
  { name: 'Gate', link: formatPlace(place) },
  { name: 'Überblick "oben"', link: formatPlace({ ...place, display: defaultDisplay }) },
];

describe('a file of views', () => {
  it('brings back every view to the letter', () => {
    const text = formatViews({ model: 'église 2', views });
    const read = parseViews(text, 'église 2');
    expect(read).toEqual({ of: 'église 2', views });
    expect(parsePlace(read.views[0]!.link)).toEqual(place);
  });

  it('states the parameters of the server', () => {
    const file = JSON.parse(formatViews({ model: 'm', views })) as { views: { parameters: Record<string, string> }[] };
    expect(file.views[0]!.parameters).toMatchObject({
      position: '452000.125,5000000,1e-7',
      view_angle: '45',
      clip_out: '0,1,2,3,4,5',
      hide_classes: '7',
    });
  });

  it('can be of another model', () => {
    const { of, views: read } = parseViews(formatViews({ model: 'église 2', views }), 'nave');
    expect(of).toBe('église 2');
    expect(parsePlace(read[0]!.link)).toEqual({ ...place, model: 'nave' });
  });

  const file = (change: object): string =>
    JSON.stringify({ format: 'surfcast-views', version: 1, model: 'm', views: [], ...change });
  const parameters = { position: '1,2,3', focal_point: '4,5,6' };
  it.each([
    ['no JSON', '{', 'not JSON'],
    ['another JSON', '[1]', 'no views'],
    ['no list', file({ views: {} }), 'no views'],
    ['a later version', file({ version: 2 }), 'another version'],
    ['a view without a camera', file({ views: [{ name: 'a', parameters }, { name: 'b', parameters: {} }] }), 'View 2'],
    ['a view without a name', file({ views: [{ name: ' ', parameters }] }), 'View 1'],
    ['a view that is none', file({ views: [null] }), 'View 1'],
    ['too many', file({ views: Array.from({ length: 501 }, () => ({ name: 'a', parameters })) }), 'more than 500'],
  ])('is refused: %s', (_, text, message) => {
    expect(() => parseViews(text, 'm')).toThrow(message);
  });

  it('leaves out what is no parameter, and cuts long names', () => {
    const entry = { name: 'x'.repeat(200), parameters: { ...parameters, nothing: '1', view_angle: 60 } };
    const { views: read } = parseViews(file({ views: [entry] }), 'm');
    expect(read).toEqual([{ name: 'x'.repeat(80), link: '#/m?position=1,2,3&focal_point=4,5,6' }]);
  });
});

describe('the list of views', () => {
  const other = { name: 'Gate', link: '#/m?position=1,2,3&focal_point=4,5,6' };

  it('takes a view once, and another of the same name under a new one', () => {
    expect(withViews(views, views)).toEqual(views);
    const more = withViews(views, [other, { ...other, link: '#/m?position=0,2,3&focal_point=4,5,6' }]);
    expect(more.map(({ name }) => name)).toEqual(['Gate', 'Überblick "oben"', 'Gate 2', 'Gate 3']);
  });

  it('has a name for a view without one', () => {
    expect(usualName([])).toBe('View 1');
    expect(usualName([{ name: 'View 2', link: '' }])).toBe('View 3');
  });
});

describe('the command for a film', () => {
  it('draws on the server of the page', () => {
    expect(filmCommand({ protocol: 'http:', host: 'box:7600' }, 'church', viewsFile('church'))).toBe(
      "surfcast render 'box:7600/church' --path 'church-views.json' --output 'church.mp4'",
    );
    expect(filmCommand({ protocol: 'https:', host: 'scans.example' }, 'a/b', viewsFile('a/b'))).toBe(
      "surfcast render 'wss://scans.example/a/b' --path 'a-b-views.json' --output 'a-b.mp4'",
    );
  });

  it('quotes names for a shell', () => {
    expect(filmCommand({ protocol: 'http:', host: 'box' }, "Peter's $(house)", 'v.json')).toContain(
      "'box/Peter'\\''s $(house)'",
    );
  });
});
