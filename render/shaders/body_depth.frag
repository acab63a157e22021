#version 450 core
// A body in a light's shadow map.
layout(location = 0) in float depth;
void main() {
  if (depth < 0.0 || depth > 1.0) discard;
  gl_FragDepth = depth;
}
