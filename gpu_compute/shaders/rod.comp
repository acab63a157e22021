#version 450
#if SHUFFLED
#extension GL_KHR_shader_subgroup_basic : require
#extension GL_KHR_shader_subgroup_shuffle : require
#endif
// variants: PER_THREAD=2 THREADS=2 EDGES=0 UNIFORM=0 PINNED=1 STRAIGHT=0 CLEAR=0 BODIES=1 TURNING=0 GROOMED=1 DAMPED=1 VIOLENT=0 STIFF=0 ASTRAY=0 SHUFFLED=0 ACCELERATED=0 | PER_THREAD=4 THREADS=8 EDGES=31 UNIFORM=3 PINNED=0 STRAIGHT=0 CLEAR=0 BODIES=0 TURNING=0 GROOMED=0 DAMPED=0 VIOLENT=1 STIFF=1 ASTRAY=0 SHUFFLED=1 ACCELERATED=1 | PER_THREAD=2 THREADS=16 EDGES=31 UNIFORM=0 PINNED=0 STRAIGHT=0 CLEAR=0 BODIES=1 TURNING=0 GROOMED=1 DAMPED=1 VIOLENT=1 STIFF=1 ASTRAY=0 SHUFFLED=1 ACCELERATED=1 | PER_THREAD=4 THREADS=32 EDGES=0 UNIFORM=0 PINNED=1 STRAIGHT=0 CLEAR=0 BODIES=1 TURNING=2 GROOMED=0 DAMPED=1 VIOLENT=1 STIFF=0 ASTRAY=1 SHUFFLED=0 ACCELERATED=0 | PER_THREAD=4 THREADS=32 EDGES=0 UNIFORM=0 PINNED=1 STRAIGHT=0 CLEAR=0 BODIES=0 TURNING=0 GROOMED=0 DAMPED=0 VIOLENT=0 STIFF=0 ASTRAY=0 SHUFFLED=0 ACCELERATED=0 | PER_THREAD=4 THREADS=8 EDGES=31 UNIFORM=3 PINNED=0 STRAIGHT=0 CLEAR=1 BODIES=0 TURNING=0 GROOMED=0 DAMPED=1 VIOLENT=0 STIFF=0 ASTRAY=0 SHUFFLED=1 ACCELERATED=0 | PER_THREAD=4 THREADS=8 EDGES=31 UNIFORM=3 PINNED=0 STRAIGHT=1 CLEAR=0 BODIES=0 TURNING=0 GROOMED=0 DAMPED=1 VIOLENT=0 STIFF=0 ASTRAY=0 SHUFFLED=1 ACCELERATED=0 | PER_THREAD=4 THREADS=4 EDGES=0 UNIFORM=0 PINNED=0 STRAIGHT=1 CLEAR=0 BODIES=0 TURNING=0 GROOMED=1 DAMPED=0 VIOLENT=1 STIFF=0 ASTRAY=0 SHUFFLED=0 ACCELERATED=1 | PER_THREAD=4 THREADS=2 EDGES=0 UNIFORM=0 PINNED=1 STRAIGHT=0 CLEAR=1 BODIES=0 TURNING=0 GROOMED=1 DAMPED=1 VIOLENT=0 STIFF=0 ASTRAY=0 SHUFFLED=0 ACCELERATED=1 | PER_THREAD=2 THREADS=16 EDGES=31 UNIFORM=0 PINNED=0 STRAIGHT=0 CLEAR=0 BODIES=1 TURNING=0 GROOMED=2 DAMPED=1 VIOLENT=1 STIFF=0 ASTRAY=0 SHUFFLED=1 ACCELERATED=0 | PER_THREAD=4 THREADS=8 EDGES=31 UNIFORM=0 PINNED=0 STRAIGHT=1 CLEAR=0 BODIES=0 TURNING=0 GROOMED=2 DAMPED=1 VIOLENT=0 STIFF=0 ASTRAY=0 SHUFFLED=1 ACCELERATED=0 | PER_THREAD=4 THREADS=8 EDGES=31 UNIFORM=2 PINNED=0 STRAIGHT=0 CLEAR=0 BODIES=0 TURNING=0 GROOMED=0 DAMPED=1 VIOLENT=0 STIFF=0 ASTRAY=0 SHUFFLED=1 ACCELERATED=0 | PER_THREAD=2 THREADS=16 EDGES=31 UNIFORM=2 PINNED=0 STRAIGHT=0 CLEAR=0 BODIES=1 TURNING=0 GROOMED=0 DAMPED=1 VIOLENT=1 STIFF=1 ASTRAY=0 SHUFFLED=1 ACCELERATED=0 | PER_THREAD=4 THREADS=8 EDGES=31 UNIFORM=2 PINNED=0 STRAIGHT=1 CLEAR=0 BODIES=0 TURNING=0 GROOMED=0 DAMPED=1 VIOLENT=1 STIFF=0 ASTRAY=0 SHUFFLED=1 ACCELERATED=0 | PER_THREAD=4 THREADS=8 EDGES=31 UNIFORM=1 PINNED=0 STRAIGHT=0 CLEAR=0 BODIES=0 TURNING=0 GROOMED=0 DAMPED=1 VIOLENT=0 STIFF=0 ASTRAY=0 SHUFFLED=1 ACCELERATED=0 | PER_THREAD=2 THREADS=16 EDGES=0 UNIFORM=1 PINNED=0 STRAIGHT=0 CLEAR=0 BODIES=1 TURNING=0 GROOMED=0 DAMPED=1 VIOLENT=1 STIFF=0 ASTRAY=1 SHUFFLED=0 ACCELERATED=0 | PER_THREAD=4 THREADS=4 EDGES=15 UNIFORM=1 PINNED=0 STRAIGHT=1 CLEAR=0 BODIES=0 TURNING=0 GROOMED=0 DAMPED=0 VIOLENT=1 STIFF=0 ASTRAY=0 SHUFFLED=0 ACCELERATED=0 | PER_THREAD=4 THREADS=8 EDGES=31 UNIFORM=2 PINNED=0 STRAIGHT=0 CLEAR=0 BODIES=0 TURNING=0 GROOMED=2 DAMPED=1 VIOLENT=0 STIFF=0 ASTRAY=0 SHUFFLED=1 ACCELERATED=0 | PER_THREAD=2 THREADS=16 EDGES=31 UNIFORM=1 PINNED=0 STRAIGHT=0 CLEAR=0 BODIES=1 TURNING=0 GROOMED=1 DAMPED=1 VIOLENT=1 STIFF=0 ASTRAY=0 SHUFFLED=1 ACCELERATED=0
// One step of strands as inextensible rods: core/rod_sweep.inl with the state in registers, PER_THREAD (2 or 4) edges per
// invocation, THREADS invocations per strand and several strands per workgroup. The sweeps along the strand become: own slots by
// elimination, then the strand's invocations together by cyclic reduction.
// EDGES: of every strand of the group, 0 where they differ. UNIFORM: 1: along each strand twist is in one ratio to bend;
// 2: and edges are of one length; 3: and of one mass.
// PINNED: more vertices than the roots are. STRAIGHT: there are no bodies, and strands are straight at rest and free at their tips; then they
// leave the frame of their first edge only (straight_frames.comp has the others). BODIES: there are some; then a dispatch does one substep, for
// which look.comp has looked at them, and lists strands for keep_out.comp; without, all of them. CLEAR: there are bodies, but it seems that none
// will come near these strands in the step; those that one may have come near after all are left to the others. TURNING: see bodies.glsl.
// GROOMED: there is a goal pull, or strands have factors that are not 1; then UNIFORM is not 3; 2 where those of damping and friction differ along
// strands. ACCELERATED: every vertex has an acceleration of its own.
// DAMPED: there is internal damping.
// VIOLENT: what violent motion takes would double the registers of every strand. So there are two dispatches: 0 does calm
// strands and lists the others, 1 does the same substeps of those, or of a whole group of few. ASTRAY: those among bodies whose vertices have to look at bodies
// again, too; these are few and take more than all else, so where there are many strands a third dispatch does them.
// STIFF: some strand is (isStiff in kernels/rod.h), or may be taut between pins; the pulls of such a one may be found by elimination.
// SHUFFLED: a workgroup is one subgroup, whose invocations can read each other's registers (gpu_compute/subgroups.h).
// What differs between invocations is chosen by select(), not by if.
#define WORKGROUP 32
// Calm strands have a program of their own only where they are many.
#define MANY (!VIOLENT)
#if MANY
#define SELECT_BY_MIX  // a tenth of their step on an H100; the other programs would take longer: docs/solver.md
#endif
layout(local_size_x = WORKGROUP) in;

