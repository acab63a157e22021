#version 450
#if SHUFFLED
#extension GL_KHR_shader_subgroup_basic : require
#extension GL_KHR_shader_subgroup_shuffle : require
#endif
// variants: PER_THREAD=2 THREADS=2 EDGES=0 STRAND_UNIFORMITY=0 PINNED=1 STRAIGHT=0 CONTACT_FREE=0 BODIES=1 SHAPE_KINDS=0 GROOMED=1 DAMPED=1 DENSE_METRIC=0 STIFF=0 STALE_CACHE=0 SHUFFLED=0 ACCELERATED=0 | PER_THREAD=4 THREADS=8 EDGES=31 STRAND_UNIFORMITY=3 PINNED=0 STRAIGHT=0 CONTACT_FREE=0 BODIES=0 SHAPE_KINDS=0 GROOMED=0 DAMPED=0 DENSE_METRIC=1 STIFF=1 STALE_CACHE=0 SHUFFLED=1 ACCELERATED=1 | PER_THREAD=2 THREADS=16 EDGES=31 STRAND_UNIFORMITY=0 PINNED=0 STRAIGHT=0 CONTACT_FREE=0 BODIES=1 SHAPE_KINDS=0 GROOMED=1 DAMPED=1 DENSE_METRIC=1 STIFF=1 STALE_CACHE=0 SHUFFLED=1 ACCELERATED=1 | PER_THREAD=4 THREADS=32 EDGES=0 STRAND_UNIFORMITY=0 PINNED=1 STRAIGHT=0 CONTACT_FREE=0 BODIES=1 SHAPE_KINDS=2 GROOMED=0 DAMPED=1 DENSE_METRIC=1 STIFF=0 STALE_CACHE=1 SHUFFLED=0 ACCELERATED=0 | PER_THREAD=4 THREADS=32 EDGES=0 STRAND_UNIFORMITY=0 PINNED=1 STRAIGHT=0 CONTACT_FREE=0 BODIES=0 SHAPE_KINDS=0 GROOMED=0 DAMPED=0 DENSE_METRIC=0 STIFF=0 STALE_CACHE=0 SHUFFLED=0 ACCELERATED=0 | PER_THREAD=4 THREADS=8 EDGES=31 STRAND_UNIFORMITY=3 PINNED=0 STRAIGHT=0 CONTACT_FREE=1 BODIES=0 SHAPE_KINDS=0 GROOMED=0 DAMPED=1 DENSE_METRIC=0 STIFF=0 STALE_CACHE=0 SHUFFLED=1 ACCELERATED=0 | PER_THREAD=4 THREADS=8 EDGES=31 STRAND_UNIFORMITY=3 PINNED=0 STRAIGHT=1 CONTACT_FREE=0 BODIES=0 SHAPE_KINDS=0 GROOMED=0 DAMPED=1 DENSE_METRIC=0 STIFF=0 STALE_CACHE=0 SHUFFLED=1 ACCELERATED=0 | PER_THREAD=4 THREADS=4 EDGES=0 STRAND_UNIFORMITY=0 PINNED=0 STRAIGHT=1 CONTACT_FREE=0 BODIES=0 SHAPE_KINDS=0 GROOMED=1 DAMPED=0 DENSE_METRIC=1 STIFF=0 STALE_CACHE=0 SHUFFLED=0 ACCELERATED=1 | PER_THREAD=4 THREADS=2 EDGES=0 STRAND_UNIFORMITY=0 PINNED=1 STRAIGHT=0 CONTACT_FREE=1 BODIES=0 SHAPE_KINDS=0 GROOMED=1 DAMPED=1 DENSE_METRIC=0 STIFF=0 STALE_CACHE=0 SHUFFLED=0 ACCELERATED=1 | PER_THREAD=2 THREADS=16 EDGES=31 STRAND_UNIFORMITY=0 PINNED=0 STRAIGHT=0 CONTACT_FREE=0 BODIES=1 SHAPE_KINDS=0 GROOMED=2 DAMPED=1 DENSE_METRIC=1 STIFF=0 STALE_CACHE=0 SHUFFLED=1 ACCELERATED=0 | PER_THREAD=4 THREADS=8 EDGES=31 STRAND_UNIFORMITY=0 PINNED=0 STRAIGHT=1 CONTACT_FREE=0 BODIES=0 SHAPE_KINDS=0 GROOMED=2 DAMPED=1 DENSE_METRIC=0 STIFF=0 STALE_CACHE=0 SHUFFLED=1 ACCELERATED=0 | PER_THREAD=4 THREADS=8 EDGES=31 STRAND_UNIFORMITY=2 PINNED=0 STRAIGHT=0 CONTACT_FREE=0 BODIES=0 SHAPE_KINDS=0 GROOMED=0 DAMPED=1 DENSE_METRIC=0 STIFF=0 STALE_CACHE=0 SHUFFLED=1 ACCELERATED=0 | PER_THREAD=2 THREADS=16 EDGES=31 STRAND_UNIFORMITY=2 PINNED=0 STRAIGHT=0 CONTACT_FREE=0 BODIES=1 SHAPE_KINDS=0 GROOMED=0 DAMPED=1 DENSE_METRIC=1 STIFF=1 STALE_CACHE=0 SHUFFLED=1 ACCELERATED=0 | PER_THREAD=4 THREADS=8 EDGES=31 STRAND_UNIFORMITY=2 PINNED=0 STRAIGHT=1 CONTACT_FREE=0 BODIES=0 SHAPE_KINDS=0 GROOMED=0 DAMPED=1 DENSE_METRIC=1 STIFF=0 STALE_CACHE=0 SHUFFLED=1 ACCELERATED=0 | PER_THREAD=4 THREADS=8 EDGES=31 STRAND_UNIFORMITY=1 PINNED=0 STRAIGHT=0 CONTACT_FREE=0 BODIES=0 SHAPE_KINDS=0 GROOMED=0 DAMPED=1 DENSE_METRIC=0 STIFF=0 STALE_CACHE=0 SHUFFLED=1 ACCELERATED=0 | PER_THREAD=2 THREADS=16 EDGES=0 STRAND_UNIFORMITY=1 PINNED=0 STRAIGHT=0 CONTACT_FREE=0 BODIES=1 SHAPE_KINDS=0 GROOMED=0 DAMPED=1 DENSE_METRIC=1 STIFF=0 STALE_CACHE=1 SHUFFLED=0 ACCELERATED=0 | PER_THREAD=4 THREADS=4 EDGES=15 STRAND_UNIFORMITY=1 PINNED=0 STRAIGHT=1 CONTACT_FREE=0 BODIES=0 SHAPE_KINDS=0 GROOMED=0 DAMPED=0 DENSE_METRIC=1 STIFF=0 STALE_CACHE=0 SHUFFLED=0 ACCELERATED=0 | PER_THREAD=4 THREADS=8 EDGES=31 STRAND_UNIFORMITY=2 PINNED=0 STRAIGHT=0 CONTACT_FREE=0 BODIES=0 SHAPE_KINDS=0 GROOMED=2 DAMPED=1 DENSE_METRIC=0 STIFF=0 STALE_CACHE=0 SHUFFLED=1 ACCELERATED=0 | PER_THREAD=2 THREADS=16 EDGES=31 STRAND_UNIFORMITY=1 PINNED=0 STRAIGHT=0 CONTACT_FREE=0 BODIES=1 SHAPE_KINDS=0 GROOMED=1 DAMPED=1 DENSE_METRIC=1 STIFF=0 STALE_CACHE=0 SHUFFLED=1 ACCELERATED=0
// Rod solver: the substeps of a dispatch for listed strands, as inextensible Kirchhoff rods. The CPU's counterpart is
// core/rod_sweep.inl; the equations are in kernels/rod.h and docs/solver.md.
// Reads: settings, bones, rest shape, external accelerations, lists of strands in work[], the contact cache.
// Writes: positions, velocities, tensions, frames, contact forces, guides after the last substep. Strands that a variant
// cannot solve are not stored; it lists them in work[] for the variant that can.
// PER_THREAD edges per invocation, THREADS invocations per strand, WORKGROUP / THREADS strands per workgroup; the state
// stays in registers. Each system along a strand is solved in two stages: every invocation eliminates its own slots, then
// the strand's invocations solve the reduced system by cyclic reduction.
// PER_THREAD: edges per invocation, 2 or 4.
// THREADS: invocations per strand, a power of 2 from 1 to 32.
// EDGES: edges of every strand of the group; 0: they differ.
// STRAND_UNIFORMITY: 0: lengths, masses and stiffnesses may differ along a strand.
//                    1: along each strand the ratio of twisting to bending stiffness is constant.
//                    2: and edges have one length.
//                    3: and vertices have one mass, half of it at the tip; with STRAIGHT, joints have one stiffness.
// PINNED: 0, 1: some strand has pinned vertices besides its root.
// STRAIGHT: 0; 1: strands are straight at rest, only their roots are pinned, and there are no bodies. Only the frame of the
//           first edge is stored; straight_frames.comp computes the others.
// BODIES: 0: no bodies; a dispatch solves all substeps.
//         1: among bodies; a dispatch solves one substep after query_contacts.comp, and lists strands for
//            resolve_penetration.comp.
// CONTACT_FREE: 0; 1: strands that contact_free_strands.comp found out of every body's reach, all substeps without bodies.
//               Strands that a body may have reached after all are not stored but added to the list of near strands.
// SHAPE_KINDS: 0 to 2, see bodies.glsl; of effect with STALE_CACHE only.
// GROOMED: 0: no goal, all grooming factors are 1.
//          1: a goal, or some factors differ from 1; requires STRAND_UNIFORMITY < 3.
//          2: and factors of damping and friction differ along strands.
// ACCELERATED: 0, 1: every vertex has an external acceleration.
// DAMPED: 0, 1: internal damping is on.
// DENSE_METRIC: 0: only strands whose correction strain stays within the limit; the others are listed.
//               1: also strands that need the dense metric: those listed, or all of a small model in one dispatch. A
//                  separate variant, because the dense metric would double the registers of every strand.
// STALE_CACHE: 0: strands with a stale contact cache are listed.
//              1: such strands query contacts again. They are few and cost more than all else, so a large group solves
//                 them in a third dispatch.
// STIFF: 0; 1: some strand is stiff (isStiff() of kernels/rod.h) or may be taut between pins, and may need stiff tensions.
// SHUFFLED: 0; 1: a workgroup is one subgroup, whose invocations exchange registers (gpu_compute/driver.h).
// Values that differ between invocations are chosen by select(), not by branches.
#define WORKGROUP 32
// The variant without the dense metric exists for large models only.
#define MANY_STRANDS (!DENSE_METRIC)
#if MANY_STRANDS
#define SELECT_BY_MIX  // saves a tenth of these strands' step on an H100; slows the other variants: docs/solver.md
#endif
layout(local_size_x = WORKGROUP) in;

