// Part of rod.comp: the strand of an invocation during a dispatch: rest shape and state of its PER_THREAD slots. Slot p
// holds joint, edge, and outer vertex of edge number PER_THREAD rank + p. Slots past the strand's last edge are padding:
// copies of its tip without length and stiffness. Requires strand_threads.glsl, step_input.glsl and kernels/rod.h.

layout(std430, binding = 0) buffer Positions { vec4 positions[]; };            // xyz, m; w: tension of the edge before, m/s^2
layout(std430, binding = 1) buffer Velocities { vec4 velocities[]; };          // xyz, m/s; w: distance from bodies at rest, m
layout(std430, binding = 2) readonly buffer RestLocal { vec4 rest_local[]; };  // xyz, m; w: inverse mass; see bonePoint()
layout(std430, binding = 9) buffer Frames { vec4 frames[]; };                  // x y z w, of the edge that starts at the vertex
layout(std430, binding = 10) readonly buffer Joints { vec4 joints[]; };        // xyz: rest strain; w: bending stiffness, m^2/s^2
#if (STRAND_UNIFORMITY == 1 || STRAND_UNIFORMITY == 2) && !BODIES
layout(std430, binding = 11) readonly buffer Edges { float edge_rest[]; };  // rows: weight; length, weight; or as below
layout(location = 11) uniform uint edge_row;                                // floats per row: 1, 2 or 4
float restLengthAt(uint at) { return edge_rest[at * edge_row]; }
float weightAt(uint at) { return edge_rest[at * edge_row + edge_row - 1u]; }
#else
layout(std430, binding = 11) readonly buffer Edges {
  vec4 edge_rest[];
};  // length, twist; mass, weight of the outer vertex (m, m^2/s^2)
float restLengthAt(uint at) { return edge_rest[at].x; }
float weightAt(uint at) { return edge_rest[at].w; }
#endif
// Indices in work[]: count and list of the strands to solve, and of those that are left to another variant.
layout(location = 0) uniform uint own_count;
layout(location = 1) uniform uint own_list;
layout(location = 2) uniform uint deferred_count;
layout(location = 3) uniform uint deferred_list;
layout(location = 4) uniform int first_substep;
layout(location = 5) uniform int end_substep;  // one past the last
#if BODIES
layout(location = 6) uniform uint penetrating_count;
layout(location = 7) uniform uint penetrating_list;
layout(location = 8) uniform uint stale_count;
layout(location = 9) uniform uint stale_list;
#endif
layout(location = 10) uniform uint strands_in_group;
const uint kWholeGroup = 0xFFFFFFFFu;             // value of own_count: all strands_in_group strands
const uint kStrands = uint(WORKGROUP / THREADS);  // strands per workgroup
const uint kMaxWorkgroups = 65535u;               // in x: the limit that every driver supports

uint strand, root_vertex;
StrandRest rest;
#if STRAIGHT
const bool kinked = false;
#else
bool kinked;  // isKinked()
#endif
bool cut_unevenly;       // isCutUnevenly()
bool between_pins;       // hangsBetweenPins()
float correction_limit;  // correctionLimit()
bool taut;               // isTaut()
bool exists;             // false: past the last strand; works on a copy of it, because all invocations must reach every barrier

vec3 x[PER_THREAD], v[PER_THREAD];  // m, m/s
float tension[PER_THREAD];          // m: StrandState::tensions x substep^2
float max_tension;                  // m, bound on the warm start: tensionBound()
#if STRAIGHT
vec4 first_frame;  // material frame of the strand's first edge
#else
vec4 frame[PER_THREAD];
vec3 rest_strain[PER_THREAD];  // Darboux vector at rest of the joint of slot p
#endif
vec3 x_in, v_in;          // of the vertex before slot 0
float bends[PER_THREAD];  // bending stiffness of the joint of slot p, m^2/s^2

#if EDGES > 0
const int edges = EDGES;
#else
int edges;
#endif

