// Kernel text: see kernels/README.md. Light scattered by a hair fibre. For scalar lanes only: it uses exp, log, sin, cos.
//
// theta: inclination from the normal plane, positive towards the tip; phi = phi_o - phi_i; h: -1 to 1 across the fibre.
// Lobes are numbered by p, the count of passages through the interior: R 0, TT 1, TRT 2, and all longer paths together
// 3. docs/light.md has the conventions. Sources: Marschner et al. 2003, "Light Scattering from Human Hair Fibers";
// d'Eon et al. 2011, "An Energy-Conserving Hair Reflectance Model"; Chiang et al. 2016, "A Practical and Controllable
// Hair and Fur Model for Production Path Tracing".

// GLSL drivers have errors of 5 to 31 % in log near 1 and up to 4e-4 in asin, so this text has its own.
//
// Natural logarithm of a positive number: the driver's value, refined by one step of Halley's method.
LANE_FN real fibreLog(LANE_IN(real) a) {
  real guess = log(a);
  real e = exp(guess);
  return guess + lit(2) * (a - e) / (a + e);
}
// Angle of the vector (x, y), -pi to pi; 0 for the zero vector. Error below 1e-10. The polynomial is a minimax fit of
// atan(t) / t for t up to tan(pi / 8).
LANE_FN real fibreAtan(LANE_IN(real) y, LANE_IN(real) x) {
  real ax = abs(x);
  real ay = abs(y);
  real high = max(ax, ay);
  real low = min(ax, ay);
  mask steep = low > lit(0.41421356237309505) * high;
  real t = select(steep, low - high, low) / max(select(steep, low + high, high), lit(1e-30));
  real u = t * t;
  real p = lit(0.0471865221642);
  p = p * u - lit(0.0846202000336);
  p = p * u + lit(0.110416160397);
  p = p * u - lit(0.142816892497);
  p = p * u + lit(0.199998879091);
  p = p * u - lit(0.333333321574);
  p = p * u + lit(0.99999999998);
  real angle = select(steep, lit(0.7853981633974483), lit(0)) + t * p;
  angle = select(ay > ax, lit(1.5707963267948966) - angle, angle);
  angle = select(x < lit(0), lit(3.141592653589793) - angle, angle);
  return select(y < lit(0), lit(0) - angle, angle);
}
LANE_FN real fibreAsin(LANE_IN(real) s) { return fibreAtan(s, sqrt(max((lit(1) - s) * (lit(1) + s), lit(0)))); }
// The angle within -pi to pi that differs by whole turns.
LANE_FN real wrappedAngle(LANE_IN(real) a) { return a - lit(6.283185307179586) * floor(a * lit(0.15915494309189535) + lit(0.5)); }

// Modified Bessel function I0 of x, 0 or more: a polynomial up to 5, and beyond, one for sqrt(x) exp(-x) I0(x) in 1/x.
// Both are minimax fits, with relative errors below 2e-10 and 3e-8.
LANE_FN real besselI0Small(LANE_IN(real) x) {
  real u = x * x;
  real p = lit(1.28562195327e-14);
  p = p * u + lit(2.249225093e-12);
  p = p * u + lit(4.74464356024e-10);
  p = p * u + lit(6.7771438004e-08);
  p = p * u + lit(6.7820175082e-06);
  p = p * u + lit(0.000434026454373);
  p = p * u + lit(0.0156250025041);
  p = p * u + lit(0.249999998291);
  return p * u + lit(1.00000000018);
}
LANE_FN real besselI0Large(LANE_IN(real) x) {
  real u = lit(1) / x;
  real p = lit(-26.1979933332);
  p = p * u + lit(16.4073772899);
  p = p * u - lit(3.47733095618);
  p = p * u + lit(0.425875910905);
  p = p * u + lit(0.00852435120765);
  p = p * u + lit(0.0285833634101);
  p = p * u + lit(0.0498626525456);
  return (p * u + lit(0.39894228847)) * sqrt(u);
}
// exp(-x) I0(x)
LANE_FN real besselI0Scaled(LANE_IN(real) x) {
  return select(x < lit(5), exp(lit(0) - x) * besselI0Small(min(x, lit(5))), besselI0Large(max(x, lit(5))));
}
// log I0(x)
LANE_FN real logBesselI0(LANE_IN(real) x) {
  return select(x < lit(5), fibreLog(besselI0Small(min(x, lit(5)))), x + fibreLog(besselI0Large(max(x, lit(5)))));
}

