#version 450
// variants: THREADS=1 EDGES=0 UNIFORM=0 PINNED=1 BODIES=1 GROOMED=1 | THREADS=8 EDGES=31 UNIFORM=1 PINNED=0 BODIES=0 GROOMED=0 | THREADS=8 EDGES=31 UNIFORM=0 PINNED=0 BODIES=1 GROOMED=1 | THREADS=32 EDGES=0 UNIFORM=0 PINNED=1 BODIES=0 GROOMED=0
// One step of strands as inextensible rods, all substeps in one dispatch: core/rod_sweep.inl with the state in registers,
// four edges per invocation, THREADS invocations per strand and several strands per workgroup. The sweeps along the strand
// become: own slots by elimination, then the strand's invocations together by cyclic reduction.
// EDGES: of every strand of the group, 0 where they differ. UNIFORM: edges of one length and mass along each strand.
// PINNED: more vertices than the roots are. BODIES: there are some. GROOMED: there is a goal pull, or strands have
// factors that are not 1; then UNIFORM is 0.
#define WORKGROUP 32
layout(local_size_x = WORKGROUP) in;

#include "kernels/lanes_glsl.h"
#include "kernels/rotation.h"
#include "kernels/contact.h"
#include "kernels/rod.h"
#include "gpu_compute/shaders/step_input.glsl"
#if GROOMED
#include "kernels/grooming.h"
#include "gpu_compute/shaders/grooming.glsl"
#endif
#include "gpu_compute/shaders/strand_threads.glsl"
#include "gpu_compute/shaders/rod_strand.glsl"
#include "gpu_compute/shaders/root_motion.glsl"
#include "gpu_compute/shaders/tridiagonal.glsl"
#include "gpu_compute/shaders/pentadiagonal.glsl"
#include "gpu_compute/shaders/bounded_lengths.glsl"
#if BODIES
#include "gpu_compute/shaders/bodies.glsl"
#endif

// Of the present substep; entry p is of slot p, entries from PER_THREAD on are of the next invocation.
vec3 x_new[PER_THREAD];             // m
vec3 x_new_in;                      // of the vertex before slot 0
vec3 tangent[PER_THREAD], tangent_in;
vec3 moment[PER_THREAD + 1];        // m^2/s^2
float stiffness[PER_THREAD + 2];    // of joints in the bending matrix
float edge_stiffness[PER_THREAD + 1];     // of edges in it
float softness[PER_THREAD], softness_in;  // of vertices, see tensionSoftness
#if BODIES
vec3 normals[PER_THREAD], normal_in;  // of the bodies that vertices touch, else 0
#define NORMAL(p) normals[p]
#define NORMAL_IN normal_in
#else
#define NORMAL(p) vec3(0)
#define NORMAL_IN vec3(0)
#endif

#if PINNED || GROOMED
// Where the root frame, or the bone that it is pinned to, holds a vertex of the rest shape.
vec3 heldPoint(uint vertex, RootMotion root) {
  vec4 local = rest_local[vertex];
  if (local.w < 0.0) return bonePoint(local, root.time);
  return rotate(root.rotation, local.xyz) + root.position;
}
#endif

// Where a vertex would go by itself; pinned ones ride on the root frame.
vec3 inertialPoint(vec3 position, vec3 velocity, float keep, float weight, uint vertex, RootMotion root) {
  vec3 moved = madd(velocity, settings.substep * keep, position) + root.jump;
#if PINNED
  if (weight == 0.0) moved = heldPoint(vertex, root);
#endif
  return moved;
}

vec3 oldEdge(int p) { return x[p] - (p > 0 ? x[max(p - 1, 0)] : x_in); }
vec3 newEdge(int p) { return x_new[p] - (p > 0 ? x_new[max(p - 1, 0)] : x_new_in); }

// The kept tension of the edge of slot p, its tangent between the old edge and the inertial one, its frame carried along.
// Returns the blend of the two; `unit_in`: of the old edge before it.
float predictEdge(int p, vec3 unit_in) {
  const float dt2 = settings.substep * settings.substep;
  float il = inverseLength(p);
  vec3 edge = newEdge(p), old = oldEdge(p), advance = edge - old;
  tension[p] = min(keptTension(tension[p], advance * il, bend(p), il, dt2), most_tension);
  float blend = timeBlend(advance * il, old * il - unit_in, bend(p) * il * il * dt2 * weight(p));
  // Internal damping acts through frames that are ahead of the motion by the damping time; tension is not damped.
  float ahead = DAMPING_TIME * settings.per_substep;
  tangent[p] = directionOr(madd(advance, ahead - blend, edge), frameTangent(frame[p]));
  frame[p] = transportTo(frame[p], tangent[p]);
  return blend;
}