#include "kernels/lanes_glsl.h"
#include "kernels/rotation.h"
#include "kernels/contact.h"
#include "kernels/distance_field.h"
#include "kernels/rod.h"
#if STIFF
#include "kernels/stiff_tensions.h"
#endif
#include "gpu_compute/shaders/step_input.glsl"
#if GROOMED
#include "kernels/strand.h"
#endif
#include "gpu_compute/shaders/strand_threads.glsl"
#include "gpu_compute/shaders/rod_work.glsl"
#include "gpu_compute/shaders/rod_strand.glsl"
#include "gpu_compute/shaders/root_motion.glsl"
#if !BODIES
#include "gpu_compute/shaders/placed_roots.glsl"
#endif
#include "gpu_compute/shaders/banded_systems.glsl"

// State of the current substep. Entry p belongs to slot p; entries from PER_THREAD on belong to the next invocation.
// Suffix _in: the slot before slot 0; _out: the slot after the last.
// Displacement of vertices since the substep began, m. Displacements are small numbers, because the rounding of positions
// would be taken for motion: see RodScratch in core/rod_sweep.inl.
vec3 shift[PER_THREAD];
vec3 shift_in;
vec3 tangent[PER_THREAD], tangent_in, tangent_out;  // unit
vec3 moment[PER_THREAD + 1];                        // m^2/s^2
float stiffness[PER_THREAD + 2];                    // of joints, in the bending matrix
float edge_stiffness[PER_THREAD + 1];               // of edges, in the bending matrix
float softness[PER_THREAD], softness_in;            // of vertices, see curlSoftness()
// The bending matrix in the layout of solvePentadiagonal(). `force`: its right-hand sides.
float diagonal[PER_THREAD], first[PER_THREAD - 1], second[PER_THREAD];
vec3 across;
vec3 force[PER_THREAD];                           // m
float lambda[PER_THREAD], lambda_in, lambda_out;  // tension increments of edges, m
// Greatest correction strain. DENSE_METRIC: of this strand, in this substep; else of this invocation, in all substeps so
// far.
float most;
#if BODIES
vec3 pressing[PER_THREAD];            // contact forces, m: StrandState::contacts x substep^2
vec3 normals[PER_THREAD], normal_in;  // contact normals of vertices in contact, else 0
// Of this invocation's vertices, in this substep:
bool near_contact;      // a body is near one, or pressed one when the substep began
float body_nearness;    // greatest nearness() of a body
float velocity_factor;  // factor that velocityClamp() left on the strand's velocities
bool lost;              // mayPenetrate()
bool stale_cache;       // isCacheStale() of some vertex
#define NORMAL(p) normals[p]
#define NORMAL_IN normal_in
#else
#define NORMAL(p) vec3(0)
#define NORMAL_IN vec3(0)
#endif

