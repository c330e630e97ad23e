import type { ComponentChildren, JSX } from 'preact';
import { formatNumber } from '../measure/format';
import { bounds, description, lengthDecimals } from '../state/store';
import { Section } from './controls';
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
  const model = description.value;
  if (!model) return null;
  const color = model.colorBits > 0 ? `${model.colorBits} bits a channel` : 'none';
  return (
    <>
      <Views where="in-panel" />
      <Section title={model.model}>
        <dl class="facts">
          <Row name="Points">{count(model.surfels)}</Row>
          {model.spacing > 0 && <Row name="Point spacing">{model.spacing.toPrecision(3)}</Row>}
          <Row name="Colour">{color}</Row>
          <Row name="Vertical axis">{model.zUp ? 'Z' : 'Y'}</Row>
          <Row name="Levels of detail">{model.levels}</Row>
          <Row name="Blocks">{count(model.blocks)}</Row>
        </dl>
      </Section>
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
