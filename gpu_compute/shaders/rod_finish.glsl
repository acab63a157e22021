// The end of a substep: exact lengths, velocities, and the speeds of strands that are thrown. A part of rod.comp.
#if VIOLENT && (BODIES || PINNED)
// Of the strand's vertices, their root and pins and what is beside them, before the substep gives new speeds, m/s. Among bodies old ones are read
// again: kept, they would take registers all the time. `checked`: see finish().
float fastestOfStrand(vec3 checked[PER_THREAD]) {
  const vec3 root = rank == 0 ? shift_in : vec3(0);
  float way2 = dot(root, root), speed2 = 0.0;
  for (int p = 0; p < PER_THREAD; ++p) {
    if (!isEdge(p)) continue;
#if BODIES
    const vec3 old = velocities[vertexOf(p)].xyz;
#else
    const vec3 old = v[p];
#endif
    speed2 = max(speed2, dot(old, old));
    if (weight(p) == 0.0) way2 = max(way2, dot(checked[p], checked[p]));
#if BODIES
    else if (sees[p]) way2 = max(way2, carried2Of(vertexOf(p), x[p] + checked[p], x[p]));
#endif
  }
  return sqrt(strandMax(max(speed2, way2 * settings.per_substep * settings.per_substep)));
}
// After it has.
void slowDown(float fastest, float thrown_by) {
  float speed2 = 0.0;
  for (int p = 0; p < PER_THREAD; ++p)
    if (isEdge(p)) speed2 = max(speed2, dot(v[p], v[p]));
  const float kept = slowed(sqrt(strandMax(speed2)), fastest, thrown_by, between_pins);
#if BODIES
  speed_kept = kept;
#endif
  for (int p = 0; p < PER_THREAD; ++p)
    if (weight(p) > 0.0) v[p] *= kept;
  if (hasBefore(1) && weight_in > 0.0) v_in *= kept;  // as the invocation before has it
}
#endif

#if PINNED
#include "gpu_compute/shaders/rod_pinned.glsl"
#endif

// Exact lengths along the directions found, from the root or the last pinned vertex on: a scan. Then velocities.
#if BODIES
// `checked`: the shifts that contact left the vertices with.
void finish(vec3 checked[PER_THREAD]) {
#else
void finish() {
#endif
#if VIOLENT && BODIES
  float thrown_by = thrownBy(most, 1.0), fastest = 0.0;
  const bool any_thrown = anyStrand(thrown_by > 0.0);
  if (any_thrown) {
    thrown_by = thrownBy(most, select(between_pins, 1.0, strandMax(near_body)));
    fastest = fastestOfStrand(checked);
  }
#elif VIOLENT && PINNED
  const float thrown_by = thrownBy(most, select(between_pins, 1.0, 0.0));
  const bool any_thrown = anyStrand(thrown_by > 0.0);
  const float fastest = any_thrown ? fastestOfStrand(shift) : 0.0;
#endif
  vec3 along[PER_THREAD];  // shifts, less that of the vertex before slot 0 where that is no root
  bool anchored[PER_THREAD];
  vec3 sum = select(hasBefore(1), vec3(0), shift_in);
  bool fixed_here = false;
#if PINNED
  // Of pins: what exact lengths from the pin before miss, less that one's shift where it is in no slot; of all: lengths since the last pin.
  vec3 missed[PER_THREAD];
  float lengths[PER_THREAD], run = 0.0;
  bool follows_pin[PER_THREAD];  // in the slots before it
#endif
  for (int p = 0; p < PER_THREAD; ++p) {
    sum += select(isEdge(p), edgeShift(p) + missingLength(newEdge(p), tangent[p], restLength(p)), vec3(0));
#if PINNED
    run += restLength(p);
    lengths[p] = run;
    follows_pin[p] = fixed_here;
    missed[p] = shift[p] - sum;
    if (weight(p) == 0.0) {
      sum = shift[p];
      run = 0.0;
      fixed_here = true;
    }
#endif
    along[p] = sum;
    anchored[p] = fixed_here;
  }
#if THREADS > 1
  for (int doubling = 0; doubling < REPEATS(kDoublings); ++doubling) {
    int distance = 1 << doubling;
    send_a(vec4(sum, fixed_here ? 1 : 0));
#if PINNED
    send_d(run);
#endif
    rendezvous();
    vec4 other = received_a(before(distance));
#if PINNED
    const float other_run = received_d(before(distance));
#endif
    release();
    const bool follows = hasBefore(distance) && !fixed_here;
    sum += select(follows, other.xyz, vec3(0));
#if PINNED
    run += select(follows, other_run, 0.0);
    fixed_here = fixed_here || (follows && other.w > 0.5);
#endif
  }
  // Exactly as the invocation before has it: both add it to the same position.
#if PINNED
  send_a(vec4(sum, run));
#else
  send_a(vec4(sum, 0));
#endif
  rendezvous();
  const vec4 last_before = received_a(before(1));
  release();
  shift_in = select(hasBefore(1), last_before.xyz, shift_in);
  for (int p = 0; p < kLast; ++p) along[p] += select(hasBefore(1) && !anchored[p], last_before.xyz, vec3(0));
#if PINNED
  for (int p = 0; p < PER_THREAD; ++p) {
    const bool follows = hasBefore(1) && !follows_pin[p];
    missed[p] -= select(follows, last_before.xyz, vec3(0));
    lengths[p] += select(follows, last_before.w, 0.0);
  }
#endif
#endif
  along[kLast] = sum;
#if PINNED
  shareMissing(along, missed, lengths);
#endif
  shift = along;
#if BODIES
  lost = isLost(checked);
#endif
  v_in = shift_in * settings.per_substep;
  x_in += shift_in;
  for (int p = 0; p < PER_THREAD; ++p) {
    v[p] = shift[p] * settings.per_substep;
    x[p] += shift[p];
  }
#if VIOLENT && (BODIES || PINNED)
  if (any_thrown) slowDown(fastest, thrown_by);
#endif
}
