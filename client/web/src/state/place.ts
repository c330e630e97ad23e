import type { Camera } from '../camera/pose';
import { vector, type Vector } from '../camera/vector';
import { choices, plainIn, plainParameters } from '../generated/plain_options';
import { colorSources, defaultDisplay, type ClassOpacity, type Clip, type DisplayOptions } from './display_options';
import { glyphParameters, parseGlyphs, parseLights } from './glyph_options';
import { choiceIn, numberIn } from './plain_values';
import { formatSlices, formatSurfaces, parseSlices, parseSurfaces } from '../volume/surfaces';
import { formatTransfer, parseTransfer } from '../volume/transfer';

/** The contents of a link: model, camera and display options. Parameters are those of `GET /api/models/..`. */
export interface Place {
  readonly model: string | undefined;
  readonly camera: Camera | undefined;
  readonly display: DisplayOptions;
}

const numbersIn = (text: string | null, count: number): number[] | undefined => {
  const numbers = text?.split(',').map((part) => (part.trim() === '' ? Number.NaN : Number(part)));
  return numbers?.length === count && numbers.every(Number.isFinite) ? numbers : undefined;
};

function vectorIn(text: string | null): Vector | undefined {
  const parts = numbersIn(text, 3);
  return parts && vector(parts[0]!, parts[1]!, parts[2]!);
}

function cameraIn(values: URLSearchParams): Camera | undefined {
  const position = vectorIn(values.get('position'));
  const focalPoint = vectorIn(values.get('focal_point'));
  if (!position || !focalPoint) return undefined;
  const angle = numbersIn(values.get('view_angle'), 1)?.[0] ?? 30;
  const viewAngle = angle > 0 && angle < 180 ? angle : 30;
  return { position, focalPoint, viewAngle, viewUp: vectorIn(values.get('view_up')) };
}

function clipsIn(text: string | null, inverted: boolean): Clip[] {
  const boxes = (text ?? '').split(';').map((part) => numbersIn(part, 6));
  return boxes.flatMap((b) => {
    if (!b) return [];
    const box = { min: vector(b[0]!, b[1]!, b[2]!), max: vector(b[3]!, b[4]!, b[5]!) };
    return [{ box, inverted }];
  });
}

function eyeDomeIn(text: string | null): DisplayOptions['eyeDome'] {
  const both = numbersIn(text, 2) ?? numbersIn(text, 1);
  const [strength = 0, radius = defaultDisplay.eyeDome.radius] = both ?? [];
  return strength >= 0 && radius > 0 ? { strength, radius } : defaultDisplay.eyeDome;
}

function classesIn(text: string | null): number[] {
  const codes = (text ?? '').split(',').filter((part) => /^\d+$/.test(part));
  return codes.map(Number).filter((code) => code < 65536);
}

function classOpacitiesIn(text: string | null): ClassOpacity[] {
  return (text ?? '').split(',').flatMap((part) => {
    const [, code, share = null] = /^(\d+)=(.+)$/.exec(part) ?? [];
    const opacity = numberIn(share, 0, 1, false);
    return Number(code) < 256 && opacity !== undefined ? [{ code: Number(code), opacity }] : [];
  });
}

const byName = 'attribute:';
const derivedAttributes: readonly string[] = ['fa', 'mode', 'md']; // of ellipsoids

/** What colours the model, and by which attribute. */
function sourceIn(text: string | null): Pick<DisplayOptions, 'source' | 'attribute'> {
  const { source, attribute } = defaultDisplay;
  if (text?.startsWith(byName) && text.length > byName.length) {
    return { source: 'attribute', attribute: text.slice(byName.length) };
  }
  if (text && derivedAttributes.includes(text)) return { source: 'attribute', attribute: text };
  return { source: colorSources.find((name) => name === text && name !== 'attribute') ?? source, attribute };
}

function sourceText({ source, attribute }: DisplayOptions): string | undefined {
  if (source === defaultDisplay.source) return undefined;
  if (source !== 'attribute') return source;
  return derivedAttributes.includes(attribute) ? attribute : byName + encodeURIComponent(attribute);
}

