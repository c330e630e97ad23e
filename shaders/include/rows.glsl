// A lane of the splat kernel holds SURFCAST_COLUMNS columns of SURFCAST_ROWS pixels each. The pixels of a column are
// the components of one vector, so all of them share one fetch of a splat. With software GL, where fetches cost most, a
// lane holds a whole tile; on GPUs it holds one pixel.
#if SURFCAST_ROWS == 4
#define Rows vec4
#define IntRows ivec4
#define UintRows uvec4
#define BoolRows bvec4
BoolRows at_most(Rows a, Rows b) { return lessThanEqual(a, b); }
BoolRows less(Rows a, Rows b) { return lessThan(a, b); }
bool any_of(BoolRows a) { return any(a); }
BoolRows both(BoolRows a, BoolRows b) { return bvec4(uvec4(a) & uvec4(b)); }
#define ROW(v, i) v[i]
#else
#define Rows float
#define IntRows int
#define UintRows uint
#define BoolRows bool
BoolRows at_most(Rows a, Rows b) { return a <= b; }
BoolRows less(Rows a, Rows b) { return a < b; }
bool any_of(BoolRows a) { return a; }
BoolRows both(BoolRows a, BoolRows b) { return a && b; }
#define ROW(v, i) v
#endif

// One number for each pixel of a lane.
#define Columns Rows[SURFCAST_COLUMNS]
#define BoolColumns BoolRows[SURFCAST_COLUMNS]

// The numbers of column c. Not columns[c]: for an index that is not constant, software GL compiles a tree of branches,
// and a kernel takes seconds longer to compile.
Rows rows_of(Columns columns, int c) {
  Rows rows = columns[0];
  for (int i = 1; i < SURFCAST_COLUMNS; ++i) rows = c == i ? columns[i] : rows;
  return rows;
}

// Sets the numbers of column c.
void set_rows(inout Columns columns, int c, Rows rows) {
  for (int i = 0; i < SURFCAST_COLUMNS; ++i) columns[i] = c == i ? rows : columns[i];
}

#ifdef SURFCAST_SUPERSAMPLED
// A column is a pixel and its rows are samples: a rotated grid, see SURFCAST_SILHOUETTE_VARIANCE. The numbers -3, -1, 1
// and 3 have a variance of 5.
const float kSampleStep = sqrt(SURFCAST_SILHOUETTE_VARIANCE / 5.0);
const float kSampleX[4] = float[4](-kSampleStep, 3.0 * kSampleStep, kSampleStep, -3.0 * kSampleStep);
const float kSampleY[4] = float[4](-3.0 * kSampleStep, -kSampleStep, 3.0 * kSampleStep, kSampleStep);
vec2 column_places[SURFCAST_COLUMNS];  // pixels, relative to the lane's first pixel
vec2 column(vec2 pixel, int c) { return pixel + column_places[c]; }
#else
// The first pixel of column c. `pixel` is the lane's first pixel.
vec2 column(vec2 pixel, int c) { return pixel + vec2(float(c), 0.0); }
#endif

// The change of an affine function with this gradient from the first row to each row.
Rows over_rows(vec2 gradient) {
#if SURFCAST_ROWS == 1
  return 0.0;
#elif defined(SURFCAST_SUPERSAMPLED)
  return gradient.x * vec4(kSampleX[0], kSampleX[1], kSampleX[2], kSampleX[3]) +
         gradient.y * vec4(kSampleY[0], kSampleY[1], kSampleY[2], kSampleY[3]);
#else
  return gradient.y * vec4(0.0, 1.0, 2.0, 3.0);
#endif
}

// The place of row i relative to the first row, or to the middle of the samples.
vec2 place_of_row(int i) {
  return vec2(ROW(over_rows(vec2(1.0, 0.0)), i), ROW(over_rows(vec2(0.0, 1.0)), i));
}

// The larger and the smaller of two numbers, at least one of which is not negative: then the order of their bits as
// integers is the same. The built-in functions take three instructions in software, because they handle NaN.
Rows larger(Rows a, Rows b) { return intBitsToFloat(max(floatBitsToInt(a), floatBitsToInt(b))); }
Rows smaller(Rows a, Rows b) { return intBitsToFloat(min(floatBitsToInt(a), floatBitsToInt(b))); }

// The least of the numbers of a column, none of which is negative.
float least_of(Rows a) {
#if SURFCAST_ROWS == 1
  return a;
#else
  ivec2 pairs = min(floatBitsToInt(a.xy), floatBitsToInt(a.zw));
  return intBitsToFloat(min(pairs.x, pairs.y));
#endif
}
