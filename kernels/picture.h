// Kernel text: see kernels/README.md. Requires a lane vocabulary.
//
// What a picture of the renderer shares with one of the path tracer: exposure, sky, backdrop, ground and the tint of
// hairs. Radiance is linear. Its unit: a white diffuse surface whose irradiance is pi has the radiance 1.

// Irradiance of a white light of intensity 1 perpendicular to its direction, over pi.
LANE_FN real3 sunIrradiance() { return makeReal3(lit(2.3), lit(2.17), lit(2.0)); }

// Radiance of the sky where none is given: a linear blend from straight below to straight above. `up`: the direction's
// height, -1 to 1.
LANE_FN real3 skyAbove() { return makeReal3(lit(0.34), lit(0.38), lit(0.45)); }
LANE_FN real3 skyBelow() { return makeReal3(lit(0.15), lit(0.13), lit(0.12)); }
LANE_FN real skyBlend(LANE_IN(real) up) { return lit(0.5) + lit(0.5) * up; }

// Tone mapping: linear display values, 0 to 1. `gains`: exposure and white balance, factors of red, green and blue.
LANE_FN real3 toneMappedBy(LANE_IN(real3) gains, LANE_IN(real3) radiance) {
  return makeReal3(lit(1) - exp(-(radiance.x * gains.x)), lit(1) - exp(-(radiance.y * gains.y)),
                   lit(1) - exp(-(radiance.z * gains.z)));
}

// Display value of the backdrop: the background's colour, lighter behind the middle, darker towards the edges and
// below. `x`, `y`: from the middle of the picture, in its heights, up.
LANE_FN real3 backdropColor(LANE_IN(real3) background, LANE_IN(real) x, LANE_IN(real) y) {
  real falloff = fadeBetween(lit(0), lit(1.1), length(makeReal3(x * lit(0.8), y, lit(0))));
  return background * blend(lit(0.85), lit(0.28), falloff) * (lit(1) + lit(0.25) * y);
}
// Share of the backdrop where the ground is seen. `from_center`: fraction of its radius.
LANE_FN real groundFade(LANE_IN(real) from_center) { return fadeBetween(lit(0.15), lit(1), from_center); }
// Albedo of the ground over the background's colour.
LANE_FN real groundAlbedo() { return lit(0.55); }

// Linear colour of a hair at the fraction `along` of its length, each component 0 to 1: `color` at its middle, darker at
// the root and lighter at the tip. `shade` (-1 darker to 1 lighter) and `warmth` (-1 ashen to 1 red) set hairs apart.
LANE_FN real3 hairTint(LANE_IN(real3) color, LANE_IN(real) shade, LANE_IN(real) warmth, LANE_IN(real) along) {
  real3 base = color * (lit(1) + lit(0.35) * shade) * blend(lit(0.75), lit(1.25), along);
  base = makeReal3(base.x * (lit(1) + lit(0.10) * warmth), base.y, base.z * (lit(1) - lit(0.10) * warmth));
  real most = max(max(base.x, max(base.y, base.z)), lit(1));
  return makeReal3(base.x / most, base.y / most, base.z / most);
}