#if PINNED || GROOMED
// Position of a vertex of the rest shape as carried by the root frame, or by the bone that prescribes it. m.
// `time`: fraction of the step that has passed.
vec3 heldPoint(uint vertex, Pose root, float time) {
  vec4 local = rest_local[vertex];
  if (local.w < 0.0) return bonePoint(local, time);
  return apply(root, local.xyz);
}
vec3 heldPoint(uint vertex, RootMotion root) { return heldPoint(vertex, Pose(root.position, root.rotation), root.time); }
#endif

// Displacement of a vertex to its inertial point, m; of a pinned vertex, to its prescribed position.
vec3 inertialShift(vec3 position, vec3 velocity, float keep, float weight, uint vertex, RootMotion root) {
  vec3 way = madd(velocity, settings.substep * keep, root.jump);
#if PINNED
  if (weight == 0.0) way = heldPoint(vertex, root) - position;
#endif
  return way;
}

// Edge of slot p at the start of the substep, its change since, and its present value, m.
vec3 oldEdge(int p) { return x[p] - (p > 0 ? x[max(p - 1, 0)] : x_in); }
vec3 edgeShift(int p) { return shift[p] - (p > 0 ? shift[max(p - 1, 0)] : shift_in); }
vec3 newEdge(int p) { return oldEdge(p) + edgeShift(p); }