// Inertial points and what follows from them for each edge. Returns the frame before slot 0.
vec4 predict(RootMotion root, out float blend[PER_THREAD]) {
  uint vertex = root_vertex + uint(min(rank * PER_THREAD, edges));
  x_new_in = rank > 0 ? inertialPoint(x_in, v_in, KEEP_IN, weight_in, vertex, root) : root.position;
  for (int p = 0; p < PER_THREAD; ++p) {
    vertex = root_vertex + uint(min(rank * PER_THREAD + p + 1, edges));
    x_new[p] = inertialPoint(x[p], v[p], KEEP(p), weight(p), vertex, root);
  }
  for (int p = 1; p < PER_THREAD; ++p) blend[p] = predictEdge(p, oldEdge(p - 1) * inverseLength(p - 1));
  exchange_a[me] = frame[kLast];
  exchange_b[me].xyz = tangent[kLast];
  exchange_c[me].xyz = oldEdge(kLast) * inverseLength(kLast);
  barrier();
  vec4 frame_in = exchange_a[before(1)];
  tangent_in = exchange_b[before(1)].xyz;
  vec3 unit_in = exchange_c[before(1)].xyz;
  barrier();
  if (!hasBefore(1)) {
    frame_in = root.inner_frame;
    tangent_in = unit_in = root.tangent_old;
  }
  blend[0] = predictEdge(0, unit_in);
  return frame_in;
}

// What joints and edges put into the bending matrix; the frames twisted to where the torques balance; then the moments.
void solveTwist(vec4 frame_in, float blend[PER_THREAD]) {
  vec3 strain[PER_THREAD];
  float margin[PER_THREAD + 1], cosine[PER_THREAD + 1];  // of the angle at joints
  float slack[PER_THREAD], lower[PER_THREAD], pivot[PER_THREAD], turn[PER_THREAD];
  float own_first, torque_first;  // what joint 0 adds to the last row of the invocation before
  vec4 inner = frame_in;
  vec3 t_in = tangent_in;
  for (int p = 0; p < PER_THREAD; ++p) {
    strain[p] = jointStrain(inner, frame[p]);
    vec3 excess = strain[p] - rest_strain[p];
    float c = dot(t_in, tangent[p]);
    float time2 = settings.substep * madd(implicitShare(blend[p]), settings.substep, DAMPING_TIME);
    stiffness[p] = bendMatrixStiffness(bend(p), c, time2);
    margin[p] = bendMatrixMargin(stiffness[p], c, excess);
    cosine[p] = c;
    float coupling = twistOfBending(strain[p], excess, bend(p)), shear = torqueDifference(strain[p], excess, bend(p));
    float own = twist(p) + coupling, torque = madd(twist(p), excess.z, shear);
    float less = 2.0 * min(coupling, twist(p));  // own less the absolute coupling, without its rounding
    slack[p] = p > 0 || hasBefore(1) ? less : own;
    lower[p] = coupling - twist(p);
    turn[p] = shear - twist(p) * excess.z;
    pivot[p] = 1e-30;
    if (p > 0) {
      slack[p - 1] += less;
      turn[p - 1] += torque;
    } else {
      own_first = own;
      torque_first = torque;
    }
    inner = frame[p];
    t_in = tangent[p];
  }
  if (!hasBefore(1)) lower[0] = 0.0;

  exchange_a[me] = vec4(stiffness[0], stiffness[1], margin[0], cosine[0]);
  exchange_b[me].xy = vec2(own_first, torque_first);
  barrier();
  vec4 a = exchange_a[after(1)];
  vec2 b = exchange_b[after(1)].xy;
  barrier();
  if (!hasAfter(1)) {
    a = vec4(0);
    b = vec2(0);
  }
  stiffness[PER_THREAD] = a.x;
  stiffness[PER_THREAD + 1] = a.y;
  margin[PER_THREAD] = a.z;
  cosine[PER_THREAD] = a.w;
  slack[kLast] += b.x;
  turn[kLast] += b.y;
  for (int p = 0; p < PER_THREAD; ++p) {
    float il = inverseLength(p);
    edge_stiffness[p] = edgeMatrixStiffness(margin[p] + margin[p + 1], il, tension[p], blend[p]);
    softness[p] = isTip(p) ? 0.0 : tensionSoftness(mass(p), stiffness[p + 1], edge_stiffness[p], il, cosine[p + 1]);
    if (!isEdge(p)) {
      slack[p] = 1.0;
      lower[p] = turn[p] = 0.0;
    }
  }

  float turn_in = clamp(solveTridiagonal(slack, lower, pivot, turn), -1.0, 1.0);
  inner = twistFrame(frame_in, turn_in);
  for (int p = 0; p < PER_THREAD; ++p) {
    turn[p] = clamp(turn[p], -1.0, 1.0);
    strain[p] = twistedStrain(strain[p], turn_in, turn[p]);
    moment[p] = jointMoment(inner, strain[p], strain[p] - rest_strain[p], bend(p), twist(p));
    inner = frame[p] = twistFrame(frame[p], turn[p]);
    turn_in = turn[p];
  }
}

