// Ambient wind, which blows beyond the wind grid or, without a grid, everywhere (air/wind.h), and sources of wind
// (air/wind_source.h). Requires air_settings.glsl.
layout(std430, binding = 13) readonly buffer Turbulence { float turbulence[]; };  // 3 floats per node of the periodic box
struct Source {
  vec4 position;                               // m; w: kind
  vec4 direction;                              // unit; w: rate at which it draws air to its velocity, 1/s
  float radius, reach, cosine, speed;          // m; m; of a cone's half angle; m/s
  float swirl, per_share, unused_a, unused_b;  // m/s at the radius; m/s, SphereOnGrid::perShare() of a sphere on a grid
};
layout(std430, binding = 14) readonly buffer Sources { Source sources[]; };

// Ambient velocity at a point, m/s.
vec3 ambientAt(vec3 point) {
  const int kBox = 32;
  if (!(air.ambient_mean.w > 0.0)) return air.ambient_mean.xyz;
  vec3 place = (toTurbulenceBox(point) - air.ambient_carried.xyz) * air.ambient_carried.w, low = floor(place), part = place - low;
  vec3 eddies = vec3(0);
  for (int c = 0; c < 8; ++c) {
    ivec3 corner = (ivec3(low) + cornerOf(c)) & (kBox - 1);
    int at = 3 * (corner.x + kBox * (corner.y + kBox * corner.z));
    float weight = air.ambient_mean.w * splatWeight(part, float(c & 1), float((c >> 1) & 1), float(c >> 2));
    eddies = madd(vec3(turbulence[at], turbulence[at + 1], turbulence[at + 2]), weight, eddies);
  }
  return air.ambient_mean.xyz + toTurbulenceBox(eddies);
}

const float kCone = 0.0, kSphere = 1.0;  // WindSource::Kind

// Target divergence of the cell around a point, times the cell's edge, by spheres of wind, m/s.
float targetDivergence(vec3 point) {
  float wanted = 0.0;
  for (int i = 0; i < air.sources; ++i)
    if (sources[i].position.w == kSphere)
      wanted += sources[i].per_share *
                sphereShare(length(point - sources[i].position.xyz) / air.wind_box.w, sources[i].radius / air.wind_box.w);
  return wanted;
}
// Whether a source reaches a point. `velocity`: what it draws the air there to, m/s.
bool isBlown(Source source, vec3 point, out vec3 velocity) {
  vec3 away = point - source.position.xyz, axis = source.direction.xyz;
  float far = length(away), by = dot(away, axis);
  vec3 out_ = far > 0.0 ? away / far : axis;
  velocity = out_ * source.speed;
  if (source.position.w == kSphere) return far <= source.radius;
  if (source.position.w == kCone) {
    velocity = out_ * (source.speed * (1.0 - far / source.reach));
    return far <= source.reach && by >= far * source.cosine;
  }
  vec3 across = away - axis * by;
  velocity = axis * source.speed + cross(axis, across) * (source.swirl / source.radius);
  return abs(by) <= 0.5 * source.reach && length(across) <= source.radius;
}