// Weight of the outer vertex of the edge of slot p; if that is pinned, of the inner one. With weight 0 the last edge before
// a pin would have another time blend than the edges before it, and would oscillate.
float freeWeight(int p) {
#if PINNED
  if (weight(p) == 0.0) return p > 0 ? weight(max(p - 1, 0)) : weight_in;
#endif
  return weight(p);
}

// Whether the inner end of the edge of slot p is the root or pinned.
bool isAnchored(int p) {
#if PINNED
  if ((p > 0 ? weight(max(p - 1, 0)) : weight_in) == 0.0) return true;
#endif
  return p == 0 && rank == 0;
}

// Sets the warm-started tension of the edge of slot p, and its tangent at the time blend of the old edge and the inertial
// one; `otherwise` if that has no direction. Returns the time blend. `unit_in`: direction of the old edge before it.
float predictEdge(int p, vec3 unit_in, vec3 otherwise) {
  float il = inverseLength(p);
  vec3 old = oldEdge(p), advance = edgeShift(p), edge = old + advance;
  tension[p] = min(keptTension(tension[p], advance * il, bends[p], il, settings.time2), max_tension);
  float kappa_here = stiffnessOf(bends[p], il, settings.time2, freeWeight(p));
#if STRAND_UNIFORMITY < 2
  kappa_here = select(cut_unevenly, kappa(), kappa_here);
#endif
  float blend = timeBlend(advance * il, old * il - unit_in, kappa_here, kinked);
  tangent[p] = directionOr(madd(advance, -blend, edge), otherwise);
  return blend;
}

// Displaces all vertices to their inertial points.
void placeInertial(RootMotion root) {
  uint vertex = root_vertex + uint(min(rank * PER_THREAD, edges));
  shift_in = select(rank > 0, inertialShift(x_in, v_in, KEEP_IN, weight_in, vertex, root), root.position - x_in);
  for (int p = 0; p < PER_THREAD; ++p) {
    vertex = root_vertex + uint(min(rank * PER_THREAD + p + 1, edges));
    shift[p] = inertialShift(x[p], v[p], KEEP(p), weight(p), vertex, root);
  }
}