// What the edge of slot p pushes its outer vertex with (x dt^2, m), while x_new are the inertial points.
vec3 edgeForce(int p, RootMotion root) {
  const float dt2 = settings.substep * settings.substep;
  float il = inverseLength(p);
  float ahead = DAMPING_TIME * settings.per_substep;
  vec3 direction = madd(newEdge(p) - oldEdge(p), -ahead * il, tangent[p]);
  vec3 force = cross(moment[p + 1] - moment[p], tangent[p]) * (il * dt2) - direction * tension[p];
  if (p == 0 && rank == 0) force += root.swing * (stiffness[0] * il);
  return force;
}

void solveBending(RootMotion root) {
  vec3 force[PER_THREAD], force_out;
  force[0] = edgeForce(0, root);
  exchange_a[me] = vec4(force[0], edge_stiffness[0]);
  exchange_b[me].xyz = moment[0];
  barrier();
  vec4 a = exchange_a[after(1)];
  vec3 b = exchange_b[after(1)].xyz;
  barrier();
  if (!hasAfter(1)) {
    a = vec4(0);
    b = vec3(0);
  }
  force_out = a.xyz;
  edge_stiffness[PER_THREAD] = a.w;
  moment[PER_THREAD] = b;
  for (int p = 1; p < PER_THREAD; ++p) force[p] = edgeForce(p, root);

  const vec3 pull = settings.gravity.xyz * (settings.substep * settings.substep) +
                    settings.wind.xyz * (settings.substep * (1.0 - settings.keep)) - root.jump;
  float il[PER_THREAD + 1];
  for (int p = 0; p < PER_THREAD; ++p) il[p] = inverseLength(p);
  il[PER_THREAD] = inverseLengthOut();
  float diagonal[PER_THREAD], first[PER_THREAD - 1], second[PER_THREAD - 2];
  for (int p = 0; p < PER_THREAD; ++p) {
    vec3 outer = p < kLast ? force[min(p + 1, kLast)] : force_out;
#if GROOMED
    vec3 way = madd(settings.wind.xyz, settings.substep * (settings.keep - keeps[p]), pull);
    vec3 goal = heldPoint(root_vertex + uint(min(rank * PER_THREAD + p + 1, edges)), root);
    vec3 total = force[p] - outer;
    if (weight(p) > 0.0) total += goalPull(way, mass(p), goal_stiffness[p], goal, x_new[p]);
#else
    vec3 total = madd(pull, weight(p) > 0.0 ? mass(p) : 0.0, force[p] - outer);
#endif
    force[p] = isEdge(p) ? total : vec3(0);
    float own = mass(p) + bendOwn(stiffness[p], stiffness[p + 1], stiffness[p + 2], il[p], il[p + 1]);
    diagonal[p] = isEdge(p) ? own + edge_stiffness[p] + edge_stiffness[p + 1] : 1.0;
  }
  for (int p = 0; p < PER_THREAD - 1; ++p)
    first[p] = bendAcross(stiffness[p + 1], stiffness[p + 2], il[p], il[p + 1], il[p + 2]) - edge_stiffness[p + 1];
  for (int p = 0; p < PER_THREAD - 2; ++p) second[p] = bendAcrossTwo(stiffness[p + 2], il[p + 1], il[p + 2]);
  vec3 across = vec3(bendAcrossTwo(stiffness[0], inverseLengthIn(), il[0]),
                     bendAcross(stiffness[0], stiffness[1], inverseLengthIn(), il[0], il[1]) - edge_stiffness[0],
                     bendAcrossTwo(stiffness[1], il[0], il[1]));
  // On a long strand the reduction cancels stiffnesses down to a mass: its solution is refined once.
  const int solves = THREADS > 16 ? 2 : 1;
  for (int i = 0; i < solves; ++i) {
    vec3 moved[PER_THREAD] = force;
    solvePentadiagonal(diagonal, first, second, across, moved);
    for (int p = 0; p < PER_THREAD; ++p) x_new[p] += moved[p];
    if (i + 1 < solves) residual(diagonal, first, second, across, moved, force);
  }
}

