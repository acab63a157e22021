// Root motion in the substeps of a dispatch without bodies. The invocations of a strand compute the motion of THREADS
// substeps at once, one substep each, and share them. Requires rod_strand.glsl and root_motion.glsl.
shared vec4 root_position[WORKGROUP];  // w of this and the next two: x, y, z of the jump
shared vec4 root_tangent[WORKGROUP];
shared vec4 root_swing[WORKGROUP];
shared vec4 root_frame[WORKGROUP];
#if DAMPED
shared float root_spin[WORKGROUP];
#endif
#if PINNED || GROOMED
shared vec4 root_rotation[WORKGROUP];
#endif

// Computes the root motion of the THREADS substeps from `first` on. All invocations of the workgroup must call it.
void placeRoots(int first) {
  barrier();  // all have read the previous substeps' motion
  const int substep = first + rank;
  if (substep < end_substep) {
    const RootMotion root = motionOfRoot(rootPoses(strand), substep, substep - first_substep, positions[root_vertex].xyz,
                                         velocities[root_vertex].xyz);
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

// Root motion of the substep `ahead` after the first one of the last placeRoots(). `time`: fraction of the step at its end.
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