// Sets edge_stiffness, the edges' part of the bending matrix, and softness, the vertices' part of the length metric.
// `margin`: bendMatrixMargin() of joints; `blend`: time blend of edges; `tangent_out2`: of the second edge after the last
// slot.
void softenVertices(float margin[PER_THREAD + 1], float blend[PER_THREAD], vec3 tangent_out2) {
  for (int p = 0; p < PER_THREAD; ++p) {
    float il = inverseLength(p);
    edge_stiffness[p] = edgeMatrixStiffness(margin[p] + margin[p + 1], il, tension[p], blend[p]);
    vec3 t_in2 = p > 0 ? tangent[max(p - 1, 0)] : select(hasBefore(1), tangent_in, tangent[0]);
    vec3 t_out = p < kLast ? tangent[min(p + 1, kLast)] : tangent_out;
    vec3 t_out2 = p < kLast - 1 ? tangent[min(p + 2, kLast)] : p < kLast ? tangent_out : tangent_out2;
    t_out2 = select(isLast(p, 2), t_out, t_out2);
    float anchoring = edgeAnchoring(stiffness[p], margin[p], margin[p + 1]);
    float soft =
        curlSoftness(weight(p), stiffness[p + 1], il, t_in2, tangent[p], t_out, t_out2, select(isAnchored(p), anchoring, 0.0));
    softness[p] = select(isLast(p, 1), 0.0, soft);
  }
}

#if STRAIGHT
#include "gpu_compute/shaders/rod_straight.glsl"
#else
#include "gpu_compute/shaders/rod_twist.glsl"
#endif

// Force of the edge of slot p on its outer vertex, x dt^2, m, with vertices at the inertial points.
vec3 edgeForce(int p, RootMotion root) {
  float il = inverseLength(p);
  vec3 pushed = cross(moment[p + 1] - moment[p], tangent[p]) * (il * settings.time2) - tangent[p] * tension[p];
  if (p == 0) pushed += select(rank == 0, root.swing * (stiffness[0] * il), vec3(0));
  return pushed;
}

// Assembles the bending matrix and its right-hand sides `force`.
void makeBending(RootMotion root) {
  vec3 force_out;
  force[0] = edgeForce(0, root);
  send_a(vec4(force[0], edge_stiffness[0]));
  send_b(vec4(moment[0], 0));
  exchangeBarrier();
  vec4 a = select(hasAfter(1), received_a(after(1)), vec4(0));
  vec3 b = select(hasAfter(1), received_b(after(1)).xyz, vec3(0));
  swapBank();
  force_out = a.xyz;
  edge_stiffness[PER_THREAD] = a.w;
  moment[PER_THREAD] = b;
  for (int p = 1; p < PER_THREAD; ++p) force[p] = edgeForce(p, root);

  const vec3 fall =
      settings.gravity.xyz * settings.time2 + settings.wind.xyz * (settings.substep * (1.0 - settings.keep)) - root.jump;
  float il[PER_THREAD + 1];
  for (int p = 0; p < PER_THREAD; ++p) il[p] = inverseLength(p);
  il[PER_THREAD] = inverseLengthOut();
  for (int p = 0; p < PER_THREAD; ++p) {
    vec3 outer = p < kLast ? force[min(p + 1, kLast)] : force_out;
#if ACCELERATED
    uint end = root_vertex + uint(min(rank * PER_THREAD + p + 1, edges));
    vec3 pulled = madd(accelerationOf(end), settings.time2, fall);
#else
    vec3 pulled = fall;
#endif
#if GROOMED
    vec3 driven = settings.gravity.xyz;
#if ACCELERATED
    driven += accelerationOf(end);
#endif
    vec3 way =
        madd(driven, time2s[p] - settings.time2, madd(settings.wind.xyz, settings.substep * (settings.keep - keeps[p]), pulled));
    vec3 goal = heldPoint(root_vertex + uint(min(rank * PER_THREAD + p + 1, edges)), root);
    vec3 total = force[p] - outer;
    if (weight(p) > 0.0) total += goalPull(way, mass(p), goal_stiffness[p], (goal - x[p]) - shift[p]);
#else
    vec3 total = madd(pulled, select(weight(p) > 0.0, mass(p), 0.0), force[p] - outer);
#endif
#if BODIES
    total += pressing[p];
#endif
    force[p] = select(isEdge(p), total, vec3(0));
    float own = mass(p) + bendOwn(stiffness[p], stiffness[p + 1], stiffness[p + 2], il[p], il[p + 1]);
    diagonal[p] = select(isEdge(p), own + edge_stiffness[p] + edge_stiffness[p + 1], 1.0);
  }
  for (int p = 0; p < PER_THREAD - 1; ++p)
    first[p] = bendAcross(stiffness[p + 1], stiffness[p + 2], il[p], il[p + 1], il[p + 2]) - edge_stiffness[p + 1];
  for (int p = 0; p < PER_THREAD - 2; ++p) second[p] = bendAcrossTwo(stiffness[p + 2], il[p + 1], il[p + 2]);
  across = vec3(bendAcrossTwo(stiffness[0], inverseLengthIn(), il[0]),
                bendAcross(stiffness[0], stiffness[1], inverseLengthIn(), il[0], il[1]) - edge_stiffness[0],
                bendAcrossTwo(stiffness[1], il[0], il[1]));
}

