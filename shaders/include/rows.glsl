// A lane of the splat kernel holds SURFCAST_COLUMNS columns of SURFCAST_ROWS pixels, one below the other, as the
// components of one vector: what the lane fetches of a splat serves all of them. On software GL, where fetches cost most,
// a lane holds a whole tile; on hardware, a pixel.
#if SURFCAST_ROWS == 4
#define Rows vec4
#define IntRows ivec4
#define UintRows uvec4
#define BoolRows bvec4
const vec4 kRow = vec4(0.0, 1.0, 2.0, 3.0);
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
const float kRow = 0.0;
BoolRows at_most(Rows a, Rows b) { return a <= b; }
BoolRows less(Rows a, Rows b) { return a < b; }
bool any_of(BoolRows a) { return a; }
BoolRows both(BoolRows a, BoolRows b) { return a && b; }
#define ROW(v, i) v
#endif

// A number for each pixel of a lane.
#define Columns Rows[SURFCAST_COLUMNS]
#define BoolColumns BoolRows[SURFCAST_COLUMNS]

// The first pixel of a column of the lane whose first pixel is given.
vec2 column(vec2 pixel, int c) { return pixel + vec2(float(c), 0.0); }

// The larger and the smaller one of two numbers of which one is not negative: so ordered, too, are their bits as
// integers. The language's own are three instructions in software, for the sake of what is not a number.
Rows larger(Rows a, Rows b) { return intBitsToFloat(max(floatBitsToInt(a), floatBitsToInt(b))); }
Rows smaller(Rows a, Rows b) { return intBitsToFloat(min(floatBitsToInt(a), floatBitsToInt(b))); }
