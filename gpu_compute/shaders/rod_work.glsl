// What strands of the rod are at rest, and lists of those that are to be done.
struct StrandRest {      // gpu_compute/rod_strands.cc
  float edge_length;     // m; of uniform strands
  float inverse_length;  // 1/m
  float twist_per_bend;  // of uniform strands
  float shortest;        // m; shorter edges bend as if they were this long
  float free_mass;       // of all vertices that are not pinned
  float arc_length;      // m
  float stiffest;        // 1/s^2: the greatest kappa of an edge (isStiff) over the square of the substep
  float bend, root_bend; // m^2/s^2, of joints and of that at the root; of uniform strands that are straight at rest
  float traits;          // bendsUnevenly(): 1, isCutUnevenly(): 2, hangsBetweenPins(): 4, isSharp(): 8
};
layout(std430, binding = 12) readonly buffer Strands { StrandRest strand_rest[]; };
// Strands by group; 4 numbers for each group's clear strands, for its near ones, and for its violent ones and those astray in each substep:
// workgroups in x, y, z of the dispatch of the latter two, and how many strands; how many are lost; the lists of clear strands, which start
// where the groups do, those of near, violent and astray ones likewise; that of lost ones.
layout(std430, binding = 5) buffer Work { uint work[]; };
