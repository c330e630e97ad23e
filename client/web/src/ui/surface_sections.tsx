import type { JSX } from 'preact';
import type { VolumeDescription } from '../generated/surfcast_pb';
import { showsMedium, type DisplayOptions } from '../state/display_options';
import { fromHex, toHex } from '../state/rgb';
import { display } from '../state/store';
import { decimalsFor } from '../state/volume';
import {
  gridAxes,
  indexAcross,
  isoGray,
  maxSurfaces,
  withSlice,
  withSurface,
  type GridAxis,
  type IsoSurface,
} from '../volume/surfaces';
import { IconButton, NumberField, Section, Slider, Switch } from './controls';

const change = (part: Partial<DisplayOptions>): void => void (display.value = { ...display.peek(), ...part });

const steps = 1000; // of a slider over all values

/** Iso-surfaces and slices may stand alone, or in what the transfer function shows. */
function MediumSwitch(): JSX.Element {
  return (
    <Switch
      label="Show the volume around"
      checked={showsMedium(display.value)}
      onChange={(on) => change({ medium: on })}
    />
  );
}

/** Without surfaces and slices the volume is all there is, so that nothing is said of it. */
function mediumBeside(surfaces: number, slices: number): Partial<DisplayOptions> {
  return surfaces + slices === 0 ? { medium: undefined } : {};
}

interface SurfaceProps {
  readonly volume: VolumeDescription;
  readonly surface: IsoSurface;
  readonly at: number;
}

function Surface({ volume, surface, at }: SurfaceProps): JSX.Element {
  const { low, high } = volume;
  const decimals = decimalsFor(high - low);
  const { surfaces, slices } = display.value;
  const set = (part: Partial<IsoSurface>): void => change({ surfaces: withSurface(surfaces, at, part) });
  const remove = (): void => {
    const left = surfaces.filter((_, i) => i !== at);
    change({ surfaces: left, ...mediumBeside(left.length, slices.length) });
  };
  const number = surfaces.length > 1 ? ` ${at + 1}` : '';
  return (
    <li class="surface">
      <Slider
        label={`Value of surface${number}`}
        {...{ value: surface.value, min: low, max: high, step: (high - low) / steps || 1 }}
        shown={surface.value.toFixed(decimals)}
        onInput={(value) => set({ value: Number(value.toFixed(decimals)) })}
      />
      <div class="point-fields">
        <NumberField label="Value" value={surface.value} decimals={decimals} onChange={(value) => set({ value })} />
        <NumberField
          label="Opacity"
          value={surface.opacity}
          decimals={2}
          onChange={(opacity) => set({ opacity: Math.min(1, Math.max(0, opacity)) })}
        />
        <input
          type="color"
          aria-label={`Colour of surface${number}`}
          value={toHex(surface.color ?? isoGray)}
          onInput={(event) => set({ color: fromHex(event.currentTarget.value) })}
        />
        <IconButton icon="trash" label={`Remove surface${number}`} onPress={remove} />
      </div>
    </li>
  );
}

export function SurfaceSection({ volume }: { volume: VolumeDescription }): JSX.Element {
  const { surfaces } = display.value;
  const middle = Number(((volume.low + volume.high) / 2).toFixed(decimalsFor(volume.high - volume.low)));
  const add = (
    <button
      type="button"
      class="quiet"
      disabled={surfaces.length >= maxSurfaces}
      onClick={() => change({ surfaces: [...surfaces, { value: middle, color: undefined, opacity: 1 }] })}
    >
      Add surface
    </button>
  );
  return (
    <Section title="Surfaces of one value" aside={add}>
      {surfaces.length > 0 && (
        <>
          <ul class="surfaces">
            {surfaces.map((surface, at) => (
              <Surface key={at} {...{ volume, surface, at }} />
            ))}
          </ul>
          <MediumSwitch />
        </>
      )}
    </Section>
  );
}

function AxisSlice({ axis, samples }: { axis: GridAxis; samples: number }): JSX.Element {
  const { surfaces, slices } = display.value;
  const index = indexAcross(slices, axis);
  const set = (to: number | undefined): void => {
    const changed = withSlice(slices, axis, to);
    change({ slices: changed, ...mediumBeside(surfaces.length, changed.length) });
  };
  const name = axis.toUpperCase();
  return (
    <>
      <Switch
        label={`Across ${name}`}
        checked={index !== undefined}
        onChange={(on) => set(on ? Math.floor(samples / 2) : undefined)}
      />
      {index !== undefined && (
        <Slider
          label={`Index along ${name}`}
          {...{ value: index, min: 0, max: Math.max(0, samples - 1), step: 1 }}
          onInput={set}
        />
      )}
    </>
  );
}

/** Planes of the grid of a volume, or layers of the grid of a tensor field. */
export function SliceSection({ size, medium }: { size: readonly number[]; medium: boolean }): JSX.Element {
  const { slices } = display.value;
  return (
    <Section title="Slices">
      {gridAxes.map((axis, i) => (
        <AxisSlice key={axis} axis={axis} samples={size[i] ?? 1} />
      ))}
      {medium && slices.length > 0 && <MediumSwitch />}
    </Section>
  );
}
