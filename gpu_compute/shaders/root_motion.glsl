// How a strand's root moves in each substep. The invocations of a strand work out THREADS substeps at once, one each, and
// share them. Needs rod_strand.glsl and root_poses.glsl.

struct RootMotion {
  vec3 position;     // m, at the end of the substep
  vec3 jump;         // m, unexpected motion
  vec3 tangent_old;  // of the root before the substep
  vec3 swing;        // how it changes
  vec4 inner_frame;  // of the root, without the swing of this substep
  float spin;        // radians, of the root about its tangent in the substep
  float time;        // part of the step that has passed at the end of the substep
  vec4 rotation;     // at the end of the substep, for what rides on the root
};

// Among bodies a dispatch does one substep.
#if BODIES
const uint kRootsPlaced = kStrands;
uint placedRoot(uint ahead) { return me / uint(THREADS); }
#else
const uint kRootsPlaced = uint(WORKGROUP);
uint placedRoot(uint ahead) { return me - uint(rank) + ahead; }
#endif
shared vec4 root_position[kRootsPlaced];  // w: x, y, z of the jump
shared vec4 root_tangent[kRootsPlaced];
shared vec4 root_swing[kRootsPlaced];
shared vec4 root_frame[kRootsPlaced];
#if DAMPED
shared float root_spin[kRootsPlaced];
#endif
#if PINNED || GROOMED
shared vec4 root_rotation[kRootsPlaced];
#endif

// For the substeps from `first` on.
void placeRoots(int first) {
  barrier();  // nobody reads those before any more
  int substep = first + rank;
  if (substep < end_substep) {
    const RootPoses poses = rootPoses(strand);
    const Pose begin = poses.begin, end = poses.end;
    vec3 way = end.position - begin.position, start = positions[root_vertex].xyz;
    vec3 position = madd(way, timeAfter(substep), begin.position);
    int done = substep - first_substep;  // in this dispatch
    vec3 last = done > 0 ? madd(way, timeAfter(substep - 1), begin.position) : start;
    vec3 one_more = done > 1 ? madd(way, timeAfter(substep - 2), begin.position) : start;
    vec3 velocity = done > 0 ? (last - one_more) * settings.per_substep : velocities[root_vertex].xyz;
    vec3 jump = position - madd(velocity, settings.substep, last);
    vec4 rotation = interpolateRotation(begin.rotation, end.rotation, timeAfter(substep));
    vec4 old = substep > 0 ? interpolateRotation(begin.rotation, end.rotation, timeAfter(substep - 1)) : begin.rotation;
    vec3 tangent = frameTangent(rotation), tangent_old = frameTangent(old);
    const uint at = placedRoot(uint(rank));
    root_position[at] = vec4(position, jump.x);
    root_tangent[at] = vec4(tangent_old, jump.y);
    root_swing[at] = vec4(tangent - tangent_old, jump.z);
    const vec4 inner_frame = multiply(rotationBetween(tangent, tangent_old), rotation);
    root_frame[at] = inner_frame;
#if DAMPED
    root_spin[at] = spinBetween(old, inner_frame);
#endif
#if PINNED || GROOMED
    root_rotation[at] = rotation;
#endif
  }
  barrier();
}

// Of the substep that is `ahead` of the first of those placed last and ends at `time`.
RootMotion rootMotion(int ahead, float time) {
  const uint at = placedRoot(uint(ahead));
  vec4 a = root_position[at], b = root_tangent[at], c = root_swing[at];
#if PINNED || GROOMED
  vec4 rotation = root_rotation[at];
#else
  const vec4 rotation = vec4(0, 0, 0, 1);
#endif
#if DAMPED
  const float spin = root_spin[at];
#else
  const float spin = 0.0;
#endif
  return RootMotion(a.xyz, vec3(a.w, b.w, c.w), b.xyz, c.xyz, root_frame[at], spin, time, rotation);
}
