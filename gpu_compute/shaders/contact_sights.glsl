// What vertices know of bodies in a substep: where they have looked at them from, and the planes along the two nearest.
// core/near_bodies.inl has the same for the CPU. Needs kernels/contact.h, step_input.glsl, strand_offsets.glsl and touch.glsl.

// Of every vertex what bodies pressed it with, StrandState::contacts, and in w the part of its speed in the substep that it kept (see slowed() in
// kernels/rod.h), less than 0 unless exact lengths have moved it from where contact had left it; then what it sees, in five rows.
layout(std430, binding = 3) buffer Contacts { vec4 contacts[]; };
// xyz: where it looked from; w: -1e9 if it has planes, else how much farther than its reach all bodies are from there, m.
const uint kLooked = 0u;
// Of a plane: normal, 0 where there is none, and what that makes of its points; then Touch::carried and friction.
const uint kFirstPlane = 1u, kPlaneRows = 2u, kMostPlanes = 2u;
// Of roots, which see nothing, in kLooked: x: how far bodies may come in a step of a clear strand, m, in which they move together as y, or
// kNear; y: the number of a body, or -1: not at all; w: wayOutOf() a body that may cover the root in the step, 0 where nothing comes of that. And here
// Cover::bodies and depth, RootMotion::spin, z of the jump; then the rest of their motion: position and x of the jump, the tangent before
// and y of the jump, rotation.
const float kNear = -1.0;
const uint kCover = 1u, kRootPosition = 2u, kRootTangent = 3u, kRootRotation = 4u;

// Row by row, so that neighbours read neighbours.
uint sightAt(uint vertex, uint row) { return vertex + (row + 1u) * offsets[settings.strand_count]; }
bool isClear(uint strand) { return contacts[sightAt(offsets[strand], kLooked)].x >= 0.0; }
bool seesPlanes(vec4 looked) { return looked.w < -1e8; }
// What the plane that starts in this row is to a vertex at x.
Touch planeOf(uint vertex, uint row, vec3 x) {
  vec4 plane = contacts[sightAt(vertex, row)], surface = contacts[sightAt(vertex, row + 1u)];
  return Touch(dot(plane.xyz, x) - plane.w, plane.xyz, surface.xyz, surface.w);
}
// How far from where it looked a vertex may go without touching a body, m.
float roomOf(uint vertex, vec4 looked) {
  return seesPlanes(looked) ? planeOf(vertex, kFirstPlane, looked.xyz).gap : looked.w;
}
// Whether a vertex is so far from where it looked that it has to look again; its reach may have grown by half of its way.
bool isAstray(vec4 looked, vec3 x) {
  float off = length(x - looked.xyz);
  return off > lookReach() && 1.5 * off > looked.w;
}

// What the bodies are to a vertex at x that has planes: the deeper one.
Touch touchOf(uint vertex, vec3 x) {
  const vec4 first = contacts[sightAt(vertex, kFirstPlane)], second = contacts[sightAt(vertex, kFirstPlane + kPlaneRows)];
  const float gap = dot(first.xyz, x) - first.w, other_gap = dot(second.xyz, x) - second.w;
  if (!(min(gap, other_gap) < contactReach())) return untouched(x, contactReach());
  const bool other = other_gap < gap;
  const vec4 surface = contacts[sightAt(vertex, (other ? kFirstPlane + kPlaneRows : kFirstPlane) + 1u)];
  return Touch(other ? other_gap : gap, other ? second.xyz : first.xyz, surface.xyz, surface.w);
}
// The square of how far what is near a vertex that has planes, at x, takes a point that was at `start` in this substep, m^2; less of what
// is less near.
float carried2Of(uint vertex, vec3 x, vec3 start) {
  float most = 0.0;
  for (uint row = kFirstPlane; row < kFirstPlane + kMostPlanes * kPlaneRows; row += kPlaneRows) {
    const Touch own = planeOf(vertex, row, x);
    const vec3 way = (own.carried - start) * nearness(own.gap);
    most = max(most, dot(way, way));
  }
  return most;
}
// Whether a vertex that ends the substep at x has to look again.
bool looksBack(uint vertex, vec3 x) {
  vec4 looked = contacts[sightAt(vertex, kLooked)];
  return isAstray(looked, x) || (seesPlanes(looked) && touchOf(vertex, x).gap < lookMargin());
}
