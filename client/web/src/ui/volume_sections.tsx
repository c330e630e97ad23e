import type { JSX } from 'preact';
import { TransferPreset, type VolumeDescription } from '../generated/surfcast_pb';
import { splatConventions, type DisplayOptions, type SplatConventionName } from '../state/display_options';
import { description, display } from '../state/store';
import { fitTo, rangeOf, type PresetName, type Transfer, type TransferPoint } from '../volume/transfer';
import { Choices, Section, Switch } from './controls';
import { TransferEditor } from './transfer_editor';

const change = (part: Partial<DisplayOptions>): void => void (display.value = { ...display.peek(), ...part });

const presetLabels: readonly { value: PresetName; label: string; preset: TransferPreset }[] = [
  { value: 'gray', label: 'Grey', preset: TransferPreset.GRAY },
  { value: 'ct-bone', label: 'CT bone', preset: TransferPreset.CT_BONE },
  { value: 'ct-soft', label: 'CT soft', preset: TransferPreset.CT_SOFT },
  { value: 'mr', label: 'MR', preset: TransferPreset.MR },
];

/** The points that the server uses: those chosen, or the preset's for this volume. */
function pointsOf(transfer: Transfer, volume: VolumeDescription): readonly TransferPoint[] {
  if (transfer.points.length > 0) return transfer.points;
  const number = presetLabels.find(({ value }) => value === transfer.preset)?.preset;
  const found = volume.presets.find(({ preset }) => preset === number)?.points ?? [];
  const points = found.map(({ value, color, opacity }) => ({
    value,
    opacity,
    color: { red: color?.red ?? 0, green: color?.green ?? 0, blue: color?.blue ?? 0 },
  }));
  return transfer.range ? fitTo(points, rangeOf(points), transfer.range) : points;
}

/** Enough decimals to tell a thousandth of the range apart. */
const decimalsFor = (span: number): number =>
  span > 0 ? Math.min(6, Math.max(0, Math.ceil(3 - Math.log10(span)))) : 3;

export function VolumeSections(): JSX.Element | null {
  const volume = description.value?.volumes[0];
  if (!volume) return null;
  const { transfer, shaded } = display.value;
  const own = transfer.points.length > 0;
  const set = (points: readonly TransferPoint[]): void => change({ transfer: { ...transfer, points } });
  return (
    <Section title={`Colour and opacity by value${volume.sampleUnit && `, ${volume.sampleUnit}`}`}>
      <Choices<PresetName | 'own'>
        label="Preset"
        value={own ? 'own' : transfer.preset}
        options={[...presetLabels, { value: 'own', label: 'Own', disabled: !own }]}
        onChange={(chosen) => {
          if (chosen !== 'own') change({ transfer: { preset: chosen, range: undefined, points: [] } });
        }}
      />
      <TransferEditor
        points={pointsOf(transfer, volume)}
        low={volume.low}
        high={volume.high}
        counts={volume.histogram.map(Number)}
        decimals={decimalsFor(volume.high - volume.low)}
        onChange={set}
      />
      <Switch label="Light by gradient" checked={shaded} onChange={(on) => change({ shaded: on })} />
    </Section>
  );
}

const conventionLabels: Readonly<Record<SplatConventionName, string>> = { trained: 'As trained', exact: 'Exact' };

export function GaussianSection(): JSX.Element | null {
  if (!description.value?.kinds.some(({ kind }) => kind === 'gaussian')) return null;
  return (
    <Section title="Gaussians">
      <Choices
        label="Convention"
        value={display.value.splatConvention}
        options={splatConventions.map((value) => ({ value, label: conventionLabels[value] }))}
        onChange={(splatConvention) => change({ splatConvention })}
      />
    </Section>
  );
}
