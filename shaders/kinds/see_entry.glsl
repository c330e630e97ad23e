    // Handles an entry that refers to a kind's record, in the loop of find_surface_large.
    int entry = slot_of(texelFetch(lists, int(first + k)).x);
    if (is_of_kind(entry)) {
      see_fragment(fragment_at(entry, rays[0]), limit, surface, peak);
      continue;
    }