bool isEdge(int p) {
#if EDGES > 0 && EDGES > (THREADS - 1) * PER_THREAD
  return p < EDGES - (THREADS - 1) * PER_THREAD || hasAfter(1);  // padding is in the last invocation only
#else
  return rank * PER_THREAD + p < edges;
#endif
}

// Whether the edge of slot p is one of the last `count` (1 or 2) of its strand, or padding.
bool isLast(int p, int count) {
#if EDGES > (THREADS - 1) * PER_THREAD + 2
  return p >= EDGES - count - (THREADS - 1) * PER_THREAD && !hasAfter(1);  // they are in the last invocation only
#else
  return rank * PER_THREAD + p + count >= edges;
#endif
}

// Whether the vertex of slot p is the last of its strand.
bool isTip(int p) {
#if EDGES > 0
  return p == (EDGES - 1) % PER_THREAD && rank == (EDGES - 1) / PER_THREAD;
#else
  return rank * PER_THREAD + p == edges - 1;
#endif
}

#if GROOMED
float keeps[PER_THREAD], keep_in;  // DragStep::keep
float time2s[PER_THREAD];          // s^2, DragStep::time2
float goal_stiffness[PER_THREAD];  // goalStiffness(); mass() includes it
vec2 strand_grooming;              // the strand's factors of friction and damping time
#define KEEP(p) keeps[p]
#define KEEP_IN keep_in
#define DAMPING_TIME (settings.damping_time * strand_grooming.y)

// Goal stiffness of the outer vertex of the edge that starts at vertex `at`; `own`: its mass. Not for pinned vertices.
float goalStiffnessOf(uint at, float own) { return goalStiffness(own, goalRateOf(at + 1u), settings.time2); }
// Mass of that vertex in the bending matrix: with the drag's time2 and the goal stiffness.
float groomedMass(uint at, float own) { return madd(own, settings.time2 / time2Of(at + 1u), goalStiffnessOf(at, own)); }
#else
#define KEEP(p) settings.keep
#define KEEP_IN settings.keep
#define DAMPING_TIME settings.damping_time
#endif
// DAMPING_TIME_AT: damping time of the joint of slot p, s. DAMPING_SUBSTEPS_AT: the same in substeps; `ahead`: that of all joints.
#if GROOMED == 2 && DAMPED
float damping_times[PER_THREAD];
#define DAMPING_TIME_AT(p) damping_times[p]
#define DAMPING_SUBSTEPS_AT(p) (damping_times[p] * settings.per_substep)
#else
#define DAMPING_TIME_AT(p) DAMPING_TIME
#define DAMPING_SUBSTEPS_AT(p) ahead
#endif

// Greatest stiffness ratio of the strand's edges, see stiffnessOf().
float kappa() { return rest.stiffest * settings.time2; }

#if STRAND_UNIFORMITY == 0
// Length, twist, and mass and weight of the outer vertex, of the edge that starts at vertex `at`.
vec4 edgeRest(uint at) {
  vec4 edge = edge_rest[at];
#if GROOMED
  if (edge.w > 0.0) {
    edge.z = groomedMass(at, edge.z);
    edge.w = 1.0 / edge.z;
  }
#endif
  return edge;
}
vec4 edge[PER_THREAD];  // length, twist; mass, weight of the outer vertex
float weight_in;        // of the vertex before slot 0
float restLength(int p) { return edge[p].x; }
float twist(int p) { return edge[p].y; }
float mass(int p) { return edge[p].z; }
float weight(int p) { return edge[p].w; }
#else
// Constant ratio of twisting to bending stiffness.
float twist(int p) { return bends[p] * rest.twist_per_bend; }
#if STRAND_UNIFORMITY == 3
// Masses are 1, at the tip 1/2.
const float weight_in = 1.0;
#if EDGES > 0
float tip_mass, tip_weight;  // of slot kTip, which is the strand's tip in the last invocation with edges
const int kTip = (EDGES - 1) % PER_THREAD;
float mass(int p) { return p == kTip ? tip_mass : 1.0; }
float weight(int p) { return p == kTip ? tip_weight : 1.0; }
#else
float mass(int p) { return isTip(p) ? 0.5 : 1.0; }
float weight(int p) { return isTip(p) ? 2.0 : 1.0; }
#endif
#else
#if GROOMED
float ownWeight(uint at) { return 1.0 / groomedMass(at, 1.0 / weightAt(at)); }
#else
float ownWeight(uint at) { return weightAt(at); }
#endif
float weights[PER_THREAD], weight_in;
float mass(int p) { return 1.0 / weights[p]; }
float weight(int p) { return weights[p]; }
#endif
#endif

