// The number of the work group in a pass that is dispatched in batches.
layout(location = SURFCAST_UNIFORM_FIRST_GROUP) uniform uint first_group;

// Interleaves `count` groups: any run of i has groups from all parts of the batch.
uint interleaved(uint i, uint count) {
  const uint kParts = 16u;
  uint size = count / kParts;
  return i < size * kParts ? i % kParts * size + i / kParts : i;
}

// A thread of software GL takes successive groups of a batch. Lists of work begin with what takes longest, so without
// interleaving the first thread would still work when the others have finished.
uint work_group() {
#ifdef SURFCAST_INTERLEAVES_GROUPS
  return first_group + interleaved(gl_WorkGroupID.x, gl_NumWorkGroups.x);
#else
  return first_group + gl_WorkGroupID.x;
#endif
}
