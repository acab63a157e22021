#version 450 core
layout(location = 0) in vec3 mark_color;
layout(location = 0) out vec4 color;
void main() { color = vec4(mark_color, 1); }