#if STRAND_UNIFORMITY >= 2
// All edges have one length.
float restLength(int p) { return isEdge(p) ? rest.edge_length : 0.0; }
float inverseLength(int p) { return rest.inverse_length; }
float inverseLengthIn() { return rest.inverse_length; }
float inverseLengthOut() { return rest.inverse_length; }
#else
#if STRAND_UNIFORMITY == 1
float lengths[PER_THREAD];
float restLength(int p) { return lengths[p]; }
#endif
float inverse_lengths[PER_THREAD];
float inverse_length_in, inverse_length_out;  // of the edges before slot 0 and after the last
float boundedInverse(float edge_length) { return 1.0 / max(edge_length, rest.shortest); }
float inverseLength(int p) { return inverse_lengths[p]; }
float inverseLengthIn() { return inverse_length_in; }
float inverseLengthOut() { return inverse_length_out; }
#endif

// Upper bound of the acceleration of the strand's vertices by wind and external accelerations, m/s^2.
float airAccelerationBound() {
  const float wind = length(settings.wind.xyz) * settings.air_drag;
#if GROOMED || ACCELERATED
  float driven = 0.0;
  for (int p = 0; p < PER_THREAD; ++p) {
#if GROOMED
    float own = wind * grooming[root_vertex + uint(min(rank * PER_THREAD + p + 1, edges))].x;
#else
    float own = wind;
#endif
#if ACCELERATED
    own += length(accelerationOf(root_vertex + uint(min(rank * PER_THREAD + p + 1, edges))));
#endif
    driven = max(driven, own);
  }
  return strandMax(driven);
#else
  return wind;
#endif
}

#if PINNED
float maxTautness();  // shaders/rod_finish.glsl
#else
float maxTautness() { return 1.0; }
#endif