#include "kernels/lanes_glsl.h"
#include "kernels/rotation.h"
#include "kernels/contact.h"
#include "kernels/distance_field.h"
#include "kernels/rod.h"
#if STRAIGHT
#include "kernels/straight_joint.h"
#endif
#if STIFF
#include "kernels/stiff_pulls.h"
#endif
#include "gpu_compute/shaders/step_input.glsl"
#include "gpu_compute/shaders/strand_offsets.glsl"
#if GROOMED
#include "kernels/grooming.h"
#include "gpu_compute/shaders/grooming.glsl"
#endif
#include "gpu_compute/shaders/strand_threads.glsl"
#include "gpu_compute/shaders/rod_work.glsl"
#include "gpu_compute/shaders/rod_strand.glsl"
#include "gpu_compute/shaders/root_poses.glsl"
#include "gpu_compute/shaders/root_motion.glsl"
#if !BODIES
#include "gpu_compute/shaders/placed_roots.glsl"
#endif
#include "gpu_compute/shaders/tridiagonal.glsl"
#include "gpu_compute/shaders/pentadiagonal.glsl"

// Of the present substep; entry p is of slot p, entries from PER_THREAD on are of the next invocation.
// How far vertices have come since the substep began, m: in small numbers, see RodScratch in core/rod_sweep.inl.
vec3 shift[PER_THREAD];
vec3 shift_in;                      // of the vertex before slot 0
vec3 tangent[PER_THREAD], tangent_in, tangent_out;
vec3 moment[PER_THREAD + 1];        // m^2/s^2
float stiffness[PER_THREAD + 2];    // of joints in the bending matrix
float edge_stiffness[PER_THREAD + 1];     // of edges in it
float softness[PER_THREAD], softness_in;  // of vertices, see curlSoftness
// The bending system, as solvePentadiagonal wants it; its right-hand sides, later its solution.
float diagonal[PER_THREAD], first[PER_THREAD - 1], second[PER_THREAD];
vec3 across;
vec3 force[PER_THREAD];             // m
float pull[PER_THREAD], pull_in, pull_out;  // m, of edges; in: before slot 0, out: after the last slot
float most;  // violence: of this invocation, of all substeps yet; where VIOLENT of this strand, in this substep
#if BODIES
vec3 pressing[PER_THREAD];            // m: StrandState::contacts x substep^2
vec3 normals[PER_THREAD], normal_in;  // of the bodies that vertices touch, else 0
bool meets;                           // of this invocation's vertices: a body is near in this substep, or has pressed one
float near_body;                      // of these: nearness() of a body
float speed_kept;                     // of this strand: the part of the substep's speeds that its vertices have, see slowed()
bool lost;                            // of these: isLost()
bool astray;                          // of these: isAstray()
#define NORMAL(p) normals[p]
#define NORMAL_IN normal_in
#else
#define NORMAL(p) vec3(0)
#define NORMAL_IN vec3(0)
#endif

