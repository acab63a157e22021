// What a body is to a vertex in a substep: a plane along its surface.
struct Touch {
  float gap;      // m, to its surface, or to the plane through where the way met it
  vec3 normal;    // of the same
  vec3 carried;   // m, where the surface has taken the point at which the vertex was
  float friction;
};
Touch untouched(vec3 x, float reach) { return Touch(reach, vec3(0), x, 0.0); }
