import type { JSX } from 'preact';
import { choices, defaultPlain, type Choice } from '../generated/plain_options';
import { formatNumber } from '../measure/format';
import { colorSources, type ColorSourceName, type DisplayOptions } from '../state/display_options';
import { classColor, className, gradientOf } from '../state/palette';
import { attributeNames, attributeRange } from '../state/ellipsoids';
import { fromHex, toHex, type Rgb } from '../state/rgb';
import { description, display, ellipsoids, hasSurfels } from '../state/store';
import { Choices, NumberField, optionsOf, Section, Select, Slider } from './controls';
import { GlyphSections } from './glyph_sections';
import { OpacitySections } from './opacity_section';
import { GaussianSection, VolumeSections } from './volume_sections';

const change = (part: Partial<DisplayOptions>): void => void (display.value = { ...display.peek(), ...part });

const sourceLabels: Readonly<Record<ColorSourceName, string>> = {
  rgb: 'Scan',
  intensity: 'Intensity',
  elevation: 'Elevation',
  classification: 'Class',
  normal: 'Normal',
  direction: 'Direction',
  dec: 'Direction by FA',
  attribute: 'Attribute',
};

const labelOf = (source: ColorSourceName): string =>
  source === 'rgb' && !hasSurfels() ? 'Own' : sourceLabels[source];

const has = (attribute: string): boolean => description.value?.attributes.includes(attribute) ?? false;

const available = (source: ColorSourceName): boolean =>
  source === 'intensity' || source === 'classification' ? has(source) : true;

const ofSurfels: readonly ColorSourceName[] = ['intensity', 'classification', 'normal'];
const ofEllipsoids: readonly ColorSourceName[] = ['direction', 'dec', 'attribute'];

/** What the items of the open model can be coloured by. */
const offered = (): readonly ColorSourceName[] =>
  colorSources.filter(
    (source) =>
      (hasSurfels() || !ofSurfels.includes(source)) && (ellipsoids.value.length > 0 || !ofEllipsoids.includes(source)),
  );

/** The range of the colour map when the display options state none. */
function defaultRange(source: ColorSourceName): readonly [number, number] {
  if (source === 'elevation') {
    const range = description.value?.elevation;
    return range ? [range.low, range.high] : [0, 1];
  }
  if (source === 'attribute') return attributeRange(ellipsoids.value, display.value.attribute);
  const range = description.value?.ranges.find((each) => each.attribute === source);
  return range ? [range.low, range.high] : [0, 1];
}

export const mapped = (source: ColorSourceName): boolean =>
  source === 'intensity' || source === 'elevation' || source === 'attribute';

/** What the colours of the map are of. */
export const mappedName = ({ source, attribute }: DisplayOptions): string =>
  source === 'attribute' ? attribute : source;

export const shownRange = (): readonly [number, number] => display.value.range ?? defaultRange(display.value.source);

function RangeFields(): JSX.Element {
  const [first, last] = shownRange();
  const usual = defaultRange(display.value.source);
  const decimals = Math.max(0, 3 - Math.floor(Math.log10(Math.max(1e-9, usual[1] - usual[0]))));
  const set = (a: number, b: number): void => {
    if (a < b) change({ range: [a, b] });
  };
  return (
    <div class="range-fields">
      <NumberField label="From" value={first} {...{ decimals }} onChange={(value) => set(value, last)} />
      <NumberField label="To" value={last} {...{ decimals }} onChange={(value) => set(first, value)} />
      <button type="button" class="quiet" disabled={!display.value.range} onClick={() => change({ range: undefined })}>
        Reset
      </button>
    </div>
  );
}

function Maps(): JSX.Element {
  return (
    <div class="maps" role="radiogroup" aria-label="Colour map">
      {choices.colorMap.map((map) => (
        <label key={map} title={map}>
          <input
            type="radio"
            name="map"
            aria-label={map}
            checked={display.value.map === map}
            onChange={() => change({ map })}
          />
          <span style={{ background: gradientOf(map) }} />
        </label>
      ))}
    </div>
  );
}

function Coloring(): JSX.Element {
  const { source } = display.value;
  return (
    <Section title="Colour">
      <Choices
        label="Colour by"
        value={source}
        options={offered().map((value) => ({ value, label: labelOf(value), disabled: !available(value) }))}
        onChange={(value) => change({ source: value, range: undefined })}
      />
      {source === 'attribute' && (
        <Select
          label="Attribute"
          value={display.value.attribute}
          options={attributeNames(ellipsoids.value)}
          onChange={(attribute) => change({ attribute, range: undefined })}
        />
      )}
      {mapped(source) && (
        <>
          <Maps />
          <RangeFields />
        </>
      )}
    </Section>
  );
}

