// A block of 8 x 8 x 8 cells of a level and those around it. Needs pressure_level.glsl.
#define TILE 8
#define INVOCATIONS 512
#define NEAR (TILE + 2)
#define FAR (TILE + 4)
layout(local_size_x = TILE, local_size_y = TILE, local_size_z = TILE) in;

// Place number n of the block with `margin` cells around it.
ivec3 cellOfBlock(int n, int margin) {
  int side = TILE + 2 * margin;
  return ivec3(gl_WorkGroupID) * TILE - margin + ivec3(n % side, n / side % side, n / (side * side));
}
int placeInBlock(ivec3 c, int margin) {
  int side = TILE + 2 * margin;
  ivec3 at = c - ivec3(gl_WorkGroupID) * TILE + margin;
  return at.x + side * (at.y + side * at.z);
}
bool isOwn(ivec3 c) { return all(equal(c / TILE, ivec3(gl_WorkGroupID))) && isOnLevel(c); }
uint tiles() { return gl_NumWorkGroups.x * gl_NumWorkGroups.y * gl_NumWorkGroups.z; }
uint tileNumber() {
  return gl_WorkGroupID.x + gl_NumWorkGroups.x * (gl_WorkGroupID.y + gl_NumWorkGroups.y * gl_WorkGroupID.z);
}

// Sums over all invocations of a workgroup, in an order that is always the same.
shared float summed[INVOCATIONS];
float sumOf(float value) {
  int me = int(gl_LocalInvocationIndex);
  barrier();
  summed[me] = value;
  for (int half_ = INVOCATIONS / 2; half_ > 0; half_ /= 2) {
    barrier();
    if (me < half_) summed[me] += summed[me + half_];
  }
  barrier();
  return summed[0];
}
