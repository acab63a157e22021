#version 450 core
// 64 isolines a patch, one per hair; the last patch may have fewer.
layout(vertices = 1) out;
layout(location = 0) in int patch_of_vertex[];
layout(location = 1) patch out uint first_hair;
uniform uint hair_count;
uniform uint pass_segments;
void main() {
  first_hair = uint(patch_of_vertex[0]) * 64u;
  gl_TessLevelOuter[0] = float(min(hair_count - min(first_hair, hair_count), 64u));
  gl_TessLevelOuter[1] = float(pass_segments);
}
