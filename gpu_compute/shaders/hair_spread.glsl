// What a workgroup spreads to the nodes around its samples, NUMBERS per node, in whole numbers, so that sums do not depend on
// their order. An invocation has one number of one of the eight nodes around a place and goes from sample to sample: those are
// neighbours, so that it mostly stays at its node, and only where it leaves is anything added to memory, by invocations side
// by side to numbers side by side. Needs SUMS, where they go.
shared vec4 spots[TILE_SAMPLES];       // where samples are between nodes; w is free
shared int first_nodes[TILE_SAMPLES];  // of the eight around a sample. Not as bits of a float: GPUs may flush denormals
shared float values[NUMBERS * uint(TILE_SAMPLES)];

void put(uint sample_, GridPlace corner, vec4 value) {
  spots[sample_] = vec4(corner.part, 0);
  first_nodes[sample_] = nodeAt(ivec3(corner.low));
  for (uint number = 0u; number < NUMBERS; ++number) values[NUMBERS * sample_ + number] = value[number];
}
void leaveOut(uint sample_) {
  spots[sample_] = vec4(0);
  first_nodes[sample_] = 0;
  for (uint number = 0u; number < NUMBERS; ++number) values[NUMBERS * sample_ + number] = 0.0;
}
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
