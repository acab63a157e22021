// First vertex of each strand, one more than there are; then the neighbourhood of each.
layout(std430, binding = 4) readonly buffer Offsets { uint offsets[]; };
