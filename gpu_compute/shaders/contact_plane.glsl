// Contact plane of a body and a vertex in a substep: the plane tangent to the body's surface near the vertex.
struct ContactPlane {
  float gap;     // m, signed distance of the vertex less its clearance; negative inside
  vec3 normal;   // unit, out of the body; 0: no contact
  vec3 carried;  // m, carried point: where the surface takes the point at which the vertex was
  float friction;
};
// `reach`: lower bound of the gap, m.
ContactPlane noContact(vec3 x, float reach) { return ContactPlane(reach, vec3(0), x, 0.0); }
