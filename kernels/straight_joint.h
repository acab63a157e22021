// Kernel text: see kernels/README.md. Joints of a strand that is straight at rest and free at its tip, without material frames: they bend
// alike in every direction, and as twist has no inertia, frames go along the strand without twist but for what internal damping does.
// What comes out is what kernels/rod.h gives, which works in the frame of the joint's inner edge; here all is in the world. t_in, t: unit
// tangents of the inner edge and the outer one; swing_in, swing: how they change in a substep, at right angles to them.

// See jointStrain().
FN real3 straightStrain(IN(real3) t_in, IN(real3) t) {
  real inverse_cosine = inverseSqrt(max(lit(0.5) * (lit(1) + dot(t_in, t)), lit(1e-6)));  // of half the angle
  return cross(t_in, t) * (inverse_cosine * min(inverse_cosine, lit(5)));
}

// By what angle more than the inner edge the outer one spins about itself, so that there is no twist between them (Bergou and others
// 2008, gradient of holonomy).
FN real straightSpin(IN(real3) t_in, IN(real3) t, IN(real3) swing_in, IN(real3) swing) {
  return dot(cross(t, t_in), swing_in + swing) * inverse(max(lit(1) + dot(t_in, t), lit(1e-3)));
}

// What gainedStrain() and twistedStrain() give, turned a quarter back: they are t_in x this. The swing of the outer edge is taken along the
// smallest rotation from it to the inner one. `spin`: of the edges about themselves, their mean.
FN real3 straightGain(IN(real3) strain, IN(real3) t_in, IN(real3) t, IN(real3) swing_in, IN(real3) swing, IN(real) spin) {
  real along = dot(swing, t_in) * inverse(max(lit(1) + dot(t_in, t), lit(1e-3)));
  return swing - (t_in + t) * along - swing_in - strain * spin;
}

// See torqueDifference(); `damped`: bend x damping time in substeps.
FN real straightTorque(IN(real3) strain, IN(real3) gain, IN(real) damped) { return lit(0.5) * damped * dot(strain, gain); }

// See jointMoment(). `torque`: straightTorque() of this joint, `beyond`: of all after it.
FN real3 straightMoment(IN(real3) strain, IN(real3) gain, IN(real3) t_in, IN(real) bend, IN(real) damped, IN(real) torque,
                        IN(real) beyond) {
  real twisting = torque + lit(2) * beyond;  // the moment about the inner edge, before it bends
  return strain * bend + cross(t_in, gain * damped - strain * (lit(0.5) * twisting)) + t_in * (twisting + torque);
}
