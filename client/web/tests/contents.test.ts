import { create } from '@bufbuild/protobuf';
import { describe, expect, it } from 'vitest';
import { CoordinateSystemSchema, MemberDescriptionSchema, ModelDescriptionSchema } from '../src/generated/surfcast_pb';
import { contentsOf, kindOf, originOf, systemName } from '../src/state/contents';

describe('the contents of a model', () => {
  it('are points on servers that do not tell kinds apart', () => {
    const scan = create(ModelDescriptionSchema, { surfels: 1_234_567n });
    expect(contentsOf(scan)).toBe('1.2M points');
    expect(kindOf(scan)).toBe('Scan');
  });

  it('lie in a coordinate system with or without a code', () => {
    expect(systemName(create(CoordinateSystemSchema, { name: 'WGS 84', id: 'EPSG:4326' }))).toBe('WGS 84 (EPSG:4326)');
    expect(systemName(create(CoordinateSystemSchema, { name: 'a site' }))).toBe('a site');
  });

  it('are drawn from models or from scans in place', () => {
    const members = [create(MemberDescriptionSchema, { model: 'a' }), create(MemberDescriptionSchema, { model: 'b' })];
    expect(originOf(create(ModelDescriptionSchema, {}))).toBe('a model');
    expect(originOf(create(ModelDescriptionSchema, { inPlace: true }))).toBe('the scan, in place');
    expect(originOf(create(ModelDescriptionSchema, { members }))).toBe('models');
    expect(originOf(create(ModelDescriptionSchema, { inPlace: true, members }))).toBe('models, and scans in place');
  });

  it('name every kind', () => {
    const model = create(ModelDescriptionSchema, {
      kinds: [
        { kind: 'surfel', items: 900n },
        { kind: 'grid', items: 8n },
        { kind: 'gaussian', items: 152_746n },
        { kind: 'ellipsoid', items: 40_141n },
      ],
      volumes: [{ size: [2, 2, 2] }],
    });
    expect(contentsOf(model)).toBe('900 points, 152.7K Gaussians, 40.1K ellipsoids, volume of 2 × 2 × 2');
    expect(kindOf(model)).toBe('Scan and Volume and Gaussians and Ellipsoids');
  });
});