// Loads the strand of this invocation; arguments as of stepStrands().
void loadStrand(uint list, uint first, uint count) {
  initInvocation();
  uint number = first + me / uint(THREADS);
  exists = number < count;
  strand = work[list + min(number, count - 1u)];
  root_vertex = offsets[strand];
  rest = strand_rest[strand];
  const int traits = int(rest.traits);
#if !STRAIGHT
  kinked = isKinked((traits & 1) != 0, kappa());
#endif
  cut_unevenly = (traits & 2) != 0;
  between_pins = (traits & 4) != 0;
  correction_limit = correctionLimit((traits & 9) != 0, kappa());
#if EDGES == 0
  edges = int(offsets[strand + 1u] - root_vertex) - 1;
#endif
#if STRAND_UNIFORMITY == 3 && EDGES > 0
  tip_mass = isTip(kTip) ? 0.5 : 1.0;
  tip_weight = isTip(kTip) ? 2.0 : 1.0;
#endif
  for (int p = 0; p < PER_THREAD; ++p) {
    uint at = root_vertex + uint(min(rank * PER_THREAD + p, edges - 1));
    vec4 position = positions[at + 1u];
    x[p] = position.xyz;
    v[p] = velocities[at + 1u].xyz;
    tension[p] = isEdge(p) ? position.w * settings.time2 : 0.0;
#if !STRAIGHT
    frame[p] = frames[at];
    rest_strain[p] = joints[at].xyz;
#endif
#if STRAIGHT && STRAND_UNIFORMITY == 3
    bends[p] = isEdge(p) ? rest.bend : 0.0;
#else
    bends[p] = isEdge(p) ? joints[at].w : 0.0;
#endif
#if STRAND_UNIFORMITY == 0
    edge[p] = edgeRest(at);
    inverse_lengths[p] = boundedInverse(edge[p].x);
    if (!isEdge(p)) edge[p].x = edge[p].y = 0.0;
#elif STRAND_UNIFORMITY < 3
    weights[p] = ownWeight(at);
#endif
#if STRAND_UNIFORMITY == 1
    const float own_length = restLengthAt(at);
    inverse_lengths[p] = boundedInverse(own_length);
    lengths[p] = isEdge(p) ? own_length : 0.0;
#endif
#if GROOMED
    keeps[p] = keepOf(at + 1u);
    time2s[p] = time2Of(at + 1u);
    goal_stiffness[p] = weightAt(at) > 0.0 ? goalStiffnessOf(at, 1.0 / weightAt(at)) : 0.0;
#endif
#if GROOMED == 2 && DAMPED
    damping_times[p] = settings.damping_time * frictionAndDampingOf(at).y;
#endif
  }
#if STRAIGHT && STRAND_UNIFORMITY == 3
  bends[0] = select(rank > 0, bends[0], rest.root_bend);
#endif
  uint at = root_vertex + uint(min(rank * PER_THREAD, edges));
  x_in = positions[at].xyz;
  v_in = velocities[at].xyz;
#if STRAND_UNIFORMITY < 3
  const uint before_slots = max(at, root_vertex + 1u) - 1u;  // edge that ends at the vertex before slot 0
#if STRAND_UNIFORMITY == 0
  const float own_weight = edgeRest(before_slots).w;
#else
  const float own_weight = ownWeight(before_slots);
#endif
  weight_in = rank > 0 ? own_weight : 0.0;
#endif
#if STRAND_UNIFORMITY < 2
  inverse_length_in = boundedInverse(restLengthAt(before_slots));
  inverse_length_out = boundedInverse(restLengthAt(root_vertex + uint(min((rank + 1) * PER_THREAD, edges - 1))));
#endif
#if GROOMED
  keep_in = keepOf(at);
  strand_grooming = grooming[root_vertex].xy;
#endif
  const float max_tautness = maxTautness(), driven = max_tautness * (length(settings.gravity.xyz) + airAccelerationBound());
  taut = isTaut(max_tautness);
  max_tension = tensionBound(rest.free_mass, rest.arc_length, driven, settings.time2);
}

// Entry of positions[] for the vertex of slot p.
vec4 placed(int p) { return vec4(x[p], tension[p] / settings.time2); }
void storeVertex(int slot, vec4 position, vec3 velocity) {
  if (slot >= edges) return;
  positions[root_vertex + uint(slot) + 1u] = position;
  velocities[root_vertex + uint(slot) + 1u].xyz = velocity;
}
void storeFrame(int slot, vec4 own) {
  if (slot < edges) frames[root_vertex + uint(slot)] = own;
}

