// Trilinear splat of a workgroup's samples to the eight nodes around each, NUMBERS values per node, in fixed point, so that
// sums do not depend on their order.
// Each invocation owns one value of one of the eight corners and loops over samples. Consecutive samples are neighbours in
// space, so it accumulates in a register while the node stays the same; only a change of node costs an atomic add.
// Neighbouring invocations add to adjacent memory.
// NUMBERS: values per node, 1 to 4. SUMS: the buffer that receives the sums.
shared vec4 spots[TILE_SAMPLES];       // xyz: position of a sample between nodes, 0 to 1; w: unused
shared int first_nodes[TILE_SAMPLES];  // lowest node around a sample. Not as bits of a float: GPUs may flush denormals
shared float values[NUMBERS * uint(TILE_SAMPLES)];

// Sets the values of a sample at a grid place.
void put(uint sample_, GridPlace corner, vec4 value) {
  spots[sample_] = vec4(corner.part, 0);
  first_nodes[sample_] = nodeAt(ivec3(corner.low));
  for (uint number = 0u; number < NUMBERS; ++number) values[NUMBERS * sample_ + number] = value[number];
}
// Sets the values of a sample to 0.
void discardSample(uint sample_) {
  spots[sample_] = vec4(0);
  first_nodes[sample_] = 0;
  for (uint number = 0u; number < NUMBERS; ++number) values[NUMBERS * sample_ + number] = 0.0;
}
// Splats samples 0 to count - 1. After a barrier; by all invocations.
void spread(uint count) {
  const uint together = 8u * NUMBERS, groups = uint(TILE_SAMPLES) / together;
  uint me = gl_LocalInvocationIndex, group = me / together, number = me % NUMBERS;
  ivec3 corner = cornerOf(int(me / NUMBERS % 8u));
  vec3 toward = vec3(corner);
  int sum = 0, node = 0, offset = nodeAt(corner);
  for (uint n = count * group / groups; n < count * (group + 1u) / groups; ++n) {
    vec3 spot = spots[n].xyz;
    if (first_nodes[n] != node) {
      if (sum != 0) atomicAdd(SUMS[NUMBERS * uint(node + offset) + number], sum);
      sum = 0;
      node = first_nodes[n];
    }
    sum += int(fixedPoint(values[NUMBERS * n + number] * splatWeight(spot, toward.x, toward.y, toward.z)));
  }
  if (sum != 0) atomicAdd(SUMS[NUMBERS * uint(node + offset) + number], sum);
}