// Longitudinal function M of d'Eon et al. 2011, equation 7: its integral over theta_i with cos(theta_i) is 1 for every
// theta_o. `variance`: v. Written with the squared chord between theta_i and -theta_o, which loses no digits where v is
// small: M = exp(-chord^2 / 2v) I0e(cos cos / v) / (v (1 - exp(-2 / v))).
LANE_FN real longitudinalFunction(LANE_IN(real) sin_i, LANE_IN(real) cos_i, LANE_IN(real) sin_o, LANE_IN(real) cos_o,
                                  LANE_IN(real) variance) {
  real along = sin_i + sin_o;
  real across = cos_i - cos_o;
  real chord2 = along * along + across * across;
  return exp(lit(-0.5) * chord2 / variance) * besselI0Scaled(cos_i * cos_o / variance) /
         (variance * (lit(1) - exp(lit(-2) / variance)));
}

// Logistic distribution of scale s, trimmed to -pi to pi: azimuthal roughness (Chiang et al. 2016).
LANE_FN real trimmedLogistic(LANE_IN(real) angle, LANE_IN(real) s) {
  real e = exp(lit(0) - abs(angle) / s);
  real ends = exp(lit(-3.141592653589793) / s);
  return e / (s * (lit(1) + e) * (lit(1) + e)) * ((lit(1) + ends) / (lit(1) - ends));
}

// Its quantile at u, 0 to 1.
LANE_FN real trimmedLogisticQuantile(LANE_IN(real) u, LANE_IN(real) s) {
  real low = lit(1) / (lit(1) + exp(lit(3.141592653589793) / s));
  real range = lit(1) - lit(2) * low;
  real angle = s * fibreLog((low + u * range) / (low + (lit(1) - u) * range));
  return clamp(angle, lit(-3.141592653589793), lit(3.141592653589793));
}

// Reflectance of the surface of a dielectric for unpolarised light from outside (Fresnel). `cosine`: of the angle of
// incidence, 0 to 1; `index`: 1 or more.
LANE_FN real fresnelReflectance(LANE_IN(real) cosine, LANE_IN(real) index) {
  real inside = sqrt(max(index * index - (lit(1) - cosine * cosine), lit(0)));  // index times the refracted cosine
  real parallel = index * index * cosine;
  real rp = (parallel - inside) / max(parallel + inside, lit(1e-20));
  real rs = (cosine - inside) / max(cosine + inside, lit(1e-20));
  return lit(0.5) * (rp * rp + rs * rs);
}

// What the lobes of a fibre have in common for all directions.
struct FibreShape {
  real variance;             // longitudinal, of R
  real scale;                // of the azimuthal logistic distribution
  real index;                // of refraction
  real3 tilt_sin, tilt_cos;  // sines and cosines of what tilt adds to theta_o, for R, TT, TRT
};
// Perceptual roughnesses 0.001 to 1 to variance and scale: Chiang et al. 2016, equations 7 and 8. `tilt`, rad: the
// scales shift R, TT, TRT by -2, +1 and +4 times the tilt, in theta_i + theta_o.
LANE_FN real longitudinalVariance(LANE_IN(real) roughness) {
  real r4 = roughness * roughness * roughness * roughness;
  real root = lit(0.726) * roughness + lit(0.812) * roughness * roughness + lit(3.7) * r4 * r4 * r4 * r4 * r4;
  return root * root;
}
LANE_FN real logisticScale(LANE_IN(real) roughness) {
  real r2 = roughness * roughness;
  real r10 = r2 * r2 * r2 * r2 * r2;
  return lit(0.6266570686577501) * (lit(0.265) * roughness + lit(1.194) * r2 + lit(5.372) * r10 * r10 * r2);
}
LANE_FN FibreShape fibreShape(LANE_IN(real) longitudinal_roughness, LANE_IN(real) azimuthal_roughness, LANE_IN(real) tilt,
                              LANE_IN(real) index) {
  FibreShape shape;
  shape.variance = longitudinalVariance(longitudinal_roughness);
  shape.scale = logisticScale(azimuthal_roughness);
  shape.index = index;
  shape.tilt_sin = makeReal3(sin(lit(2) * tilt), sin(lit(0) - tilt), sin(lit(-4) * tilt));
  shape.tilt_cos = makeReal3(cos(lit(2) * tilt), cos(tilt), cos(lit(4) * tilt));
  return shape;
}

// Longitudinal variance of lobe p.
LANE_FN real lobeVariance(LANE_IN(FibreShape) shape, LANE_IN(real) p) {
  return shape.variance * select(p == lit(0), lit(1), select(p == lit(1), lit(0.25), lit(4)));
}