void storeStrand() {
  if (rank == 0) {
    positions[root_vertex].xyz = x_in;
    velocities[root_vertex].xyz = v_in;
#if STRAIGHT
    frames[root_vertex] = first_frame;
#endif
  }
#if SHUFFLED && THREADS > 1
  // Each pair of invocations writes adjacent entries together, so that memory receives whole sectors. Vertices start at the
  // second entry of a sector (the root has the first), frames at the first. `pair`: the pair's first slot.
  const bool outer = (rank & 1) == 1;
  const int pair = (rank & ~1) * PER_THREAD;
  const uint other = me ^ 1u;
#if PER_THREAD == 2
  storeVertex(pair + (outer ? 2 : 1), select(outer, placed(0), placed(1)), select(outer, v[0], v[1]));
  storeVertex(pair + (outer ? 3 : 0), select(outer, placed(1), placed(0)), select(outer, v[1], v[0]));
#if !STRAIGHT
  const vec4 theirs = subgroupShuffle(select(outer, frame[0], frame[1]), other);
  storeFrame(pair + (outer ? 1 : 0), select(outer, theirs, frame[0]));
  storeFrame(pair + (outer ? 3 : 2), select(outer, frame[1], theirs));
#endif
#else
  const vec4 their_place = subgroupShuffle(select(outer, placed(1), placed(2)), other);
  const vec3 their_velocity = subgroupShuffle(select(outer, v[1], v[2]), other);
  storeVertex(pair + (outer ? 2 : 1), select(outer, their_place, placed(1)), select(outer, their_velocity, v[1]));
  storeVertex(pair + (outer ? 4 : 3), select(outer, placed(0), placed(3)), select(outer, v[0], v[3]));
  storeVertex(pair + (outer ? 6 : 5), select(outer, placed(2), their_place), select(outer, v[2], their_velocity));
  storeVertex(pair + (outer ? 7 : 0), select(outer, placed(3), placed(0)), select(outer, v[3], v[0]));
#if !STRAIGHT
  const vec4 first = subgroupShuffle(select(outer, frame[0], frame[1]), other);
  const vec4 second = subgroupShuffle(select(outer, frame[2], frame[3]), other);
  storeFrame(pair + (outer ? 1 : 0), select(outer, first, frame[0]));
  storeFrame(pair + (outer ? 3 : 2), select(outer, second, frame[2]));
  storeFrame(pair + (outer ? 5 : 4), select(outer, frame[1], first));
  storeFrame(pair + (outer ? 7 : 6), select(outer, frame[3], second));
#endif
#endif
#else
  for (int p = 0; p < PER_THREAD; ++p) {
    storeVertex(rank * PER_THREAD + p, placed(p), v[p]);
#if !STRAIGHT
    storeFrame(rank * PER_THREAD + p, frame[p]);
#endif
  }
#endif
}

// Stores the guides: positions after the whole step.
#if BODIES
// Only after the last substep: until then the buffer may hold accelerations. `stays`: the strand has been stored.
void storeGuides(bool stays) {
  if (!stays || end_substep != int(settings.substeps)) return;
  if (rank == 0) storeGuide(root_vertex, x_in);
  for (int p = 0; p < PER_THREAD; ++p)
    if (isEdge(p)) storeGuide(root_vertex + uint(rank * PER_THREAD + p) + 1u, x[p]);
}
#else
// Gathers the guides in shared memory, and the workgroup writes strand by strand: if each invocation wrote its own,
// every sector would be written several times. All invocations of the workgroup must call it.
const uint kGuideRow = uint(THREADS * PER_THREAD + 1) * 3u;
shared float together[kStrands * kGuideRow];
shared uint guides_from[kStrands], guide_numbers[kStrands];

void storeContiguous(uint slot, vec3 position) {
  const uint at = me / uint(THREADS) * kGuideRow + 3u * slot;
  together[at] = position.x;
  together[at + 1u] = position.y;
  together[at + 2u] = position.z;
}
void storeGuides(bool stays) {
  const uint own = me / uint(THREADS);
  if (rank == 0) {
    guides_from[own] = 3u * root_vertex;
    guide_numbers[own] = stays ? 3u * uint(edges + 1) : 0u;
    storeContiguous(0u, x_in);
  }
  for (int p = 0; p < PER_THREAD; ++p) storeContiguous(uint(rank * PER_THREAD + p) + 1u, x[p]);
  barrier();
  for (uint s = 0u; s < kStrands; ++s)
    for (uint i = me; i < guide_numbers[s]; i += uint(WORKGROUP)) guides[guides_from[s] + i] = together[s * kGuideRow + i];
  barrier();  // before the workgroup's next strands overwrite `together`
}
#endif
