// Kernel text: see kernels/README.md. Joints of a strand that is straight at rest, has no pin but the root and carries
// no material frames. Such a strand bends alike in every direction. Twist has no inertia, so its frames would follow
// the strand without twist, except for internal damping. Results equal those of kernels/rod.h, which works in the frame
// of the joint's inner edge; here all vectors are in the world frame. t_in, t: unit tangents of the inner and the outer
// edge; swing_in, swing: their changes in the substep, perpendicular to them.

// Bending strain, world; see jointStrain().
FN real3 straightStrain(IN(real3) t_in, IN(real3) t) {
  real inverse_cosine = inverseSqrt(max(lit(0.5) * (lit(1) + dot(t_in, t)), lit(1e-6)));  // of half the angle
  return cross(t_in, t) * (inverse_cosine * min(inverse_cosine, lit(5)));
}

// Angle, radians, by which the outer edge must rotate about itself more than the inner one so that there is no twist
// between them (Bergou et al. 2008, gradient of holonomy).
FN real straightSpin(IN(real3) t_in, IN(real3) t, IN(real3) swing_in, IN(real3) swing) {
  return dot(cross(t, t_in), swing_in + swing) * inverse(max(lit(1) + dot(t_in, t), lit(1e-3)));
}

// Strain gained by gainedStrain() and twistedStrain(), rotated back by a quarter turn: t_in x result. The swing of the
// outer edge is carried by the shortest rotation from it to the inner one. `spin`: mean rotation of the two edges about
// themselves, radians.
FN real3 straightGain(IN(real3) strain, IN(real3) t_in, IN(real3) t, IN(real3) swing_in, IN(real3) swing, IN(real) spin) {
  real along = dot(swing, t_in) * inverse(max(lit(1) + dot(t_in, t), lit(1e-3)));
  return swing - (t_in + t) * along - swing_in - strain * spin;
}

// See torqueDifference(). `damped`: bend x damping time in substeps.
FN real straightTorque(IN(real3) strain, IN(real3) gain, IN(real) damped) { return lit(0.5) * damped * dot(strain, gain); }

// See jointMoment(). `torque`: straightTorque() of this joint; `beyond`: sum over all joints after it.
FN real3 straightMoment(IN(real3) strain, IN(real3) gain, IN(real3) t_in, IN(real) bend, IN(real) damped, IN(real) torque,
                        IN(real) beyond) {
  real twisting = torque + lit(2) * beyond;  // moment about the inner edge before it bends
  return strain * bend + cross(t_in, gain * damped - strain * (lit(0.5) * twisting)) + t_in * (twisting + torque);
}