// Solves the bending system. `moved`: displacements of vertices by `force`, m.
void solveBending(out vec3 moved[PER_THREAD]) {
#if PER_THREAD == 2 && THREADS > 8 || THREADS > 16
  // Over many invocations the cyclic reduction cancels stiffnesses down to a mass and loses digits: one round of iterative
  // refinement.
  vec3 left[PER_THREAD] = force;
  for (int p = 0; p < PER_THREAD; ++p) moved[p] = vec3(0);
  for (int round = 0; round < OPAQUE_COUNT(2); ++round) {
    solvePentadiagonal(diagonal, first, second, across, left);
    for (int p = 0; p < PER_THREAD; ++p) moved[p] += left[p];
    if (round == 1) break;
    left = force;
    residual(diagonal, first, second, across, moved, left);
  }
#else
  moved = force;
  solvePentadiagonal(diagonal, first, second, across, moved);
#endif
}

// Displaces the free vertices by the forces. `moved`: by how much, m.
void moveByForces(out vec3 moved[PER_THREAD]) {
  solveBending(moved);
  for (int p = 0; p < PER_THREAD; ++p) {
#if PINNED
    if (weight(p) == 0.0) continue;
#endif
    shift[p] += moved[p];
  }
}

#include "gpu_compute/shaders/rod_lengths.glsl"

// Whether `own` holds in any invocation of the strand.
bool anyInStrand(bool own) { return strandSum(own ? 1.0 : 0.0) > 0.0; }

#if DENSE_METRIC || BODIES
// Whether `own` holds for any strand of the workgroup. All invocations of a strand must pass the same value.
bool anyInWorkgroup(bool own) {
  float strands = own ? 1.0 : 0.0;
  for (uint distance = uint(THREADS); distance < uint(WORKGROUP); distance *= 2u) {
    send_d(strands);
    exchangeBarrier();
    strands += received_d(me ^ distance);
    swapBank();
  }
  return strands > 0.0;
}
#endif

#if BODIES
#include "gpu_compute/shaders/rod_contact.glsl"
#elif CONTACT_FREE
#include "gpu_compute/shaders/rod_contact_free.glsl"
#endif

