import { describe, expect, it } from 'vitest';
import { worldOf } from './support/las';
import * as look from './support/page';
import { useYard } from './support/yard';

const yard = useYard();

/** Clicks the two points of a measurement, each of which is there before the next is clicked. */
async function measureTwoPoints(kind: string): Promise<void> {
  const card = yard.page.locator(`.card[data-kind=${kind}]`);
  for (const [dx, dy, figures] of [[-60, 20, '.faint'], [70, -10, '.main dd']] as const) {
    const pixel = await look.middle(yard.page, dx, dy);
    await yard.page.mouse.click(pixel.x, pixel.y);
    await card.locator(figures).waitFor();
  }
}

/** The bytes of a file that an action saves. */
const saved = async (action: () => Promise<void>): Promise<Buffer> => (await look.saved(yard.page, action)).bytes;

const rounding = 1e-9; // metres

/** Points of the scene in a band from a to b, by a search of them all. */
function pointsInBand(a: number[], b: number[], width: number): number {
  const [dx, dy] = [b[0]! - a[0]!, b[1]! - a[1]!];
  const length = Math.hypot(dx, dy);
  const places = new Set<string>();
  for (const p of yard.scene) {
    const [x, y, z] = worldOf(p);
    const along = ((x - a[0]!) * dx + (y - a[1]!) * dy) / length;
    const across = ((y - a[1]!) * dx - (x - a[0]!) * dy) / length;
    // The ends are points of the scene, which belong to the band however their places are rounded.
    if (along < -rounding || along > length + rounding || Math.abs(across) > width / 2) continue;
    // The model has one surfel for points that coincide.
    places.add(`${x},${y},${z}`);
  }
  return places.size;
}

describe('the tools', () => {
  it('reads the source point with all its attributes', async () => {
    await yard.open();
    const { at, rows } = await yard.inspect(0, 0);
    const source = yard.scene.filter((p) => worldOf(p).every((value, i) => value === at[i]));
    expect(source.length).toBeGreaterThan(0); // to the last bit
    const matching = source.find((p) => String(p.intensity) === rows.get('intensity'));
    expect(matching).toBeDefined();
    expect(rows.get('classification')).toContain(String(matching!.classification));
  });

  it('measures a distance to the precision of the scan', async () => {
    await yard.open();
    const [a, b] = [(await yard.inspect(-60, 20)).at, (await yard.inspect(70, -10)).at];
    await yard.page.keyboard.press('m');
    await measureTwoPoints('distance');
    await yard.page.keyboard.press('Enter');
    const shown = (await yard.page.locator('.card[data-kind=distance] .main dd').textContent()) ?? '';
    const exact = Math.hypot(...a.map((value, i) => value - b[i]!));
    expect(Math.abs(Number(shown.replaceAll('\u202f', '')) - exact)).toBeLessThanOrEqual(0.0005);
  });

  it('shows the points along a profile, and saves them and the measurements', async () => {
    await yard.open();
    const [a, b] = [(await yard.inspect(-60, 20)).at, (await yard.inspect(70, -10)).at];
    await yard.page.keyboard.press('p');
    await measureTwoPoints('profile');
    await yard.page.keyboard.press('Enter');
    const card = yard.page.locator('.card[data-kind=profile]');
    await card.getByText('in the band').waitFor();
    const width = Number(await card.getByLabel('Width of the band').inputValue());
    const expected = pointsInBand(a, b, width);
    expect(expected).toBeGreaterThan(100);
    expect((await card.locator('.band p').textContent())?.replaceAll('\u202f', '')).toBe(`${expected} points in the band`);
    const painted = await card.locator('canvas').evaluate((canvas: HTMLCanvasElement) => {
      const { data } = canvas.getContext('2d')!.getImageData(0, 0, canvas.width, canvas.height);
      return data.reduce((count, byte, i) => count + (i % 4 === 3 && byte > 0 ? 1 : 0), 0);
    });
    expect(painted).toBeGreaterThan(100);

    const csv = (await saved(() => card.getByText('Points as CSV').click())).toString().trimEnd().split('\r\n');
    expect(csv[0]).toContain('x,y,z,along,across,red,green,blue');
    expect(csv).toHaveLength(1 + expected);
    const las = await saved(() => card.getByText('Points as LAS').click());
    expect(las.subarray(0, 4).toString()).toBe('LASF');
    expect(Number(las.readBigUInt64LE(247))).toBe(expected);

    const geoJson = JSON.parse((await saved(() => yard.page.getByRole('button', { name: 'GeoJSON' }).click())).toString()) as {
      features: { properties: { kind: string }; geometry: { coordinates: number[][] } }[];
    };
    expect(geoJson.features.map((feature) => feature.properties.kind)).toEqual(['profile']);
    expect(geoJson.features[0]!.geometry.coordinates).toEqual([a, b]);
    const table = await saved(() => yard.page.getByRole('button', { name: 'CSV', exact: true }).click());
    expect(table.toString()).toContain(`1,profile,1,${a.join(',')},`);
  });
});
