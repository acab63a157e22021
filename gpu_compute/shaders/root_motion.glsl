// Motion of a strand's root in a substep. Requires kernels/rod.h and step_input.glsl.

struct RootMotion {
  vec3 position;     // m, at the end of the substep
  vec3 jump;         // m, difference of the position to going on at the last velocity
  vec3 tangent_old;  // of the root frame at the start of the substep, unit
  vec4 rotation;     // at the end of the substep
  float spin;        // radians, rotation of the root frame about its tangent in the substep
  vec3 swing;        // change of the tangent in the substep
  vec4 inner_frame;  // root frame at the end of the substep, swung back to tangent_old
  float time;        // fraction of the step that has passed at the end of the substep
};

// Computes `swing` and `inner_frame` from `rotation` and `tangent_old`.
void computeSwing(inout RootMotion root) {
  const vec3 tangent = frameTangent(root.rotation);
  root.swing = tangent - root.tangent_old;
  root.inner_frame = multiply(rotationBetween(tangent, root.tangent_old), root.rotation);
}

// Motion in a substep. `done`: substeps of this step since the root was stored, at `start` (m) with `velocity` (m/s).
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
  computeSwing(root);
  root.spin = spinBetween(old, root.inner_frame);
  return root;
}
