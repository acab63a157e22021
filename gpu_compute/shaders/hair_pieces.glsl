// The pieces of strands that stand for them on the grid: air/strand_samples.h.
layout(std430, binding = 0) readonly buffer Positions { vec4 positions[]; };    // m, world
layout(std430, binding = 1) readonly buffer Velocities { vec4 velocities[]; };  // m/s
layout(std430, binding = 2) readonly buffer StrandPieces { uvec4 strand_pieces[]; };
layout(std430, binding = 3) readonly buffer SampleStrands { uint sample_strands[]; };
layout(std430, binding = 4) readonly buffer EdgeMasses { float edge_masses[]; };  // kg; 0 at tips

struct Piece {
  uint first, last;  // vertices
  uint root, tip;    // of its strand
  uint part, parts;  // of the edge
};
Piece pieceOf(uint n) {
  uvec4 strand = strand_pieces[sample_strands[n]];
  uint p = n - strand.z, pieces = strand.w & 0xFFFFu, parts = strand.w >> 16u;
  Piece piece = Piece(0u, 0u, strand.x, strand.x + strand.y, 0u, parts);
  if (parts > 1u) {
    piece.first = strand.x + p / parts;
    piece.last = piece.first + 1u;
    piece.part = p % parts;
  } else {
    piece.first = strand.x + p * strand.y / pieces;
    piece.last = strand.x + (p + 1u) * strand.y / pieces;
  }
  return piece;
}
// Where along the edge the mass of this part is: of whole edges half is at either end.
float alongEdge(Piece piece) { return (float(piece.part) + 0.5) / float(piece.parts); }

// Of the piece's masses: their middle and mean velocity.
void middleOf(Piece piece, out vec3 place, out vec3 motion, out float mass) {
  float at = alongEdge(piece), per_part = 1.0 / float(piece.parts);
  vec3 x = positions[piece.first].xyz, u = velocities[piece.first].xyz;
  place = motion = vec3(0);
  mass = 0.0;
  for (uint v = piece.first; v < piece.last; ++v) {
    vec3 x_next = positions[v + 1u].xyz, u_next = velocities[v + 1u].xyz;
    float m = edge_masses[v] * per_part;
    mass += m;
    place = madd(madd(x_next - x, at, x), m, place);
    motion = madd(madd(u_next - u, at, u), m, motion);
    x = x_next;
    u = u_next;
  }
  float per_mass = inverse(max(mass, 1e-30));
  place *= per_mass;
  motion *= per_mass;
}