#if PINNED || GROOMED
// Where the root frame, or the bone that it is pinned to, holds a vertex of the rest shape.
// `time`: the part of the step that has passed then.
vec3 heldPoint(uint vertex, Pose root, float time) {
  vec4 local = rest_local[vertex];
  if (local.w < 0.0) return bonePoint(local, time);
  return apply(root, local.xyz);
}
vec3 heldPoint(uint vertex, RootMotion root) { return heldPoint(vertex, Pose(root.position, root.rotation), root.time); }
#endif

// How far a vertex would go by itself, to its inertial point; pinned ones ride on the root frame.
vec3 inertialShift(vec3 position, vec3 velocity, float keep, float weight, uint vertex, RootMotion root) {
  vec3 way = madd(velocity, settings.substep * keep, root.jump);
#if PINNED
  if (weight == 0.0) way = heldPoint(vertex, root) - position;
#endif
  return way;
}

vec3 oldEdge(int p) { return x[p] - (p > 0 ? x[max(p - 1, 0)] : x_in); }
vec3 edgeShift(int p) { return shift[p] - (p > 0 ? shift[max(p - 1, 0)] : shift_in); }
vec3 newEdge(int p) { return oldEdge(p) + edgeShift(p); }

// Of the outer vertex of the edge of slot p or, where that is pinned, of the inner one: else the last edge before a pin would have another
// time blend than those before it, and tremble.
float freeWeight(int p) {
#if PINNED
  if (weight(p) == 0.0) return p > 0 ? weight(max(p - 1, 0)) : weight_in;
#endif
  return weight(p);
}

