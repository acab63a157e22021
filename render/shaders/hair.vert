#version 450 core
// A patch has one vertex and no data: the tessellator generates everything. The patch number is passed on, because
// gl_PrimitiveID restarts at every draw.
layout(location = 0) out int patch_of_vertex;
void main() { patch_of_vertex = gl_VertexID; }