#if BODIES
// Pushes vertices out of the bodies; the normals are kept for the length solve, which must not push them back in.
void collide(float time) {
  for (uint i = 0u; i < settings.primitive_count; ++i) {
    SubstepBody body = bodyAt(i, time);
#if GROOMED
    body.friction *= strand_grooming.x;
#endif
    for (int p = 0; p < PER_THREAD; ++p)
      if (weight(p) > 0.0) pushOut(body, x[p], x_new[p], normals[p]);
  }
}
#endif

// The rows of the length system, and of the softened one for the change of the tensions.
void lengthRows(out float diagonal[PER_THREAD], out float lower[PER_THREAD], out float softened[PER_THREAD],
                out float softened_lower[PER_THREAD], out float pivot[PER_THREAD], out float excess[PER_THREAD]) {
  vec3 inner = x_new_in, t_in = tangent_in, n_in = NORMAL_IN;
  float w_in = hasBefore(1) ? weight_in : 0.0, soft_in = softness_in, own_before = weightAlong(t_in, n_in, w_in);
  for (int p = 0; p < PER_THREAD; ++p) {
    float own_in = weightAlong(tangent[p], n_in, w_in), own = weightAlong(tangent[p], NORMAL(p), weight(p));
    diagonal[p] = isEdge(p) ? own_in + own : 1.0;
    softened[p] = isEdge(p) ? own_in * (1.0 - soft_in) + own * (1.0 - softness[p]) : 1.0;
    lower[p] = isEdge(p) && (p > 0 || hasBefore(1)) ? lengthAcross(tangent[p], t_in, n_in, w_in) : 0.0;
    softened_lower[p] = softenedAcross(lower[p], own_before, own_in, soft_in);
    pivot[p] = lengthPivot(w_in, weight(p));
    excess[p] = isEdge(p) ? dot(x_new[p] - inner, tangent[p]) - restLength(p) : 0.0;
    inner = x_new[p];
    t_in = tangent[p];
    n_in = NORMAL(p);
    w_in = weight(p);
    soft_in = softness[p];
    own_before = own;
  }
}

// Whether a solution goes beyond its bounds; it is held to them.
bool bound(inout float pull[PER_THREAD]) {
  bool beyond = false;
  for (int p = 0; p < PER_THREAD; ++p) {
    float bounded = boundedPull(pull[p], restLength(p));
    beyond = beyond || (isEdge(p) && bounded != pull[p]);
    pull[p] = bounded;
  }
  return beyond;
}

