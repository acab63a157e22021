// Rest data of the rod's strands, and the lists of strands that dispatches work on.
struct StrandRest {       // strandRest() of gpu_compute/rod_strands.cc
  float edge_length;      // m, mean; used with STRAND_UNIFORMITY >= 2
  float inverse_length;   // 1/m
  float twist_per_bend;   // twisting over bending stiffness; used with STRAND_UNIFORMITY >= 1
  float shortest;         // m; shorter edges bend as if they were this long
  float free_mass;        // mass of all free vertices, over the reference mass
  float arc_length;       // m
  float stiffest;         // 1/s^2, greatest stiffness ratio kappa of an edge (stiffnessOf()) over time2
  float bend, root_bend;  // m^2/s^2, of joints, and of the joint at the root; used with STRAIGHT and STRAND_UNIFORMITY 3
  float traits;           // bit mask: bendsUnevenly() 1, isCutUnevenly() 2, hangsBetweenPins() 4, isSharp() 8
};
layout(std430, binding = 12) readonly buffer Strands { StrandRest strand_rest[]; };
// In this order:
// - strand numbers, sorted by group;
// - 4 numbers per list: workgroups in x, y, z of its indirect dispatch, and the count of strands. Lists: per group the
//   contact-free strands; per group the near strands; then per substep: per group those that need the dense metric, per
//   group those with a stale cache, and the possibly penetrating strands of all groups;
// - the lists, each starting at its group's offset: contact-free, near, dense metric, stale cache; then penetrating.
layout(std430, binding = 5) buffer Work { uint work[]; };
