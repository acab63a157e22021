// First vertex of each strand, one more than there are; then the neighbourhood of each; then the bone that its root rides on.
layout(std430, binding = 4) readonly buffer Offsets { uint offsets[]; };