#if DENSE_METRIC
// Tension increments in the dense metric and the displacements that they cause, by conjugate gradients preconditioned with
// the tridiagonal length system. Leaves lambda 0, so that applyTensions() adds nothing, and softness 0, so that the second
// length pass uses the metric of the masses. Strands without `dense_metric` only take part in the barriers.
void applyTensionsThroughBending(bool dense_metric) {
  const float outer_lambda_in = dense_metric ? 0.0 : lambda_in, outer_lambda_out = dense_metric ? 0.0 : lambda_out;
  float outer_lambda[PER_THREAD], excess[PER_THREAD], conjugate[PER_THREAD];
  float slack[PER_THREAD], lower[PER_THREAD], pivot[PER_THREAD];
  lengthRows(slack, lower, pivot);
  diagonalToSlack(slack, lower);
  float product = 0.0;
  for (int p = 0; p < PER_THREAD; ++p) {
    excess[p] = lengthResidualOf(p, dot(newEdge(p), tangent[p]));
    outer_lambda[p] = dense_metric ? 0.0 : lambda[p];
    conjugate[p] = 0.0;
    product = madd(excess[p], lambda[p], product);
    if (dense_metric) softness[p] = 0.0;
  }
  if (dense_metric) softness_in = 0.0;
  product = strandSum(product);
  float kept = 0.0;  // coefficient of the previous search direction
  for (int iteration = 1; iteration <= OPAQUE_COUNT(kTensionIterations); ++iteration) {
    for (int p = 0; p < PER_THREAD; ++p) lambda[p] = conjugate[p] = madd(conjugate[p], kept, lambda[p]);
    send_d(lambda[0]);
    exchangeBarrier();
    lambda_out = received_d(after(1));
    swapBank();
    if (!hasAfter(1)) lambda_out = 0.0;
    for (int p = 0; p < PER_THREAD; ++p) force[p] = isEdge(p) && weight(p) > 0.0 ? tensionPush(p, 0.0) : vec3(0);
    vec3 moved[PER_THREAD];
    solveBending(moved);
    for (int p = 0; p < PER_THREAD; ++p) moved[p] = weight(p) > 0.0 ? held(moved[p], NORMAL(p)) : vec3(0);
    send_a(vec4(moved[kLast], 0));
    exchangeBarrier();
    vec3 moved_in = received_a(before(1)).xyz;
    if (!hasBefore(1)) moved_in = vec3(0);
    swapBank();
    float shortened[PER_THREAD];
    float curvature = 0.0;
    for (int p = 0; p < PER_THREAD; ++p) {
      shortened[p] = isEdge(p) ? dot(tangent[p], moved_in - moved[p]) : 0.0;
      curvature = madd(conjugate[p], shortened[p], curvature);
      moved_in = moved[p];
    }
    float way = conjugateStep(product, strandSum(curvature));
    for (int p = 0; p < PER_THREAD; ++p) {
      if (dense_metric) {
        shift[p] = madd(moved[p], way, shift[p]);
        tension[p] = madd(conjugate[p], way, tension[p]);
      }
      excess[p] -= way * shortened[p];
    }
    if (iteration == kTensionIterations) break;
    lambda = excess;
    solveTridiagonal(slack, lower, pivot, lambda);
    float next = 0.0;
    for (int p = 0; p < PER_THREAD; ++p) next = madd(excess[p], lambda[p], next);
    next = strandSum(next);
    kept = conjugateStep(next, product);
    product = next;
  }
  lambda = outer_lambda;
  lambda_in = outer_lambda_in;
  lambda_out = outer_lambda_out;
}
#endif

#if STIFF
#include "gpu_compute/shaders/rod_stiff.glsl"
#endif

// After the first length pass: whether the strand needs a second one, because it needs the dense metric or a body is near.
// DENSE_METRIC: applies the tension increments of strands that need the dense metric, or elimination. `pressed`: whether a
// body presses the strand.
bool needsSecondLengthPass(bool pressed) {
  bool needs = false;
#if STIFF
  most = strandMax(maxCorrectionStrain());
  needs = needsDenseMetric(most, correction_limit) && !taut;
  const bool eliminated = isEliminated(kappa(), most, correction_limit, pressed) || taut;
  if (anyInWorkgroup(eliminated)) eliminateTensions(eliminated);
  if (anyInWorkgroup(needs && !eliminated)) applyTensionsThroughBending(needs && !eliminated);
#elif DENSE_METRIC
  most = strandMax(maxCorrectionStrain());
  needs = needsDenseMetric(most, correction_limit);
  if (anyInWorkgroup(needs)) applyTensionsThroughBending(needs);
#else
  most = max(most, maxCorrectionStrain());
#endif
#if BODIES
  const bool meet = anyInStrand(near_contact);
  needs = needs || meet;
#endif
  return needs;
}

// Clears the tension increments of a strand that takes part in a second length pass only for its workgroup's barriers, so
// that its result does not depend on the other strands. `pulled_in`: shift_in as the first pass left it, bit for bit.
void clearLambda(vec3 pulled_in) {
  for (int p = 0; p < PER_THREAD; ++p) lambda[p] = 0.0;
  lambda_in = lambda_out = 0.0;
  shift_in = pulled_in;
}

// Displaces every vertex by the tension increments of its edges.
void applyTensions() {
  for (int p = 0; p < PER_THREAD; ++p) {
    tension[p] += lambda[p];
    shift[p] = madd(tensionPush(p, softness[p]), weight(p), shift[p]);
  }
  // The vertex before slot 0 is computed again here, which saves an exchange.
  const vec3 push_in = held(shiftByTensions(tangent_in, lambda_in, tangent[0], lambda[0], softness_in), NORMAL_IN);
  shift_in = select(hasBefore(1), madd(push_in, weight_in, shift_in), shift_in);
}

#include "gpu_compute/shaders/rod_finish.glsl"

// Appends the strand to a list; returns its index in the list. `count`, `list`: indices in work[].
uint listStrand(uint count, uint list) {
  uint at = atomicAdd(work[count], 1u);
  work[list + at] = strand;
  return at;
}
// The same for the list of an indirect dispatch, to which every kStrands strands add a workgroup: see work[].
void deferStrand(uint count, uint list) {
  uint at = listStrand(count, list);
  if (at % kStrands == 0u && at / kStrands < kMaxWorkgroups) atomicAdd(work[count - 3u], 1u);
}

