  // Handles an entry that refers to a kind's record, in large_disc.
  if (is_of_kind(slot)) {
    Fragment f = fragment_at(slot, ray);
    return f.inverse_depth > 0.0 ? LargeDisc(f.inverse_depth, 1.0 / f.inverse_depth, 1.0 / f.occluder) : kNoDisc;
  }
