#version 450 core
// 64 isolines per patch, one per hair, of up to 64 segments. The last patch may have fewer hairs, and the last patch of
// a hair fewer segments.
layout(vertices = 1) out;
layout(location = 0) in int patch_of_vertex[];
layout(location = 1) patch out uint first_hair;
layout(location = 2) patch out uint first_segment;
uniform uint hair_count;
uniform uint pass_segments;
void main() {
  uint along = (pass_segments + 63u) / 64u, number = uint(patch_of_vertex[0]);
  first_hair = number / along * 64u;
  first_segment = number % along * 64u;
  gl_TessLevelOuter[0] = float(min(hair_count - min(first_hair, hair_count), 64u));
  gl_TessLevelOuter[1] = float(min(pass_segments - first_segment, 64u));
}
