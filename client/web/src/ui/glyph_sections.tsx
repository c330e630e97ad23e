import type { JSX } from 'preact';
import type { DisplayOptions } from '../state/display_options';
import {
  anglesOf,
  directionAt,
  firstLight,
  maxLights,
  maxSharpness,
  maxThresholds,
  type GlyphOptions,
  type GlyphRadiusName,
  type GlyphShapeName,
  type Light,
  type Lighting,
  type Threshold,
} from '../state/glyph_options';
import { attributeNames, attributeRange, usualScale } from '../state/ellipsoids';
import { display, ellipsoids, hasSurfels } from '../state/store';
import { decimalsFor, openVolume } from '../state/volume';
import { Choices, IconButton, NumberField, optionsOf, Section, Select, Slider } from './controls';
import { Opacity } from './opacity_section';
import { SliceSection } from './surface_sections';

const change = (part: Partial<DisplayOptions>): void => void (display.value = { ...display.peek(), ...part });
const set = (part: Partial<GlyphOptions>): void => change({ glyphs: { ...display.peek().glyphs, ...part } });

const replaced = <Item,>(items: readonly Item[], at: number, part: Partial<Item>): Item[] =>
  items.map((item, i) => (i === at ? { ...item, ...part } : item));
const without = <Item,>(items: readonly Item[], at: number): Item[] => items.filter((_, i) => i !== at);

const shapeLabels: Readonly<Record<GlyphShapeName, string>> = {
  ellipsoid: 'Ellipsoid',
  superquadric: 'Superquadric',
};
const radiusLabels: Readonly<Record<GlyphRadiusName, string>> = {
  eigenvalue: 'Value',
  root: 'Root',
  unit: 'All as long',
};

const octaves = 5; // of the size, down and up

/** The size of glyphs, relative to the one they have by default. */
function Size(): JSX.Element | null {
  const { radius, scale } = display.value.glyphs;
  const usual = usualScale(ellipsoids.value, radius);
  if (usual === undefined) return null;
  const factor = (scale ?? usual) / usual;
  const decimals = Math.max(0, 3 - Math.floor(Math.log10(usual)));
  return (
    <>
      <Slider
        label="Size"
        {...{ value: Math.log2(factor), min: -octaves, max: octaves, step: 0.05 }}
        shown={`${Number(factor.toPrecision(3))} ×`}
        onInput={(power) => set({ scale: power === 0 ? undefined : Number((usual * 2 ** power).toPrecision(6)) })}
      />
      <NumberField
        label="Semi-axis of 1"
        value={scale ?? usual}
        {...{ decimals }}
        onChange={(value) => value > 0 && set({ scale: value })}
      />
    </>
  );
}

function ThresholdFields({ threshold, at }: { threshold: Threshold; at: number }): JSX.Element {
  const { thresholds } = display.value.glyphs;
  const { attribute, smallest, largest } = threshold;
  const [low, high] = attributeRange(ellipsoids.value, attribute);
  const decimals = decimalsFor(high - low);
  const put = (part: Partial<Threshold>): void => {
    const changed = { ...threshold, ...part };
    if (changed.largest !== undefined && changed.smallest > changed.largest) return;
    set({ thresholds: replaced(thresholds, at, part) });
  };
  const number = thresholds.length > 1 ? ` ${at + 1}` : '';
  const choose = (name: string): void => set({ thresholds: replaced(thresholds, at, newThreshold(name)) });
  return (
    <li class="surface">
      <Select
        label={`Attribute of threshold${number}`}
        value={attribute}
        options={attributeNames(ellipsoids.value)}
        onChange={choose}
      />
      <Slider
        label={`${attribute} at least`}
        {...{ value: smallest, min: low, max: high, step: (high - low) / 1000 || 1 }}
        shown={smallest.toFixed(decimals)}
        onInput={(value) => put({ smallest: Math.min(Number(value.toFixed(decimals)), largest ?? Infinity) })}
      />
      <div class="range-fields">
        <NumberField label="From" value={smallest} {...{ decimals }} onChange={(value) => put({ smallest: value })} />
        <NumberField
          label="To"
          value={largest ?? high}
          {...{ decimals }}
          onChange={(value) => put({ largest: value })}
        />
        <IconButton
          icon="trash"
          label={`Remove threshold${number}`}
          onPress={() => set({ thresholds: without(thresholds, at) })}
        />
      </div>
    </li>
  );
}

/** Of the anisotropy that radiology takes, or the middle of what there is. */
function newThreshold(attribute: string): Threshold {
  const [low, high] = attributeRange(ellipsoids.peek(), attribute);
  const middle = Number(((low + high) / 2).toFixed(decimalsFor(high - low)));
  return { attribute, smallest: attribute === 'fa' ? 0.2 : middle, largest: undefined };
}

