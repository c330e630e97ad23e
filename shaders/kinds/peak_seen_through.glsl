    // Handles an entry that refers to a kind's record, in the loop of peak_of_large.
    if (is_of_kind(slot)) {
      peak = max(peak, 1.0);
      continue;
    }