// The path of a ray that meets the fibre at h with inclination theta.
struct FibreRay {
  real gamma_o, gamma_t;  // azimuths of incidence and refraction in the normal plane
  real fresnel;           // reflectance of the surface, outside and inside
  real passage;           // length of one passage through the interior, in radii
};
// In the normal plane a fibre refracts with the index sqrt(index^2 - sin^2 theta) / cos theta (Bravais; Marschner et al.
// 2003, section 4.1).
LANE_FN FibreRay fibreRay(LANE_IN(real) sin_theta, LANE_IN(real) cos_theta, LANE_IN(real) h, LANE_IN(real) index) {
  real inside = sqrt(max(index * index - sin_theta * sin_theta, lit(1e-12)));  // index times cos theta_t
  real sin_t = clamp(h * cos_theta / inside, lit(-1), lit(1));
  real cos_gamma = sqrt(max((lit(1) - h) * (lit(1) + h), lit(0)));
  FibreRay ray;
  ray.gamma_o = fibreAsin(h);
  ray.gamma_t = fibreAsin(sin_t);
  ray.fresnel = fresnelReflectance(cos_theta * cos_gamma, index);
  ray.passage = lit(2) * sqrt((lit(1) - sin_t) * (lit(1) + sin_t)) * index / inside;
  return ray;
}
// Azimuth phi of a path without roughness: 2 p gamma_t - 2 gamma_o + p pi.
LANE_FN real fibreAzimuth(LANE_IN(FibreRay) ray, LANE_IN(real) p) {
  return lit(2) * (p * ray.gamma_t - ray.gamma_o) + p * lit(3.141592653589793);
}

// One number per lobe.
struct FibreLobes {
  real r, tt, trt, residual;
};
// Shares of the light by lobe: Chiang et al. 2016, equations 12 to 15. `transmittance`: of one passage. They sum to 1
// where it is 1.
LANE_FN FibreLobes fibreShares(LANE_IN(real) fresnel, LANE_IN(real) transmittance) {
  FibreLobes share;
  share.r = fresnel;
  share.tt = (lit(1) - fresnel) * (lit(1) - fresnel) * transmittance;
  share.trt = share.tt * fresnel * transmittance;
  share.residual = share.trt * fresnel * transmittance / max(lit(1) - fresnel * transmittance, lit(1e-20));
  return share;
}
LANE_FN real fibreSum(LANE_IN(FibreLobes) a, LANE_IN(FibreLobes) b) {
  return a.r * b.r + a.tt * b.tt + a.trt * b.trt + a.residual * b.residual;
}

// M of each lobe. `spread`: variance of the light's inclination, which adds to that of the lobes.
LANE_FN FibreLobes fibreLongitudinal(LANE_IN(FibreShape) shape, LANE_IN(real) spread, LANE_IN(real) sin_o, LANE_IN(real) cos_o,
                                     LANE_IN(real) sin_i, LANE_IN(real) cos_i) {
  real3 sines = shape.tilt_cos * sin_o + shape.tilt_sin * cos_o;
  real3 cosines = shape.tilt_cos * cos_o - shape.tilt_sin * sin_o;
  FibreLobes m;
  m.r = longitudinalFunction(sin_i, cos_i, sines.x, abs(cosines.x), lobeVariance(shape, lit(0)) + spread);
  m.tt = longitudinalFunction(sin_i, cos_i, sines.y, abs(cosines.y), lobeVariance(shape, lit(1)) + spread);
  m.trt = longitudinalFunction(sin_i, cos_i, sines.z, abs(cosines.z), lobeVariance(shape, lit(2)) + spread);
  m.residual = longitudinalFunction(sin_i, cos_i, sin_o, cos_o, lobeVariance(shape, lit(3)) + spread);
  return m;
}
// M N of each lobe at one h, per solid angle of wi: densities whose integrals are 1.
LANE_FN FibreLobes fibreDensities(LANE_IN(FibreShape) shape, LANE_IN(FibreRay) ray, LANE_IN(real) sin_o, LANE_IN(real) cos_o,
                                  LANE_IN(real) sin_i, LANE_IN(real) cos_i, LANE_IN(real) phi) {
  FibreLobes d = fibreLongitudinal(shape, lit(0), sin_o, cos_o, sin_i, cos_i);
  d.r = d.r * trimmedLogistic(wrappedAngle(phi - fibreAzimuth(ray, lit(0))), shape.scale);
  d.tt = d.tt * trimmedLogistic(wrappedAngle(phi - fibreAzimuth(ray, lit(1))), shape.scale);
  d.trt = d.trt * trimmedLogistic(wrappedAngle(phi - fibreAzimuth(ray, lit(2))), shape.scale);
  d.residual = d.residual * lit(0.15915494309189535);
  return d;
}
