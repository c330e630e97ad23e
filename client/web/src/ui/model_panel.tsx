import type { ComponentChildren, JSX } from 'preact';
import type { EllipsoidDescription, ModelDescription, VolumeDescription } from '../generated/surfcast_pb';
import { formatNumber } from '../measure/format';
import { kindOf, originOf, systemName } from '../state/contents';
import { bounds, description, display, lengthDecimals, upAxis } from '../state/store';
import { useActions } from './actions';
import { Section, Switch } from './controls';
import { MembersSection } from './members_section';
import { Views } from './views';

function Row({ name, children }: { name: string; children: ComponentChildren }): JSX.Element {
  return (
    <div>
      <dt>{name}</dt>
      <dd>{children}</dd>
    </div>
  );
}

const count = (value: bigint | number): string => formatNumber(Number(value), 0);

const kindLabels: Readonly<Record<string, string>> = { surfel: 'Points', grid: 'Samples', gaussian: 'Gaussians', ellipsoid: 'Ellipsoids' };

/** The number of items of each kind; of a server that does not tell kinds apart, the points. */
function Items({ model }: { model: ModelDescription }): JSX.Element {
  if (model.kinds.length === 0) return <Row name="Points">{count(model.surfels)}</Row>;
  const rows = model.kinds.map(({ kind, items }) => (
    <Row key={kind} name={kindLabels[kind] ?? kind}>
      {count(items)}
    </Row>
  ));
  return <>{rows}</>;
}

function Volume({ volume }: { volume: VolumeDescription }): JSX.Element {
  const significant = (value: number): string => String(Number(value.toPrecision(5)));
  const unit = (text: string): string => (text ? ` ${text}` : '');
  return (
    <Section title={volume.name || 'Volume'}>
      <dl class="facts">
        <Row name="Samples">{volume.size.join(' × ')}</Row>
        <Row name="Spacing">{volume.spacing.map(significant).join(' × ') + unit(volume.lengthUnit)}</Row>
        <Row name="Values">{`${significant(volume.low)} – ${significant(volume.high)}${unit(volume.sampleUnit)}`}</Row>
      </dl>
    </Section>
  );
}

function Ellipsoids({ source }: { source: EllipsoidDescription }): JSX.Element {
  const significant = (value: number): string => String(Number(value.toPrecision(5)));
  const unit = source.sampleUnit ? ` ${source.sampleUnit}` : '';
  return (
    <Section title={source.name || 'Ellipsoids'}>
      <dl class="facts">
        {source.size.length > 0 && <Row name="Samples">{source.size.join(' × ')}</Row>}
        <Row name="Drawn">{`${count(source.drawn)} of ${count(source.samples)}`}</Row>
        <Row name="Mean FA">{significant(source.meanFa)}</Row>
        <Row name="Mean mode">{significant(source.meanMode)}</Row>
        <Row name={source.tensors ? 'Mean eigenvalues' : 'Mean semi-axes'}>
          {source.meanValues.map(significant).join(' ') + unit}
        </Row>
        {source.ranges.map(({ attribute, smallest, largest }) => (
          <Row key={attribute} name={attribute}>{`${significant(smallest)} – ${significant(largest)}`}</Row>
        ))}
      </dl>
    </Section>
  );
}

function Extent(): JSX.Element {
  const { min, max } = bounds.value;
  const rows = (['x', 'y', 'z'] as const).map((axis) => (
    <tr key={axis}>
      <th scope="row">
        <b class={`axis ${axis}`}>{axis.toUpperCase()}</b>
      </th>
      {[min[axis], max[axis], max[axis] - min[axis]].map((value, i) => (
        <td key={i}>{formatNumber(value, Math.min(3, lengthDecimals.value))}</td>
      ))}
    </tr>
  ));
  return (
    <table class="extent">
      <thead>
        <tr>
          <th />
          <th scope="col">from</th>
          <th scope="col">to</th>
          <th scope="col">size</th>
        </tr>
      </thead>
      <tbody>{rows}</tbody>
    </table>
  );
}

export function ModelPanel(): JSX.Element | null {
  const { navigator } = useActions();
  const model = description.value;
  if (!model) return null;
  const color = model.colorBits > 0 ? `${model.colorBits} bits a channel` : 'none';
  return (
    <>
      <Views where="in-panel" />
      <MembersSection />
      <Section title={model.model}>
        <dl class="facts">
          <Row name="Kind">{kindOf(model)}</Row>
          <Row name="Drawn from">{originOf(model)}</Row>
          <Items model={model} />
          {model.spacing > 0 && <Row name="Point spacing">{model.spacing.toPrecision(3)}</Row>}
          <Row name="Colour">{color}</Row>
          {model.system && <Row name="Coordinates">{systemName(model.system)}</Row>}
          {model.sourceSystem && <Row name="Of the scan">{systemName(model.sourceSystem)}</Row>}
          <Row name="Vertical axis">{upAxis.value.toUpperCase()}</Row>
          <Row name="Levels of detail">{model.levels}</Row>
          <Row name="Blocks">{count(model.blocks)}</Row>
        </dl>
        {model.inPlace && (
          <p class="faint">
            No model was built of the scan. Ranges and classes are those of a part of its points. A built model gives the
            best pictures.
          </p>
        )}
        <Switch label="Upside down" checked={display.value.upsideDown} onChange={() => navigator.turnOver()} />
      </Section>
      {model.volumes.map((volume, i) => (
        <Volume key={i} volume={volume} />
      ))}
      {model.ellipsoids.map((source, i) => (
        <Ellipsoids key={i} source={source} />
      ))}
      <Section title="Extent">
        <Extent />
      </Section>
      {model.attributes.length > 0 && (
        <Section title="Attributes">
          <dl class="facts">
            {model.attributes.map((name) => {
              const range = model.ranges.find((each) => each.attribute === name);
              return (
                <Row key={name} name={name}>
                  {range ? `${Number(range.smallest.toPrecision(6))} – ${Number(range.largest.toPrecision(6))}` : ''}
                </Row>
              );
            })}
          </dl>
        </Section>
      )}
      <Section title="Made from">
        <ul class="sources">
          {model.sources.map((source) => (
            <li key={source}>{source.replace(/^.*[/\\]/, '')}</li>
          ))}
        </ul>
      </Section>
    </>
  );
}
