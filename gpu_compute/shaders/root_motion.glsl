// How a strand's root moves in each substep. Needs kernels/rod.h, step_input.glsl and root_poses.glsl.

struct RootMotion {
  vec3 position;     // m, at the end of the substep
  vec3 jump;         // m, unexpected motion
  vec3 tangent_old;  // of the root before the substep
  vec4 rotation;     // at the end of the substep
  float spin;        // radians, of the root about its tangent in the substep
  vec3 swing;        // how its tangent changes
  vec4 inner_frame;  // of the root, without the swing of this substep
  float time;        // part of the step that has passed at the end of the substep
};

// What follows from the others.
void findSwing(inout RootMotion root) {
  const vec3 tangent = frameTangent(root.rotation);
  root.swing = tangent - root.tangent_old;
  root.inner_frame = multiply(rotationBetween(tangent, root.tangent_old), root.rotation);
}

// In a substep, of which `done` in a row have gone before since the root was at `start` with this velocity.
RootMotion motionOfRoot(RootPoses poses, int substep, int done, vec3 start, vec3 velocity) {
  const Pose begin = poses.begin, end = poses.end;
  const vec3 way = end.position - begin.position;
  RootMotion root;
  root.time = timeAfter(substep);
  root.position = madd(way, root.time, begin.position);
  const vec3 last = done > 0 ? madd(way, timeAfter(substep - 1), begin.position) : start;
  const vec3 one_more = done > 1 ? madd(way, timeAfter(substep - 2), begin.position) : start;
  const vec3 going = done > 0 ? (last - one_more) * settings.per_substep : velocity;
  root.jump = root.position - madd(going, settings.substep, last);
  root.rotation = interpolateRotation(begin.rotation, end.rotation, root.time);
  const vec4 old = substep > 0 ? interpolateRotation(begin.rotation, end.rotation, timeAfter(substep - 1)) : begin.rotation;
  root.tangent_old = frameTangent(old);
  findSwing(root);
  root.spin = spinBetween(old, root.inner_frame);
  return root;
}
