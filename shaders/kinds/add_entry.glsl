      // Handles an entry that refers to a kind's record, in the loop of accumulate_large.
      if (is_of_kind(slot)) {
        add_fragment(fragment_at(slot, rays[0]), limit, surface, unit, sums);
        continue;
      }