void store() {
  storeStrand();
#if BODIES
  storeContacts();
#endif
}

// Solves the dispatch's substeps for kStrands strands: those from number `first` on of the list of `count` strands that
// starts at index `list` of work[].
void stepStrands(uint list, uint first, uint count) {
  loadStrand(list, first, count);
  most = 0.0;
#if DENSE_METRIC || BODIES
  const int passes = settings.substeps > 0u ? 2 : 0;  // length passes, at most; a literal 2 would be unrolled
#else
  const int passes = 1;
#endif
#if CONTACT_FREE
  loadBodies();
#endif
#if BODIES
  stale_cache = false;
  loadContacts();
  {
    const int substep = first_substep;
    const RootMotion root = knownRoot(substep);
#else
  for (int substep = first_substep; substep < end_substep; ++substep) {
    const int ahead = (substep - first_substep) % THREADS;
    if (ahead == 0) placeRoots(substep);
    const RootMotion root = placedRoot(ahead, timeAfter(substep));
#endif
    float blend[PER_THREAD];
    placeInertial(root);
    predictEdges(root, blend);
    solveJoints(root, blend);
    makeBending(root);
    vec3 moved[PER_THREAD];  // by forces, m
    moveByForces(moved);
#if BODIES
    vec3 checked[PER_THREAD];  // displacements after contact, m
    for (int p = 0; p < PER_THREAD; ++p) normals[p] = vec3(0);
    near_contact = false;
    body_nearness = 0.0;
    velocity_factor = 1.0;
    const bool pressed = pressThroughBending(substep, moved);
#else
    const bool pressed = false;
#endif
    bool again = true;  // whether this strand takes part in the length pass
    for (int pass = 0; pass < passes; ++pass) {
#if BODIES
      if (again && pass > 0) collide(substep);
#endif
      const vec3 pulled_in = shift_in;
      solveLengths(root);
      if (!again) clearLambda(pulled_in);
#if BODIES
      if (again) checked = shift;
#endif
      if (pass == 0) again = needsSecondLengthPass(pressed);
      applyTensions();
#if DENSE_METRIC || BODIES
      if (pass == 0 && !anyInWorkgroup(again)) break;
#endif
    }
#if BODIES
    finish(checked);
#else
    finish();
#endif
#if CONTACT_FREE
    addTravel(substep);
#endif
  }
#if STRAIGHT
  const RootMotion last = placedRoot((end_substep - first_substep - 1) % THREADS, 1.0);
  first_frame = transportTo(last.inner_frame, last.tangent_old, directionOr(oldEdge(0), last.tangent_old));
#endif
  bool stays = exists;
#if BODIES && !STALE_CACHE
  if (anyInStrand(stale_cache)) {
    if (stays && rank == 0) deferStrand(stale_count, stale_list);
    stays = false;
  }
#endif
#if !DENSE_METRIC
  bool leaves = needsDenseMetric(most, correction_limit) || taut;
#if CONTACT_FREE
  vec4 queried[PER_THREAD];
  leaves = mayTouchBody(queried) || leaves;
#endif
  if (anyInStrand(leaves)) {
    if (stays && rank == 0) {
#if CONTACT_FREE
      contacts[contactRow(root_vertex, kQueryPoint)].x = kNear;
      listStrand(deferred_count, deferred_list);
#else
      deferStrand(deferred_count, deferred_list);
#endif
    }
    stays = false;
  }
#endif
#if BODIES
  if (anyInStrand(lost) && stays && rank == 0) listStrand(penetrating_count, penetrating_list);
#endif
  if (stays) store();
#if CONTACT_FREE
  if (stays) storeQueryPoints(queried);
#endif
  storeGuides(stays);
}

void main() {
  const uint workgroup = gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x;
  const uint count = own_count == kWholeGroup ? strands_in_group : work[own_count];
#if DENSE_METRIC
  const uint workgroups = gl_NumWorkGroups.x * gl_NumWorkGroups.y;
  for (uint first = workgroup * kStrands; first < count; first += workgroups * kStrands) stepStrands(own_list, first, count);
#else
  if (workgroup * kStrands < count) stepStrands(own_list, workgroup * kStrands, count);
#endif
}
