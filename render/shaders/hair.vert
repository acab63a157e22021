#version 450 core
// A patch has one vertex and no data: the tessellator makes everything. The number of the patch goes along, as
// gl_PrimitiveID starts again at every draw.
layout(location = 0) out int patch_of_vertex;
void main() { patch_of_vertex = gl_VertexID; }