function Classes(): JSX.Element | null {
  const classes = description.value?.classes ?? [];
  if (classes.length === 0) return null;
  const { hiddenClasses } = display.value;
  const toggle = (code: number, shown: boolean): void =>
    change({ hiddenClasses: shown ? hiddenClasses.filter((c) => c !== code) : [...hiddenClasses, code] });
  const all = (
    <button
      type="button"
      class="quiet"
      onClick={() => change({ hiddenClasses: hiddenClasses.length > 0 ? [] : classes.map((c) => c.code) })}
    >
      {hiddenClasses.length > 0 ? 'Show all' : 'Hide all'}
    </button>
  );
  return (
    <Section title="Classes" aside={all}>
      <ul class="classes">
        {classes.map(({ code, surfels }) => (
          <li key={code}>
            <label>
              <input
                type="checkbox"
                checked={!hiddenClasses.includes(code)}
                style={{ '--swatch': classColor(code) }}
                onChange={(event) => toggle(code, event.currentTarget.checked)}
              />
              <span class="name">
                {className(code)} <small>{code}</small>
              </span>
              <span class="count">{formatNumber(Number(surfels), 0)}</span>
            </label>
          </li>
        ))}
      </ul>
    </Section>
  );
}

function Depth(): JSX.Element {
  const { eyeDome } = display.value;
  const set = (part: Partial<DisplayOptions['eyeDome']>): void => change({ eyeDome: { ...eyeDome, ...part } });
  return (
    <Section title="Eye-dome lighting">
      <Slider
        label="Strength"
        {...{ value: eyeDome.strength, min: 0, max: 3, step: 0.05 }}
        shown={eyeDome.strength > 0 ? eyeDome.strength.toFixed(2) : 'off'}
        onInput={(strength) => set({ strength })}
      />
      {eyeDome.strength > 0 && (
        <Slider
          label="Radius"
          {...{ value: eyeDome.radius, min: 0.5, max: 5, step: 0.1 }}
          shown={`${eyeDome.radius.toFixed(1)} px`}
          onInput={(radius) => set({ radius })}
        />
      )}
    </Section>
  );
}

const shadingLabels: Readonly<Record<Choice<'shading'>, string>> = { auto: 'Auto', unlit: 'Off', lit: 'On' };

/** Scans with colours are not lit unless they are asked to be. */
function SurfaceLighting(): JSX.Element {
  return (
    <Section title="Surface lighting">
      <Choices
        label="Surface lighting"
        value={display.value.shading}
        options={optionsOf(shadingLabels)}
        onChange={(shading) => change({ shading })}
      />
    </Section>
  );
}

const backgrounds: readonly (readonly [string, Rgb])[] = [
  ['Night', defaultPlain.background],
  ['Black', { red: 0, green: 0, blue: 0 }],
  ['Slate', { red: 58, green: 66, blue: 76 }],
  ['Paper', { red: 238, green: 236, blue: 230 }],
  ['White', { red: 255, green: 255, blue: 255 }],
];

function Background(): JSX.Element {
  const now = toHex(display.value.background);
  return (
    <Section title="Background">
      <div class="swatches">
        {backgrounds.map(([name, color]) => (
          <button
            key={name}
            type="button"
            class="swatch"
            title={name}
            aria-label={`${name} background`}
            aria-pressed={toHex(color) === now}
            style={{ background: toHex(color) }}
            onClick={() => change({ background: color })}
          />
        ))}
        <label class="swatch custom" title="Any colour">
          <input
            type="color"
            aria-label="Any background colour"
            value={now}
            onInput={(event) => change({ background: fromHex(event.currentTarget.value) })}
          />
        </label>
      </div>
    </Section>
  );
}

const details = [
  { value: '2', label: 'Light' },
  { value: '1', label: 'Fine' },
  { value: '0', label: 'Every point' },
] as const;

function Detail(): JSX.Element {
  const value = details.find((each) => Number(each.value) === display.value.spacing)?.value ?? '1';
  return (
    <Section title="Detail at rest">
      <Choices
        label="Detail at rest"
        value={value}
        options={details}
        onChange={(chosen) => change({ spacing: Number(chosen) })}
      />
    </Section>
  );
}

export function DisplayPanel(): JSX.Element {
  return (
    <>
      <VolumeSections />
      <GaussianSection />
      <GlyphSections />
      {(hasSurfels() || ellipsoids.value.length > 0) && <Coloring />}
      <Classes />
      {hasSurfels() && <OpacitySections />}
      {hasSurfels() && <SurfaceLighting />}
      <Depth />
      <Background />
      <Detail />
    </>
  );
}
