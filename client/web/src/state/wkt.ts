/** What the page needs to know of a coordinate system, from its WKT 2 (ISO 19162). */

export interface Unit {
  readonly name: string; // "metre", "US survey foot", "degree"
  readonly size: number; // metres or radians
  readonly kind: 'length' | 'angle';
}

export interface SystemFacts {
  readonly horizontal: Unit | undefined;
  readonly vertical: Unit | undefined; // undefined: the system has no heights
  readonly northIsY: boolean; // east is x, and north is y, everywhere
}

interface Node {
  readonly word: string;
  readonly parts: (string | Node)[];
}

/** The outermost node; undefined if the text has none. Brackets that do not match are tolerated. */
function parse(wkt: string): Node | undefined {
  const root: Node = { word: '', parts: [] };
  const open = [root];
  for (const [token] of wkt.matchAll(/"(?:[^"]|"")*"|[^\s[\](),"]+|[[\]()]/g)) {
    const { parts } = open[open.length - 1]!;
    if (token === '[' || token === '(') {
      const word = parts.pop();
      const node: Node = { word: typeof word === 'string' ? word.toUpperCase() : '', parts: [] };
      parts.push(node);
      open.push(node);
    } else if (token === ']' || token === ')') {
      if (open.length > 1) open.pop();
    } else {
      parts.push(token.startsWith('"') ? token.slice(1, -1).replaceAll('""', '"') : token);
    }
  }
  return childrenOf(root)[0];
}

const childrenOf = (node: Node | undefined): Node[] =>
  node?.parts.filter((part): part is Node => typeof part !== 'string') ?? [];

const textOf = (node: Node, index: number): string => {
  const part = node.parts[index];
  return typeof part === 'string' ? part : '';
};


/** The parts of a system that are not compound. */
function simpleSystems(node: Node | undefined): Node[] {
  if (!node) return [];
  const inner = childrenOf(node).filter(({ word }) => word.endsWith('CRS'));
  const wraps = ['COMPOUNDCRS', 'BOUNDCRS', 'SOURCECRS'].includes(node.word);
  return wraps ? inner.flatMap(simpleSystems) : [node];
}

const unitKinds: Readonly<Record<string, Unit['kind']>> = { LENGTHUNIT: 'length', ANGLEUNIT: 'angle' };

function unitIn(node: Node): Unit | undefined {
  const found = childrenOf(node).find(({ word }) => unitKinds[word] !== undefined);
  const size = found ? Number(textOf(found, 1)) : 0;
  return found && size > 0 ? { name: textOf(found, 0), size, kind: unitKinds[found.word]! } : undefined;
}

interface SystemAxis {
  readonly direction: string;
  readonly unit: Unit | undefined;
}

/** Units are those of each axis, or of all axes together. */
const axesOf = (system: Node): SystemAxis[] =>
  childrenOf(system)
    .filter(({ word }) => word === 'AXIS')
    .map((axis) => ({ direction: textOf(axis, 1).toLowerCase(), unit: unitIn(axis) ?? unitIn(system) }));

export function systemFacts(wkt: string): SystemFacts {
  const axes = simpleSystems(parse(wkt)).flatMap(axesOf);
  const level = axes.filter(({ direction }) => direction !== 'up' && direction !== 'down');
  const directions = level.map(({ direction }) => direction);
  return {
    horizontal: level[0]?.unit,
    vertical: axes.find(({ direction }) => direction === 'up')?.unit,
    // Near a pole, for example, both axes point north, along different meridians.
    northIsY: directions.length === 2 && directions.includes('east') && directions.includes('north'),
  };
}
