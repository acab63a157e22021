// A workgroup's block of 8 x 8 x 8 nodes of the hair grid, and a margin around it. One invocation per node.
#define TILE 8
#define INVOCATIONS 512
layout(local_size_x = TILE, local_size_y = TILE, local_size_z = TILE) in;

// Node number n of a block of `side` nodes per axis that has a margin of `margin` nodes on either side; and the inverse.
ivec3 nodeOfBlock(int n, int side, int margin) {
  return ivec3(gl_WorkGroupID) * TILE - margin + ivec3(n % side, n / side % side, n / (side * side));
}
int placeInBlock(ivec3 node, int side, int margin) {
  ivec3 c = node - ivec3(gl_WorkGroupID) * TILE + margin;
  return c.x + side * (c.y + side * c.z);
}
