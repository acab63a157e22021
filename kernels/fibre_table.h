// Kernel text: see kernels/README.md. Requires kernels/fibre.h, and of the including file FIBRE_TABLE_PARAMETER (a
// parameter that carries the table, with its comma, or nothing), FIBRE_TABLE (the argument for it, likewise) and
// FIBRE_TEXEL(i) (number i of the table, where i is a whole real).
//
// Azimuthal functions N of a fibre, integrated over h, as light/fibre_table.h builds them: a grid of texels of 16 numbers,
// rows at equal steps of cos(theta) from 0 to 1, columns at equal steps of phi from 0 to pi. N is even in phi. Absorption
// is the third axis.
struct FibreTableSize {
  real rows, columns;
  real first;  // number of the table's first texel in the array
};

// TT and TRT: N without absorption, and the mean length of the paths that still carry light at each knot of fibreKnot(),
// with N(sigma) = N exp(-sigma length(sigma)). The length changes slowly, so that four knots hold it.
struct FibrePaths {
  real n, length0, length1, length2, length3;
};
// Paths with more passages, even in phi. Their number of passages varies, so that a mean length would not do: N(sigma) =
// N T^3 (share g(F0) + (1 - share) g(F1)) with T = exp(-sigma passage), the transmittance of one passage. g(F) = (1 - F) /
// (1 - T F) is the geometric series of reflections inside. F0, F1: nodes of Gauss for the distribution of the Fresnel
// reflectance across the fibre.
struct FibreResidual {
  real n, share, fresnel0, fresnel1, passage;
};
struct FibreTexel {
  real r;  // N of R
  FibreResidual residual;
  FibrePaths tt, trt;
};

LANE_FN FibrePaths fibrePathsAt(FIBRE_TABLE_PARAMETER LANE_IN(real) first) {
  FibrePaths p;
  p.n = FIBRE_TEXEL(first);
  p.length0 = FIBRE_TEXEL(first + lit(1));
  p.length1 = FIBRE_TEXEL(first + lit(2));
  p.length2 = FIBRE_TEXEL(first + lit(3));
  p.length3 = FIBRE_TEXEL(first + lit(4));
  return p;
}
LANE_FN FibreTexel fibreTexelAt(FIBRE_TABLE_PARAMETER LANE_IN(real) first) {
  FibreTexel t;
  t.r = FIBRE_TEXEL(first);
  t.residual.n = FIBRE_TEXEL(first + lit(1));
  t.residual.share = FIBRE_TEXEL(first + lit(2));
  t.residual.fresnel0 = FIBRE_TEXEL(first + lit(3));
  t.residual.fresnel1 = FIBRE_TEXEL(first + lit(4));
  t.residual.passage = FIBRE_TEXEL(first + lit(5));
  t.tt = fibrePathsAt(FIBRE_TABLE first + lit(6));
  t.trt = fibrePathsAt(FIBRE_TABLE first + lit(11));
  return t;
}
LANE_FN FibrePaths fibrePathsBetween(LANE_IN(FibrePaths) a, LANE_IN(FibrePaths) b, LANE_IN(real) part) {
  FibrePaths p;
  p.n = a.n + (b.n - a.n) * part;
  p.length0 = a.length0 + (b.length0 - a.length0) * part;
  p.length1 = a.length1 + (b.length1 - a.length1) * part;
  p.length2 = a.length2 + (b.length2 - a.length2) * part;
  p.length3 = a.length3 + (b.length3 - a.length3) * part;
  return p;
}
LANE_FN FibreTexel fibreTexelBetween(LANE_IN(FibreTexel) a, LANE_IN(FibreTexel) b, LANE_IN(real) part) {
  FibreTexel t;
  t.r = a.r + (b.r - a.r) * part;
  t.residual.n = a.residual.n + (b.residual.n - a.residual.n) * part;
  t.residual.share = a.residual.share + (b.residual.share - a.residual.share) * part;
  t.residual.fresnel0 = a.residual.fresnel0 + (b.residual.fresnel0 - a.residual.fresnel0) * part;
  t.residual.fresnel1 = a.residual.fresnel1 + (b.residual.fresnel1 - a.residual.fresnel1) * part;
  t.residual.passage = a.residual.passage + (b.residual.passage - a.residual.passage) * part;
  t.tt = fibrePathsBetween(a.tt, b.tt, part);
  t.trt = fibrePathsBetween(a.trt, b.trt, part);
  return t;
}
// Bilinear interpolation, by own weights: those of texture units have 8 bits.
LANE_FN FibreTexel fibreTexel(FIBRE_TABLE_PARAMETER LANE_IN(FibreTableSize) size, LANE_IN(real) cos_theta, LANE_IN(real) phi) {
  real row = clamp(cos_theta, lit(0), lit(1)) * (size.rows - lit(1));
  real column = min(abs(phi) * lit(0.3183098861837907), lit(1)) * (size.columns - lit(1));
  real row0 = min(floor(row), size.rows - lit(2));
  real column0 = min(floor(column), size.columns - lit(2));
  real first = (size.first + row0 * size.columns + column0) * lit(16);
  real next = first + size.columns * lit(16);
  real part = column - column0;
  return fibreTexelBetween(fibreTexelBetween(fibreTexelAt(FIBRE_TABLE first), fibreTexelAt(FIBRE_TABLE first + lit(16)), part),
                           fibreTexelBetween(fibreTexelAt(FIBRE_TABLE next), fibreTexelAt(FIBRE_TABLE next + lit(16)), part),
                           row - row0);
}

