// Kajiya and Kay 1989 with two specular lobes shifted along the tangent. Needs scene.glsl and light.glsl.

// Inclinations are measured from the plane perpendicular to the hair, positive towards the tip. A cylinder reflects
// light at inclination a to -a. Scales tilted towards the root shift the first lobe to 2 * kShift - a. They shift the
// second lobe, which has passed through the hair and back, the other way.
const float kShift = -0.06, kShiftInner = 0.10;
const float kExponent = 60.0, kExponentInner = 14.0;

float lobe(float inclination_light, float inclination_eye, float shift, float exponent) {
  return pow(max(cos(inclination_light + inclination_eye - 2.0 * shift), 0.0), exponent);
}

// Energy conservation for light hair: the integral of scattered() over all outgoing directions must be below 1. Its
// maximum is for light perpendicular to the hair. The factor is 1 for dark hair. `brightest`: largest component of the
// base colour.
float energyFactor(float brightest) {
  float whole = brightest * (1.26 + 0.98 * sqrt(brightest)) + 0.07;
  return pow(1.0 + pow(whole, 8.0), -0.125);
}

// Light scattered towards the eye from one light, unshadowed; `base` is the hair's scattering colour.
vec3 scattered(vec3 base, vec3 tangent, vec3 l, vec3 e) {
  float tl = clamp(dot(tangent, l), -1.0, 1.0), te = clamp(dot(tangent, e), -1.0, 1.0);
  float sine = sqrt(max(1.0 - tl * tl, 0.0));
  float il = asin(tl), ie = asin(te);
  // Cosine of half the azimuth around the hair between light and eye: 1 for light from behind the eye.
  vec3 la = l - tl * tangent, ea = e - te * tangent;
  float around = dot(la, ea) * inversesqrt(max(dot(la, la) * dot(ea, ea), 1e-8));
  float front = sqrt(max(0.5 + 0.5 * around, 0.0));
  vec3 diffuse = base * sine * (0.45 + 0.55 * front);
  float outer = lobe(il, ie, kShift, kExponent) * front;
  float inner = lobe(il, ie, kShiftInner, kExponentInner) * (0.3 + 0.7 * front);
  vec3 specular = vec3(0.17) * outer + 1.1 * sqrt(base) * base * inner;
  return (0.5 * diffuse + specular * sine) * energyFactor(max(base.r, max(base.g, base.b)));
}

// `color`: linear, of the hair at half of its length.
vec3 hairRadiance(vec3 color, vec3 position, vec3 tangent, float along, float shade, float warmth) {
  vec3 e = normalize(scene.eye.xyz - position);
  vec3 base = hairTint(color, shade, warmth, along);
  // Dense hair transmits its own colour: the least absorbed component penetrates deepest.
  vec3 tint = color / max(max(color.r, color.g), max(color.b, 1e-3));
  vec3 direct = vec3(0);
  vec2 clear = vec2(0);
  for (int light = 0; light < LIGHTS; ++light) {
    vec3 through = vec3(1);
    if (castsShadow(light)) {
      vec3 at = lightCoordinates(light, position);
      float depth = hairOpticalDepth(light, at, 0.0015 * scene.sampling.z);
      through = exp(-depth * mix(vec3(0.75), vec3(0.45), tint)) * solidVisibility(light, at, 0.006 * scene.sampling.z, 0);
      // Also where a solid blocks the light: a hair there is surrounded by hair, for which the hair in front of the
      // solid is representative.
      clear += clearAlong(light, exp(-0.10 * depth), 1.0);
    }
    direct += lightAt(light, position) * through * scattered(base, tangent, towardsLight(light, position), e);
  }
  float occlusion = mix(0.45, 1.0, smoothstep(0.0, 0.25, along)) * (0.30 + 0.70 * clearAround(clear));
  vec3 outward = normalize(e - dot(tangent, e) * tangent + vec3(0, 1e-6, 0));
  return direct + base * ambient(outward) * occlusion * 0.65;
}