function Thresholds(): JSX.Element {
  const { thresholds } = display.value.glyphs;
  const add = (
    <button
      type="button"
      class="quiet"
      disabled={thresholds.length >= maxThresholds}
      onClick={() => set({ thresholds: [...thresholds, newThreshold('fa')] })}
    >
      Add threshold
    </button>
  );
  return (
    <Section title="Thresholds" aside={add}>
      {thresholds.length > 0 && (
        <ul class="surfaces">
          {thresholds.map((threshold, at) => (
            <ThresholdFields key={at} {...{ threshold, at }} />
          ))}
        </ul>
      )}
    </Section>
  );
}

function LightFields({ lighting, light, at }: { lighting: Lighting; light: Light; at: number }): JSX.Element {
  const { right, above } = anglesOf(light.direction);
  const put = (part: Partial<Light>): void =>
    change({ lighting: { ...lighting, lights: replaced(lighting.lights, at, part) } });
  const left = without(lighting.lights, at);
  const number = lighting.lights.length > 1 ? ` ${at + 1}` : '';
  return (
    <li class="surface">
      <Slider
        label={`Light${number} from the right`}
        {...{ value: right, min: -180, max: 180, step: 1 }}
        shown={`${right}°`}
        onInput={(angle) => put({ direction: directionAt(angle, above) })}
      />
      <Slider
        label={`Light${number} from above`}
        {...{ value: above, min: -89, max: 89, step: 1 }}
        shown={`${above}°`}
        onInput={(angle) => put({ direction: directionAt(right, angle) })}
      />
      <Slider
        label={`Power of light${number}`}
        {...{ value: light.power, min: 0, max: 2, step: 0.01 }}
        shown={light.power.toFixed(2)}
        onInput={(power) => put({ power })}
      />
      <button
        type="button"
        class="quiet"
        onClick={() => change({ lighting: left.length > 0 ? { ...lighting, lights: left } : undefined })}
      >
        Remove light{number}
      </button>
    </li>
  );
}

/** Directions from which lights are added, degrees to the right and above. */
const nextLights = [
  [-50, 20],
  [0, -40],
  [120, 30],
] as const;

/** Without a light there is a headlight. */
function Lights(): JSX.Element {
  const { lighting } = display.value;
  const put = (part: Partial<Lighting>): void => change({ lighting: { ...(lighting ?? firstLight), ...part } });
  const more = (): void => {
    if (!lighting) return change({ lighting: firstLight });
    const [right, above] = nextLights[(lighting.lights.length - 1) % nextLights.length]!;
    put({ lights: [...lighting.lights, { direction: directionAt(right, above), power: 0.4 }] });
  };
  const add = (
    <button type="button" class="quiet" disabled={(lighting?.lights.length ?? 0) >= maxLights} onClick={more}>
      Add light
    </button>
  );
  return (
    <Section title="Light" aside={add}>
      {lighting && (
        <>
          <ul class="surfaces">
            {lighting.lights.map((light, at) => (
              <LightFields key={at} {...{ lighting, light, at }} />
            ))}
          </ul>
          <Slider
            label="Ambient light"
            {...{ value: lighting.ambient, min: 0, max: 1, step: 0.01 }}
            shown={lighting.ambient.toFixed(2)}
            onInput={(ambient) => put({ ambient })}
          />
          <Slider
            label="Highlights"
            {...{ value: lighting.specular, min: 0, max: 1, step: 0.01 }}
            shown={lighting.specular.toFixed(2)}
            onInput={(specular) => put({ specular })}
          />
          <Slider
            label="Sharpness of highlights"
            {...{ value: lighting.exponent, min: 1, max: 128, step: 1 }}
            onInput={(exponent) => put({ exponent })}
          />
        </>
      )}
    </Section>
  );
}

export function GlyphSections(): JSX.Element | null {
  const sources = ellipsoids.value;
  if (sources.length === 0) return null;
  const { shape, sharpness, radius } = display.value.glyphs;
  const grid = sources.find(({ size }) => size.length > 0);
  return (
    <>
      <Section title="Ellipsoids">
        <Choices
          label="Glyph"
          value={shape}
          options={optionsOf(shapeLabels)}
          onChange={(value) => set({ shape: value })}
        />
        {shape === 'superquadric' && (
          <Slider
            label="Sharpness"
            {...{ value: sharpness, min: 0, max: maxSharpness, step: 0.1 }}
            onInput={(value) => set({ sharpness: value })}
          />
        )}
        <Choices
          label="Semi-axes by"
          value={radius}
          options={optionsOf(radiusLabels)}
          onChange={(value) => set({ radius: value, scale: undefined })}
        />
        <Size />
        {!openVolume() && !hasSurfels() && <Opacity />}
      </Section>
      <Thresholds />
      {grid && !openVolume() && <SliceSection size={grid.size} medium={false} />}
      <Lights />
    </>
  );
}