// Whether the inner end of the edge of slot p is held.
bool isAnchored(int p) {
#if PINNED
  if ((p > 0 ? weight(max(p - 1, 0)) : weight_in) == 0.0) return true;
#endif
  return p == 0 && rank == 0;
}

// The kept tension of the edge of slot p, and its tangent between the old edge and the inertial one, or `otherwise` where that has no
// direction. Returns the blend of the two; `unit_in`: of the old edge before it.
float predictEdge(int p, vec3 unit_in, vec3 otherwise) {
  float il = inverseLength(p);
  vec3 old = oldEdge(p), advance = edgeShift(p), edge = old + advance;
  tension[p] = min(keptTension(tension[p], advance * il, bends[p], il, settings.time2), most_tension);
  float kappa_here = stiffnessOf(bends[p], il, settings.time2, freeWeight(p));
#if UNIFORM < 2
  kappa_here = select(cut_unevenly, kappa(), kappa_here);
#endif
  float blend = timeBlend(advance * il, old * il - unit_in, kappa_here, kinked);
  tangent[p] = directionOr(madd(advance, -blend, edge), otherwise);
  return blend;
}

// The vertices at their inertial points.
void placeInertial(RootMotion root) {
  uint vertex = root_vertex + uint(min(rank * PER_THREAD, edges));
  shift_in = select(rank > 0, inertialShift(x_in, v_in, KEEP_IN, weight_in, vertex, root), root.position - x_in);
  for (int p = 0; p < PER_THREAD; ++p) {
    vertex = root_vertex + uint(min(rank * PER_THREAD + p + 1, edges));
    shift[p] = inertialShift(x[p], v[p], KEEP(p), weight(p), vertex, root);
  }
}

// What edges have in the bending matrix, and vertices in the metric of lengths; the arguments: of joints, of edges, of the second edge after
// the last slot.
void softenVertices(float margin[PER_THREAD + 1], float blend[PER_THREAD], vec3 tangent_out2) {
  for (int p = 0; p < PER_THREAD; ++p) {
    float il = inverseLength(p);
    edge_stiffness[p] = edgeMatrixStiffness(margin[p] + margin[p + 1], il, tension[p], blend[p]);
    vec3 t_in2 = p > 0 ? tangent[max(p - 1, 0)] : select(hasBefore(1), tangent_in, tangent[0]);
    vec3 t_out = p < kLast ? tangent[min(p + 1, kLast)] : tangent_out;
    vec3 t_out2 = p < kLast - 1 ? tangent[min(p + 2, kLast)] : p < kLast ? tangent_out : tangent_out2;
    t_out2 = select(isLast(p, 2), t_out, t_out2);
    float anchoring = edgeAnchoring(stiffness[p], margin[p], margin[p + 1]);
    float soft = curlSoftness(weight(p), stiffness[p + 1], il, t_in2, tangent[p], t_out, t_out2, select(isAnchored(p), anchoring, 0.0));
    softness[p] = select(isLast(p, 1), 0.0, soft);
  }
}

