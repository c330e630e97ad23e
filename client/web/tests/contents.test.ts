import { create } from '@bufbuild/protobuf';
import { describe, expect, it } from 'vitest';
import { ModelDescriptionSchema } from '../src/generated/surfcast_pb';
import { contentsOf } from '../src/state/contents';

describe('the contents of a model', () => {
  it('are points on servers that do not tell kinds apart', () => {
    expect(contentsOf(create(ModelDescriptionSchema, { surfels: 1_234_567n }))).toBe('1.2M points');
  });

  it('name every kind', () => {
    const model = create(ModelDescriptionSchema, {
      kinds: [
        { kind: 'surfel', items: 900n },
        { kind: 'grid', items: 8n },
        { kind: 'gaussian', items: 152_746n },
      ],
      volumes: [{ size: [2, 2, 2] }],
    });
    expect(contentsOf(model)).toBe('900 points, 152.7K Gaussians, volume of 2 × 2 × 2');
  });
});
