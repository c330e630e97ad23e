  // Handles an entry that refers to a kind's record, in add_large.
  if (is_of_kind(slot)) {
    add_kind(fragment_at(slot, ray), limit, surface, reference, unit, medium, sums);
    return;
  }
