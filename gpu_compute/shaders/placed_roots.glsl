// Where roots move in the substeps of a dispatch, without bodies: the invocations of a strand work out THREADS substeps at once, one each,
// and share them. Needs rod_strand.glsl and root_motion.glsl.
shared vec4 root_position[WORKGROUP];  // w: x, y, z of the jump
shared vec4 root_tangent[WORKGROUP];
shared vec4 root_swing[WORKGROUP];
shared vec4 root_frame[WORKGROUP];
#if DAMPED
shared float root_spin[WORKGROUP];
#endif
#if PINNED || GROOMED
shared vec4 root_rotation[WORKGROUP];
#endif

// For the substeps from `first` on.
void placeRoots(int first) {
  barrier();  // nobody reads those before any more
  const int substep = first + rank;
  if (substep < end_substep) {
    const RootMotion root =
        motionOfRoot(rootPoses(strand), substep, substep - first_substep, positions[root_vertex].xyz, velocities[root_vertex].xyz);
    root_position[me] = vec4(root.position, root.jump.x);
    root_tangent[me] = vec4(root.tangent_old, root.jump.y);
    root_swing[me] = vec4(root.swing, root.jump.z);
    root_frame[me] = root.inner_frame;
#if DAMPED
    root_spin[me] = root.spin;
#endif
#if PINNED || GROOMED
    root_rotation[me] = root.rotation;
#endif
  }
  barrier();
}

// Of the substep that is `ahead` of the first of those placed last and ends at `time`.
RootMotion placedRoot(int ahead, float time) {
  const uint at = me - uint(rank) + uint(ahead);
  const vec4 a = root_position[at], b = root_tangent[at], c = root_swing[at];
  RootMotion root;
  root.position = a.xyz;
  root.jump = vec3(a.w, b.w, c.w);
  root.tangent_old = b.xyz;
  root.swing = c.xyz;
  root.inner_frame = root_frame[at];
  root.time = time;
#if PINNED || GROOMED
  root.rotation = root_rotation[at];
#else
  root.rotation = vec4(0, 0, 0, 1);
#endif
#if DAMPED
  root.spin = root_spin[at];
#else
  root.spin = 0.0;
#endif
  return root;
}
