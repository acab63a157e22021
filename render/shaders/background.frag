#version 450 core
#include "render/shaders/scene.glsl"
layout(location = 0) out vec4 color;
void main() { color = vec4(backgroundColor(gl_FragCoord.xy), 1); }