#if STRAIGHT
#include "gpu_compute/shaders/rod_straight.glsl"
#else
#include "gpu_compute/shaders/rod_twist.glsl"
#endif

// What the edge of slot p pushes its outer vertex with (x dt^2, m), while vertices are at the inertial points.
vec3 edgeForce(int p, RootMotion root) {
  float il = inverseLength(p);
  vec3 pushed = cross(moment[p + 1] - moment[p], tangent[p]) * (il * settings.time2) - tangent[p] * tension[p];
  if (p == 0) pushed += select(rank == 0, root.swing * (stiffness[0] * il), vec3(0));
  return pushed;
}

void makeBending(RootMotion root) {
  vec3 force_out;
  force[0] = edgeForce(0, root);
  send_a(vec4(force[0], edge_stiffness[0]));
  send_b(vec4(moment[0], 0));
  rendezvous();
  vec4 a = select(hasAfter(1), received_a(after(1)), vec4(0));
  vec3 b = select(hasAfter(1), received_b(after(1)).xyz, vec3(0));
  release();
  force_out = a.xyz;
  edge_stiffness[PER_THREAD] = a.w;
  moment[PER_THREAD] = b;
  for (int p = 1; p < PER_THREAD; ++p) force[p] = edgeForce(p, root);

  const vec3 fall = settings.gravity.xyz * settings.time2 +
                    settings.wind.xyz * (settings.substep * (1.0 - settings.keep)) - root.jump;
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
    vec3 way = madd(driven, time2s[p] - settings.time2, madd(settings.wind.xyz, settings.substep * (settings.keep - keeps[p]), pulled));
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

// What the forces move in the bending system.
void solveBending(out vec3 moved[PER_THREAD]) {
#if PER_THREAD == 2 && THREADS > 8 || THREADS > 16
  // Over many invocations the reduction cancels stiffnesses down to a mass: its solution is refined once.
  vec3 left[PER_THREAD] = force;
  for (int p = 0; p < PER_THREAD; ++p) moved[p] = vec3(0);
  for (int round = 0; round < REPEATS(2); ++round) {
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

// Whether this holds for any invocation of the strand.
bool ofStrand(bool own) { return strandSum(own ? 1.0 : 0.0) > 0.0; }

#if VIOLENT || BODIES
// Whether this, which all invocations of a strand agree on, holds for any strand of the workgroup.
bool anyStrand(bool own) {
  float strands = own ? 1.0 : 0.0;
  for (uint distance = uint(THREADS); distance < uint(WORKGROUP); distance *= 2u) {
    send_d(strands);
    rendezvous();
    strands += received_d(me ^ distance);
    release();
  }
  return strands > 0.0;
}
#endif

#if BODIES
#include "gpu_compute/shaders/rod_contact.glsl"
#elif CLEAR
#include "gpu_compute/shaders/rod_clear.glsl"
#endif

#if VIOLENT
// The pulls of violent motion, and what they move, found by conjugate gradients. Leaves none for moveByPulls(), and the second
// length system in the metric of the masses. Of other strands only the barriers are wanted.
void pullThroughBending(bool violent) {
  const float calm_in = violent ? 0.0 : pull_in, calm_out = violent ? 0.0 : pull_out;
  float calm[PER_THREAD], excess[PER_THREAD], conjugate[PER_THREAD];
  float slack[PER_THREAD], lower[PER_THREAD], pivot[PER_THREAD];
  lengthRows(slack, lower, pivot);
  diagonalToSlack(slack, lower);
  float product = 0.0;
  for (int p = 0; p < PER_THREAD; ++p) {
    excess[p] = toMend(p, dot(newEdge(p), tangent[p]));
    calm[p] = violent ? 0.0 : pull[p];
    conjugate[p] = 0.0;
    product = madd(excess[p], pull[p], product);
    if (violent) softness[p] = 0.0;
  }
  if (violent) softness_in = 0.0;
  product = strandSum(product);
  float kept = 0.0;  // of the last direction
  for (int iteration = 1; iteration <= REPEATS(kPullIterations); ++iteration) {
    for (int p = 0; p < PER_THREAD; ++p) pull[p] = conjugate[p] = madd(conjugate[p], kept, pull[p]);
    send_d(pull[0]);
    rendezvous();
    pull_out = received_d(after(1));
    release();
    if (!hasAfter(1)) pull_out = 0.0;
    for (int p = 0; p < PER_THREAD; ++p) force[p] = isEdge(p) && weight(p) > 0.0 ? pushOn(p, 0.0) : vec3(0);
    vec3 moved[PER_THREAD];
    solveBending(moved);
    for (int p = 0; p < PER_THREAD; ++p) moved[p] = weight(p) > 0.0 ? held(moved[p], NORMAL(p)) : vec3(0);
    send_a(vec4(moved[kLast], 0));
    rendezvous();
    vec3 moved_in = received_a(before(1)).xyz;
    if (!hasBefore(1)) moved_in = vec3(0);
    release();
    float shortened[PER_THREAD];
    float curvature = 0.0;
    for (int p = 0; p < PER_THREAD; ++p) {
      shortened[p] = isEdge(p) ? dot(tangent[p], moved_in - moved[p]) : 0.0;
      curvature = madd(conjugate[p], shortened[p], curvature);
      moved_in = moved[p];
    }
    float way = conjugateStep(product, strandSum(curvature));
    for (int p = 0; p < PER_THREAD; ++p) {
      if (violent) {
        shift[p] = madd(moved[p], way, shift[p]);
        tension[p] = madd(conjugate[p], way, tension[p]);
      }
      excess[p] -= way * shortened[p];
    }
    if (iteration == kPullIterations) break;
    pull = excess;
    solveTridiagonal(slack, lower, pivot, pull);
    float next = 0.0;
    for (int p = 0; p < PER_THREAD; ++p) next = madd(excess[p], pull[p], next);
    next = strandSum(next);
    kept = conjugateStep(next, product);
    product = next;
  }
  pull = calm;
  pull_in = calm_in;
  pull_out = calm_out;
}
#endif

#if STIFF
#include "gpu_compute/shaders/rod_stiff.glsl"
#endif

// After the first pass over lengths: whether the strand needs another, because it is violent or a body is near. The pulls of
// violent ones go through bending. `pressed`: by a body.
bool needsAgain(bool pressed) {
  bool needs = false;
#if STIFF
  most = strandMax(mostViolence());
  needs = isViolent(most, borne) && !taut;
  const bool eliminated = isEliminated(kappa(), most, borne, pressed) || taut;
  if (anyStrand(eliminated)) pullByElimination(eliminated);
  if (anyStrand(needs && !eliminated)) pullThroughBending(needs && !eliminated);
#elif VIOLENT
  most = strandMax(mostViolence());
  needs = isViolent(most, borne);
  if (anyStrand(needs)) pullThroughBending(needs);
#else
  most = max(most, mostViolence());
#endif
#if BODIES
  const bool meet = ofStrand(meets);
  needs = needs || meet;
#endif
  return needs;
}

// Of a strand that only goes along with others of its workgroup; nothing comes out otherwise for them. `pulled_in`: shift_in
// as the last pass left it, to the bit.
void leavePulls(vec3 pulled_in) {
  for (int p = 0; p < PER_THREAD; ++p) pull[p] = 0.0;
  pull_in = pull_out = 0.0;
  shift_in = pulled_in;
}

// Every vertex moved by its pulls.
void moveByPulls() {
  for (int p = 0; p < PER_THREAD; ++p) {
    tension[p] += pull[p];
    shift[p] = madd(pushOn(p, softness[p]), weight(p), shift[p]);
  }
  // The same for the vertex before slot 0, which saves an exchange.
  const vec3 push_in = held(pushOfPulls(tangent_in, pull_in, tangent[0], pull[0], softness_in), NORMAL_IN);
  shift_in = select(hasBefore(1), madd(push_in, weight_in, shift_in), shift_in);
}

#include "gpu_compute/shaders/rod_finish.glsl"

// Lists the strand; its place in the list.
uint listStrand(uint count, uint list) {
  uint at = atomicAdd(work[count], 1u);
  work[list + at] = strand;
  return at;
}
// The same for a dispatch, which gets a workgroup more for every kStrands of them: see work[].
void leaveStrand(uint count, uint list) {
  uint at = listStrand(count, list);
  if (at % kStrands == 0u && at / kStrands < kMostWorkgroups) atomicAdd(work[count - 3u], 1u);
}

void store() {
  storeStrand();
#if BODIES
  storeContacts();
#endif
}

// The step of kStrands strands, from number `first` of the `count` that stand in work[] from `list` on.
void stepStrands(uint list, uint first, uint count) {
  loadStrand(list, first, count);
  most = 0.0;
#if VIOLENT || BODIES
  const int passes = settings.substeps > 0u ? 2 : 0;  // of lengths, at most; compilers would unroll a 2
#else
  const int passes = 1;
#endif
#if CLEAR
  loadBodies();
#endif
#if BODIES
  astray = false;
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
    vec3 moved[PER_THREAD];  // by forces
    moveByForces(moved);
#if BODIES
    vec3 checked[PER_THREAD];  // the shifts that contact leaves the vertices with
    for (int p = 0; p < PER_THREAD; ++p) normals[p] = vec3(0);
    meets = false;
    near_body = 0.0;
    speed_kept = 1.0;
    const bool pressed = pressThroughBending(substep, moved);
#else
    const bool pressed = false;
#endif
    bool again = true;  // this strand has its lengths solved in this pass
    for (int pass = 0; pass < passes; ++pass) {
#if BODIES
      if (again && pass > 0) collide(substep);
#endif
      const vec3 pulled_in = shift_in;
      solveLengths(root);
      if (!again) leavePulls(pulled_in);
#if BODIES
      if (again) checked = shift;
#endif
      if (pass == 0) again = needsAgain(pressed);
      moveByPulls();
#if VIOLENT || BODIES
      if (pass == 0 && !anyStrand(again)) break;
#endif
    }
#if BODIES
    finish(checked);
#else
    finish();
#endif
#if CLEAR
    addWays(substep);
#endif
  }
#if STRAIGHT
  const RootMotion last = placedRoot((end_substep - first_substep - 1) % THREADS, 1.0);
  first_frame = transportTo(last.inner_frame, last.tangent_old, directionOr(oldEdge(0), last.tangent_old));
#endif
  bool stays = exists;
#if BODIES && !ASTRAY
  if (ofStrand(astray)) {
    if (stays && rank == 0) leaveStrand(astray_count, astray_list);
    stays = false;
  }
#endif
#if !VIOLENT
  bool leaves = isViolent(most, borne) || taut;
#if CLEAR
  vec4 looked[PER_THREAD];
  leaves = comesNear(looked) || leaves;
#endif
  if (ofStrand(leaves)) {
    if (stays && rank == 0) {
#if CLEAR
      contacts[sightAt(root_vertex, kLooked)].x = kNear;
      listStrand(left_count, left_list);
#else
      leaveStrand(left_count, left_list);
#endif
    }
    stays = false;
  }
#endif
#if BODIES
  if (ofStrand(lost) && stays && rank == 0) listStrand(lost_count, lost_list);
#endif
  if (stays) store();
#if CLEAR
  if (stays) storeSights(looked);
#endif
  storeGuides(stays);
}

void main() {
  const uint workgroup = gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x;
  const uint count = own_count == kWholeGroup ? strands_in_group : work[own_count];
#if VIOLENT
  const uint workgroups = gl_NumWorkGroups.x * gl_NumWorkGroups.y;
  for (uint first = workgroup * kStrands; first < count; first += workgroups * kStrands) stepStrands(own_list, first, count);
#else
  if (workgroup * kStrands < count) stepStrands(own_list, workgroup * kStrands, count);
#endif
}
