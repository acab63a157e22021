// Kernel text: see kernels/README.md. Needs fibre.h. Light of one colour from one direction that hair scatters to the
// eye: Dual Scattering (Zinke, Yuksel, Weber, Keyser 2008), equation 22.
//
// Results include the cosine of the light's inclination: radiance is the result times the light's irradiance
// perpendicular to its direction.

// Light that reaches a point in hair.
struct DualLight {
  real direct;     // share that no hair has met
  real scattered;  // share that hair before the point has scattered forward: (T_f - direct) d_f
  real variance;   // of the scattered light's inclination, rad^2
};
// What the hair around a point scatters back: f_back, equation 10.
struct DualLocal {
  real attenuation;  // times the density factor d_b
  real shift;        // rad
  real variance;     // rad^2
};

// f_back cos(theta_i). The paper's Gaussian over the cosine is the longitudinal function M, whose integral with the cosine
// is 1. `spread`: variance of the light.
LANE_FN real scatteredBack(LANE_IN(DualLocal) local, LANE_IN(real) spread, LANE_IN(real) sin_o, LANE_IN(real) cos_o,
                           LANE_IN(real) sin_i, LANE_IN(real) cos_i) {
  real s = sin(local.shift);
  real c = cos(local.shift);
  real m = longitudinalFunction(sin_i, cos_i, sin_o * c - cos_o * s, abs(cos_o * c + sin_o * s), local.variance + spread);
  return lit(0.6366197723675814) * local.attenuation * m;
}

// Scattered by the fibre alone, by hair towards the light before, and by the hair around.
struct DualParts {
  real single, global, local;
};
// `azimuthal`: N of each lobe; `half_turn`: N^G, the mean of N over the half turn from which scattered light comes
// (equation 25). Figure 5 has a factor pi in the last term, which equation 22 does not: it is left out.
LANE_FN DualParts dualScattering(LANE_IN(FibreShape) shape, LANE_IN(FibreLobes) azimuthal, LANE_IN(FibreLobes) half_turn,
                                 LANE_IN(DualLocal) local, LANE_IN(DualLight) light, LANE_IN(real) sin_o, LANE_IN(real) cos_o,
                                 LANE_IN(real) sin_i, LANE_IN(real) cos_i) {
  DualParts parts;
  parts.single = light.direct * fibreSum(fibreLongitudinal(shape, lit(0), sin_o, cos_o, sin_i, cos_i), azimuthal);
  parts.global = light.scattered * fibreSum(fibreLongitudinal(shape, light.variance, sin_o, cos_o, sin_i, cos_i), half_turn);
  parts.local = light.direct * scatteredBack(local, lit(0), sin_o, cos_o, sin_i, cos_i) +
                light.scattered * scatteredBack(local, light.variance, sin_o, cos_o, sin_i, cos_i);
  return parts;
}
