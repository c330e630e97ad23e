// The sign bit of a.w. It is set in records of other kinds than surfels; the other bits are the number of the kind.
#define SURFCAST_KIND_RECORD 0x80000000u