// Place among the knots, 0 to 3, of the absorption per radius: 0, 2/3, 2 and 6. Constant beyond the last, where 1e-4 of
// the light is left.
LANE_FN real fibreKnot(LANE_IN(real) sigma) { return lit(4) * min(sigma, lit(6)) / (lit(2) + min(sigma, lit(6))); }
LANE_FN real fibrePaths(LANE_IN(FibrePaths) p, LANE_IN(real) sigma, LANE_IN(real) knot) {
  real mean = p.length0 + (p.length1 - p.length0) * clamp(knot, lit(0), lit(1)) +
              (p.length2 - p.length1) * clamp(knot - lit(1), lit(0), lit(1)) +
              (p.length3 - p.length2) * clamp(knot - lit(2), lit(0), lit(1));
  return p.n * exp(lit(0) - sigma * mean);
}
LANE_FN real fibreResidual(LANE_IN(FibreResidual) p, LANE_IN(real) sigma) {
  real t = exp(lit(0) - sigma * p.passage);
  real g0 = (lit(1) - p.fresnel0) / max(lit(1) - t * p.fresnel0, lit(1e-6));
  real g1 = (lit(1) - p.fresnel1) / max(lit(1) - t * p.fresnel1, lit(1e-6));
  return p.n * t * t * t * (g1 + (g0 - g1) * p.share);
}
// N of each lobe at the absorption sigma per radius.
LANE_FN FibreLobes fibreAzimuthal(LANE_IN(FibreTexel) t, LANE_IN(real) sigma) {
  real knot = fibreKnot(sigma);
  FibreLobes n;
  n.r = t.r;
  n.tt = fibrePaths(t.tt, sigma, knot);
  n.trt = fibrePaths(t.trt, sigma, knot);
  n.residual = fibreResidual(t.residual, sigma);
  return n;
}

// Far field of Chiang's model: f cos(theta_i), the mean over h. `sigma`: absorption per radius of each channel.
LANE_FN real3 chiangFarField(FIBRE_TABLE_PARAMETER LANE_IN(FibreTableSize) size, LANE_IN(FibreShape) shape, LANE_IN(real) sin_o,
                             LANE_IN(real) cos_o, LANE_IN(real) sin_i, LANE_IN(real) cos_i, LANE_IN(real) phi,
                             LANE_IN(real3) sigma) {
  FibreTexel texel = fibreTexel(FIBRE_TABLE size, cos_o, phi);
  FibreLobes m = fibreLongitudinal(shape, lit(0), sin_o, cos_o, sin_i, cos_i);
  return makeReal3(fibreSum(m, fibreAzimuthal(texel, sigma.x)), fibreSum(m, fibreAzimuthal(texel, sigma.y)),
                   fibreSum(m, fibreAzimuthal(texel, sigma.z)));
}