// One Newton step towards the rest lengths. The first of a substep changes the tensions by the softened system's solution.
void solveLengths(RootMotion root, bool first) {
  for (int p = 1; p < PER_THREAD; ++p) tangent[p] = directionOr(x_new[p] - x_new[p - 1], tangent[p]);
  forgetBeyondBound();
  exchange_a[me] = vec4(x_new[kLast], softness[kLast]);
  exchange_b[me].xyz = tangent[kLast];
#if BODIES
  exchange_c[me].xyz = normals[kLast];
#endif
  barrier();
  x_new_in = exchange_a[before(1)].xyz;
  softness_in = exchange_a[before(1)].w;
  tangent_in = exchange_b[before(1)].xyz;
#if BODIES
  normal_in = exchange_c[before(1)].xyz;
#endif
  barrier();
  if (!hasBefore(1)) {
    x_new_in = root.position;
    softness_in = 0.0;
#if BODIES
    normal_in = vec3(0);
#endif
  }
  tangent[0] = directionOr(x_new[0] - x_new_in, tangent[0]);

  float diagonal[PER_THREAD], lower[PER_THREAD], softened[PER_THREAD], softened_lower[PER_THREAD];
  float pivot[PER_THREAD], pull[PER_THREAD];
  lengthRows(diagonal, lower, softened, softened_lower, pivot, pull);
  float change[PER_THREAD] = pull;
  diagonalToSlack(diagonal, lower);
  diagonalToSlack(softened, softened_lower);
  float pull_in = solveTridiagonal(diagonal, lower, pivot, pull);
  if (first) solveTridiagonal(softened, softened_lower, pivot, change);
  if (bound(pull)) noteBeyondBound();
  exchange_a[me].xyz = tangent[0] * pull[0];
  barrier();
  vec3 push_out = exchange_a[after(1)].xyz;
  bool any_beyond = any_beyond_bound != 0u;
  barrier();
  if (any_beyond) {  // the same for the whole workgroup
    float excess[PER_THREAD];
    lengthRows(diagonal, lower, softened, softened_lower, pivot, excess);
    pull_in = solveBounded(diagonal, lower, excess, !first, pull, pull_in);
    exchange_a[me].xyz = tangent[0] * pull[0];
    barrier();
    push_out = exchange_a[after(1)].xyz;
    barrier();
  }
  pull_in = boundedPull(pull_in, lengthIn());
  if (!hasAfter(1)) push_out = vec3(0);

  vec3 push[PER_THREAD + 1];
  for (int p = 0; p < PER_THREAD; ++p) {
    // In violent motion not much more than what the masses take.
    float most = max(4.0 * abs(pull[p]), 0.02 * most_tension);
    tension[p] += first ? clamp(change[p], -most, most) : pull[p];
    push[p] = tangent[p] * pull[p];
  }
  push[PER_THREAD] = push_out;
  for (int p = 0; p < PER_THREAD; ++p)
    x_new[p] = madd(alongSurface(push[p + 1] - push[p], NORMAL(p)), weight(p), x_new[p]);
  // The same for the vertex before slot 0, which saves an exchange.
  if (hasBefore(1)) x_new_in = madd(alongSurface(push[0] - tangent_in * pull_in, NORMAL_IN), weight_in, x_new_in);
}

// Exact lengths along the directions found, from the root or the last pinned vertex on: a scan. Then velocities.
void finish(RootMotion root) {
  vec3 along[PER_THREAD];  // from the root, or from the vertex before slot 0
  bool anchored[PER_THREAD];
  vec3 sum = vec3(0), inner = x_new_in;
  bool fixed_here = false;
  for (int p = 0; p < PER_THREAD; ++p) {
    sum = madd(directionOr(x_new[p] - inner, tangent[p]), restLength(p), sum);
#if PINNED
    if (weight(p) == 0.0) {
      sum = x_new[p] - root.position;
      fixed_here = true;
    }
#endif
    inner = x_new[p];
    along[p] = sum;
    anchored[p] = fixed_here;
  }
  vec3 offset = vec3(0);
#if THREADS > 1
  for (int doubling = 0; doubling < kDoublings; ++doubling) {
    int distance = 1 << doubling;
    exchange_a[me] = vec4(sum, fixed_here ? 1 : 0);
    barrier();
    vec4 other = exchange_a[before(distance)];
    barrier();
    if (hasBefore(distance) && !fixed_here) {
      sum += other.xyz;
      fixed_here = other.w > 0.5;
    }
  }
#if PINNED
  exchange_a[me].xyz = sum;
  barrier();
  offset = exchange_a[before(1)].xyz;
  barrier();
  if (!hasBefore(1)) offset = vec3(0);
#else
  offset = sum - along[kLast];
#endif
#endif
  vec3 start = root.position + offset;
  v_in = (start - x_in) * settings.per_substep;
  x_in = start;
  for (int p = 0; p < PER_THREAD; ++p) {
    vec3 placed = along[p] + (anchored[p] ? root.position : start);
    v[p] = (placed - x[p]) * settings.per_substep;
    x[p] = placed;
  }
}

void main() {
  loadStrand();
  for (int substep = 0; substep < int(settings.substeps); ++substep) {
    int ahead = substep % THREADS;
    if (ahead == 0) placeRoots(substep);
    RootMotion root = rootMotion(ahead, timeAfter(substep));
    float blend[PER_THREAD];
    vec4 frame_in = predict(root, blend);
    solveTwist(frame_in, blend);
    solveBending(root);
#if BODIES
    for (int p = 0; p < PER_THREAD; ++p) normals[p] = vec3(0);
#endif
    for (int iteration = 0; iteration < 2; ++iteration) {
#if BODIES
      collide(timeAfter(substep));
#endif
      solveLengths(root, iteration == 0);
    }
    finish(root);
  }
  storeStrand();
}
