// strand_count + 1 offsets: the first vertex of each strand, then the number of vertices. Then per strand its
// neighbourhood, then per strand the bone that carries its root.
layout(std430, binding = 4) readonly buffer Offsets { uint offsets[]; };