// Model of Marschner et al. 2003. Shifts alpha and widths beta of R, TT and TRT, rad, in theta_h = (theta_i + theta_o) / 2.
struct MarschnerLobes {
  real3 shift, width;
};
// M: a Gaussian in theta_h, whose integral over theta_i is 1.
LANE_FN real marschnerLongitudinal(LANE_IN(real) theta_h, LANE_IN(real) shift, LANE_IN(real) width) {
  real off = (theta_h - shift) / width;
  return lit(0.19947114020071635) * exp(lit(-0.5) * off * off) / width;
}
LANE_FN FibreLobes marschnerLongitudinals(LANE_IN(MarschnerLobes) lobes, LANE_IN(real) theta_h) {
  FibreLobes m;
  m.r = marschnerLongitudinal(theta_h, lobes.shift.x, lobes.width.x);
  m.tt = marschnerLongitudinal(theta_h, lobes.shift.y, lobes.width.y);
  m.trt = marschnerLongitudinal(theta_h, lobes.shift.z, lobes.width.z);
  m.residual = lit(0);
  return m;
}
// cos(theta_d)^2, theta_d = (theta_o - theta_i) / 2
LANE_FN real cosineOfDifference2(LANE_IN(real) sin_o, LANE_IN(real) cos_o, LANE_IN(real) sin_i, LANE_IN(real) cos_i) {
  return max(lit(0.5) * (lit(1) + cos_o * cos_i + sin_o * sin_i), lit(1e-6));
}
// S = sum of M N / cos^2(theta_d), equation 8, of a round fibre.
LANE_FN real3 marschnerFarField(FIBRE_TABLE_PARAMETER LANE_IN(FibreTableSize) size, LANE_IN(MarschnerLobes) lobes,
                                LANE_IN(real) sin_o, LANE_IN(real) cos_o, LANE_IN(real) sin_i, LANE_IN(real) cos_i,
                                LANE_IN(real) phi, LANE_IN(real3) sigma) {
  real cos2_d = cosineOfDifference2(sin_o, cos_o, sin_i, cos_i);
  FibreTexel texel = fibreTexel(FIBRE_TABLE size, sqrt(cos2_d), phi);
  FibreLobes m = marschnerLongitudinals(lobes, lit(0.5) * (fibreAtan(sin_o, cos_o) + fibreAtan(sin_i, cos_i)));
  return makeReal3(fibreSum(m, fibreAzimuthal(texel, sigma.x)), fibreSum(m, fibreAzimuthal(texel, sigma.y)),
                   fibreSum(m, fibreAzimuthal(texel, sigma.z))) *
         (lit(1) / cos2_d);
}
// The same of an elliptic fibre, section 5.2.3 of the paper: R and TT are those of a round one; TRT bends by an
// index that depends on phi_h = (phi_i + phi_o) / 2 from the major axis. Five further tables of TRT follow the round
// one at equal steps of cos(2 phi_h) from -1 to 1.
LANE_FN real3 marschnerEllipticFarField(FIBRE_TABLE_PARAMETER LANE_IN(FibreTableSize) size, LANE_IN(MarschnerLobes) lobes,
                                        LANE_IN(real) sin_o, LANE_IN(real) cos_o, LANE_IN(real) sin_i, LANE_IN(real) cos_i,
                                        LANE_IN(real) phi, LANE_IN(real) cos_2phi_h, LANE_IN(real3) sigma) {
  real cos2_d = cosineOfDifference2(sin_o, cos_o, sin_i, cos_i);
  real place = lit(2) + lit(2) * clamp(cos_2phi_h, lit(-1), lit(1));
  real low = min(floor(place), lit(3));
  FibreTableSize near = size;
  near.first = size.first + (low + lit(1)) * size.rows * size.columns;
  FibreTableSize next = near;
  next.first = near.first + size.rows * size.columns;
  real cos_d = sqrt(cos2_d);
  FibreTexel texel = fibreTexel(FIBRE_TABLE size, cos_d, phi);
  texel.trt =
      fibrePathsBetween(fibreTexel(FIBRE_TABLE near, cos_d, phi).trt, fibreTexel(FIBRE_TABLE next, cos_d, phi).trt, place - low);
  FibreLobes m = marschnerLongitudinals(lobes, lit(0.5) * (fibreAtan(sin_o, cos_o) + fibreAtan(sin_i, cos_i)));
  return makeReal3(fibreSum(m, fibreAzimuthal(texel, sigma.x)), fibreSum(m, fibreAzimuthal(texel, sigma.y)),
                   fibreSum(m, fibreAzimuthal(texel, sigma.z))) *
         (lit(1) / cos2_d);
}