function displayIn(values: URLSearchParams): DisplayOptions {
  const range = numbersIn(values.get('color_range'), 2);
  return {
    ...plainIn(values),
    ...sourceIn(values.get('color_by')),
    map: choiceIn(choices.colorMap, values.get('color_map')) ?? defaultDisplay.map,
    range: range && range[0]! < range[1]! ? [range[0]!, range[1]!] : undefined,
    hiddenClasses: classesIn(values.get('hide_classes')),
    hiddenModels: (values.get('hide_models') ?? '').split(',').filter((name) => name !== ''),
    clips: [...clipsIn(values.get('clip_box'), false), ...clipsIn(values.get('clip_out'), true)],
    eyeDome: eyeDomeIn(values.get('eye_dome')),
    transfer: parseTransfer(values.get('transfer')),
    surfaces: parseSurfaces(values.get('iso')),
    slices: parseSlices(values.get('slice')),
    classOpacities: classOpacitiesIn(values.get('opacity_by_class')),
    upsideDown: values.get('upside_down') === 'on',
    glyphs: parseGlyphs(values),
    lighting: parseLights(values.get('lights')),
  };
}

/** Parses a location's hash. A parameter that is missing or invalid has its default value. */
export function parsePlace(hash: string): Place {
  const [path = '', query = ''] = hash.replace(/^#?\/?/, '').split('?', 2);
  const values = new URLSearchParams(query);
  return { model: decoded(path), camera: cameraIn(values), display: displayIn(values) };
}

function decoded(path: string): string | undefined {
  try {
    return path === '' ? undefined : decodeURIComponent(path);
  } catch {
    return path;
  }
}

const list = (v: Vector): string => `${v.x},${v.y},${v.z}`;

const clipList = (clips: readonly Clip[], inverted: boolean): string | undefined => {
  const boxes = clips.filter((clip) => clip.inverted === inverted).map(({ box }) => `${list(box.min)},${list(box.max)}`);
  return boxes.length > 0 ? boxes.join(';') : undefined;
};

const classList = (classes: readonly ClassOpacity[]): string | undefined =>
  classes.length > 0 ? classes.map(({ code, opacity }) => `${code}=${opacity}`).join(',') : undefined;

/** Only the parameters that differ from their defaults. */
function displayParameters(display: DisplayOptions): Record<string, string | undefined> {
  const { eyeDome } = display;
  return {
    ...plainParameters(display),
    color_by: sourceText(display),
    color_map: display.map === defaultDisplay.map ? undefined : display.map,
    color_range: display.range?.join(','),
    hide_classes: display.hiddenClasses.length > 0 ? display.hiddenClasses.join(',') : undefined,
    hide_models: display.hiddenModels.length > 0 ? display.hiddenModels.map(encodeURIComponent).join(',') : undefined,
    clip_box: clipList(display.clips, false),
    clip_out: clipList(display.clips, true),
    eye_dome: eyeDome.strength > 0 ? `${eyeDome.strength},${eyeDome.radius}` : undefined,
    transfer: formatTransfer(display.transfer),
    iso: formatSurfaces(display.surfaces),
    slice: formatSlices(display.slices),
    opacity_by_class: classList(display.classOpacities),
    upside_down: display.upsideDown ? 'on' : undefined,
    ...glyphParameters(display.glyphs, display.lighting),
  };
}

/** The hash of a place; `parsePlace` restores the place from it. */
export function formatPlace(place: Place): string {
  if (place.model === undefined) return '#/';
  const { camera } = place;
  const values: Record<string, string | undefined> = {
    position: camera && list(camera.position),
    focal_point: camera && list(camera.focalPoint),
    view_up: camera?.viewUp && list(camera.viewUp),
    view_angle: camera && camera.viewAngle !== 30 ? String(camera.viewAngle) : undefined,
    ...displayParameters(place.display),
  };
  const said = Object.entries(values).flatMap(([name, value]) => (value === undefined ? [] : [`${name}=${value}`]));
  const path = `#/${encodeURIComponent(place.model).replaceAll('%2B', '+')}`;
  return said.length > 0 ? `${path}?${said.join('&')}` : path;
}
