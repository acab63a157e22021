#version 450
// Guides of one run as the symbols of a chunk: encoding 1 (delta16) in blocks of bits, docs/wire.md, "Payloads".
// Reads: guides, the grid. Writes: symbols (scratch), packed runs. One workgroup per run. The CPU's counterparts are
// ChunkEncoder and encodeDelta() of transport/codec/, and both give the same bytes: sums and products are `precise` and in
// the order of LaneFrame. Where a GPU flushes denormal numbers, errors below 1e-19 m count as 0.
layout(local_size_x = 256) in;
const uint kInvocations = 256u;

const uint kPair = 16u;                                       // numbers: two blocks of eight
const uint kMaxPairBytes = 33u;                               // a byte of widths, and 16 numbers of 16 bits
const uint kLine = 32u;                                       // words that are stored together
const uint kFirstEdge = 0x80000000u, kSampled = 0x40000000u;  // bits of edge_vertices
const uint kHeadBytes = 8u;                                   // of a payload, before its symbols
const float kMaxGridIndex = 4194304.0;
const float kFarthest = 1e15;  // m; no grid reaches as far

layout(std430, binding = 0) readonly buffer Guides { float guides[]; };   // 3 per vertex, m
layout(std430, binding = 1) readonly buffer Offsets { uint offsets[]; };  // first vertex per strand
// 2 per run: first strand, strands, first vertex, vertices; first of its quads of symbols.
layout(std430, binding = 2) readonly buffer Runs { uvec4 runs[]; };
// Per edge, strand after strand: the vertex at its end; kFirstEdge: of its strand; kSampled: its strand is one of every 16th
// of the run.
layout(std430, binding = 3) readonly buffer Edges { uint edge_vertices[]; };
layout(std430, binding = 4) readonly buffer RestRoots { int rest_roots[]; };  // 3 per strand
// Bits 0 to 15: a symbol; bit 16: the first of its strand and plane, or padding. Roots, then edges, each starting a pair.
// One buffer, written number by number and read by fours: a driver may write four where one component is stored.
layout(std430, binding = 5) coherent buffer Symbols { uint symbols[]; };
layout(std430, binding = 7) coherent buffer SymbolQuads { uvec4 symbol_quads[]; };
// Four words: the first word that no run has taken yet (its start value is the caller's); 0, 0, 0. Per run four words: bytes
// of data, 0 if the run is not packed; 1 if edges are predicted from the edge before; bits of the largest squared error;
// first word of its data. Then the runs' data, each from a multiple of kLine words on, in the order in which they come.
layout(std430, binding = 6) buffer Packed { uint payloads[]; };
layout(location = 0) uniform float rotation[9];  // of the head, row after row
layout(location = 9) uniform vec3 head;          // m, world
layout(location = 10) uniform vec3 origin;       // m, world: of the guides' coordinates
layout(location = 11) uniform vec3 grid;         // step, m; 1 / step; largest squared error of a vertex, m^2

shared uint lost, worst_bits, bits_alone, bits_along, bytes_of_all, first_word;
shared uint sums[2][kInvocations];
shared uint window[(kInvocations * kMaxPairBytes + 3u) / 4u + 2u * kLine];  // bytes of a batch of pairs, from a line's start
uint rest;  // of the window, for the next batch; global, because Mesa may move a read of shared memory past a barrier

vec3 worldAt(uint vertex) {
  precise vec3 world = vec3(guides[3u * vertex], guides[3u * vertex + 1u], guides[3u * vertex + 2u]) + origin;
  return world;
}

// By bits: compilers may assume that floats are finite.
bool isWithinReach(vec3 world) {
  const uvec3 magnitude = floatBitsToUint(world) & 0x7fffffffu;
  return max(magnitude.x, max(magnitude.y, magnitude.z)) < floatBitsToUint(kFarthest);
}

ivec3 indexOf(vec3 world) {
  precise vec3 p = world - head;
  precise vec3 local = vec3(rotation[0] * p.x + (rotation[3] * p.y + rotation[6] * p.z),
                            rotation[1] * p.x + (rotation[4] * p.y + rotation[7] * p.z),
                            rotation[2] * p.x + (rotation[5] * p.y + rotation[8] * p.z));
  precise vec3 steps = local * grid.y;
  return ivec3(roundEven(clamp(steps, vec3(-kMaxGridIndex), vec3(kMaxGridIndex))));
}

// m^2, of the position that a reader decodes.
float squaredError(ivec3 index, vec3 wanted) {
  precise vec3 p = vec3(index) * grid.x;
  precise vec3 sums_of_products = vec3(rotation[0] * p.x + (rotation[1] * p.y + rotation[2] * p.z),
                                       rotation[3] * p.x + (rotation[4] * p.y + rotation[5] * p.z),
                                       rotation[6] * p.x + (rotation[7] * p.y + rotation[8] * p.z));
  precise vec3 world = sums_of_products + head;
  precise vec3 off = world - wanted;
  precise float error = off.x * off.x + (off.y * off.y + off.z * off.z);
  return error;
}

int signed16(int number) { return (number << 16) >> 16; }
uint zigzag(int number) { return uint((number << 1) ^ (number >> 31)); }
uint bitsOf(int number) { return uint(findMSB(zigzag(number)) + 1); }

void storeSymbol(uint place, int symbol, bool is_first) { symbols[place] = uint(symbol & 0xffff) | (is_first ? 0x10000u : 0u); }

// The numbers of a pair, zigzag. `place`: of its first symbol. `along`: edges are predicted from the edge before.
void numbersOf(uint place, bool along, bool has_before, out uint z[kPair]) {
  uint before = along && has_before ? symbol_quads[(place >> 2u) - 1u].w : 0u;
  for (uint quad = 0u; quad < 4u; ++quad) {
    const uvec4 four = symbol_quads[(place >> 2u) + quad];
    for (uint i = 0u; i < 4u; ++i) {
      const uint own = four[i];
      const uint predicted = along && (own & 0x10000u) == 0u ? before : 0u;
      z[4u * quad + i] = zigzag(signed16(int(own) - int(predicted)));
      before = own;
    }
  }
}

// Bits per number of a block: those of its largest; 16 in place of 15.
uint widthOf(uint z[kPair], uint first) {
  uint any = 0u;
  for (uint i = 0u; i < 8u; ++i) any |= z[first + i];
  const uint bits = uint(findMSB(any) + 1);
  return bits == 15u ? 16u : bits;
}

// Adds a value of up to 16 bits to the window.
void put(uint bit, uint value) {
  const uint shift = bit & 31u;
  if (value == 0u) return;
  atomicOr(window[bit >> 5u], value << shift);
  if (shift > 16u) atomicOr(window[(bit >> 5u) + 1u], value >> (32u - shift));
}

void main() {
  const uint me = gl_LocalInvocationID.x, number = gl_WorkGroupID.x;
  const uvec4 run = runs[2u * number];
  const uint first_strand = run.x, strands = run.y, first_vertex = run.z, vertices = run.w;
  const uint first_symbol = 4u * runs[2u * number + 1u].x;
  const uint edges = vertices - strands, first_edge = first_vertex - first_strand;
  const uint root_pairs = (3u * strands + kPair - 1u) / kPair;
  const uint pairs = root_pairs + (3u * edges + kPair - 1u) / kPair;
  const uint first_edge_symbol = first_symbol + root_pairs * kPair;
  if (me == 0u) {
    lost = worst_bits = bits_alone = bits_along = bytes_of_all = 0u;
  }
  barrier();

  bool is_lost = false;
  float worst = 0.0;
  uint alone = 0u, along_strand = 0u;
  for (uint s = me; s < strands; s += kInvocations) {
    const vec3 wanted = worldAt(offsets[first_strand + s]);
    const ivec3 index = indexOf(wanted);
    const uint at = 3u * (first_strand + s);
    const ivec3 moved = index - ivec3(rest_roots[at], rest_roots[at + 1u], rest_roots[at + 2u]);
    const float error = squaredError(index, wanted);
    is_lost = is_lost || !isWithinReach(wanted) || any(greaterThan(abs(moved), ivec3(32767))) || error > grid.z;
    worst = max(worst, error);
    for (uint c = 0u; c < 3u; ++c) storeSymbol(first_symbol + c * strands + s, moved[c], false);
  }
  for (uint e = me; e < edges; e += kInvocations) {
    const uint entry = edge_vertices[first_edge + e], vertex = entry & ~(kFirstEdge | kSampled);
    const bool is_first = (entry & kFirstEdge) != 0u;
    const vec3 wanted = worldAt(vertex);
    const ivec3 index = indexOf(wanted), before = indexOf(worldAt(vertex - 1u)), edge = index - before;
    const float error = squaredError(index, wanted);
    is_lost = is_lost || !isWithinReach(wanted) || any(lessThan(edge, ivec3(-32768))) || any(greaterThan(edge, ivec3(32767))) ||
              error > grid.z;
    worst = max(worst, error);
    for (uint c = 0u; c < 3u; ++c) storeSymbol(first_edge_symbol + c * edges + e, edge[c], is_first);
    if ((entry & kSampled) == 0u) continue;
    const ivec3 edge_before = is_first ? ivec3(0) : before - indexOf(worldAt(vertex - 2u));
    for (uint c = 0u; c < 3u; ++c) {
      alone += bitsOf(signed16(edge[c]));
      along_strand += bitsOf(signed16(edge[c] - edge_before[c]));
    }
  }
  if (is_lost) atomicOr(lost, 1u);
  atomicMax(worst_bits, floatBitsToUint(worst));
  atomicAdd(bits_alone, alone);
  atomicAdd(bits_along, along_strand);
  memoryBarrierBuffer();
  barrier();

  const bool along = bits_along < bits_alone;
  uint z[kPair];
  uint bytes = 0u;
  for (uint p = me; p < pairs; p += kInvocations) {
    numbersOf(first_symbol + p * kPair, along && p >= root_pairs, p > root_pairs, z);
    bytes += 1u + widthOf(z, 0u) + widthOf(z, 8u);
  }
  atomicAdd(bytes_of_all, bytes);
  barrier();
  const bool packs = lost == 0u && kHeadBytes + bytes_of_all < 12u * vertices;
  if (me == 0u) {
    const uint lines = packs ? (bytes_of_all + 4u * kLine - 1u) / (4u * kLine) : 0u;
    const uint taken = atomicAdd(payloads[0], lines * kLine);
    const uint head_of_run = 4u + 4u * number;
    payloads[head_of_run] = packs ? bytes_of_all : 0u;
    payloads[head_of_run + 1u] = along ? 1u : 0u;
    payloads[head_of_run + 2u] = worst_bits;
    payloads[head_of_run + 3u] = taken;
    first_word = taken;
  }
  barrier();
  if (!packs) return;  // the whole workgroup

  // Batches of a pair per invocation. What a batch leaves of a line begins the window of the next.
  uint to = first_word, carried = 0u;
  rest = 0u;
  for (uint first = 0u; first < pairs; first += kInvocations) {
    const uint p = first + me;
    uint own = 0u, width_a = 0u, width_b = 0u;
    if (p < pairs) {
      numbersOf(first_symbol + p * kPair, along && p >= root_pairs, p > root_pairs, z);
      width_a = widthOf(z, 0u);
      width_b = widthOf(z, 8u);
      own = 1u + width_a + width_b;
    }
    for (uint i = me; i < uint(window.length()); i += kInvocations) window[i] = i < kLine ? rest : 0u;
    uint end = own, bank = 0u;
    for (uint distance = 1u; distance < kInvocations; distance *= 2u) {
      sums[bank][me] = end;
      barrier();
      if (me >= distance) end += sums[bank][me - distance];
      bank = 1u - bank;
    }
    sums[bank][me] = end;
    barrier();
    const uint window_bytes = carried + sums[bank][kInvocations - 1u];
    if (own > 0u) {
      const uint bit = 8u * (carried + end - own);
      put(bit, min(width_a, 15u) | min(width_b, 15u) << 4u);
      for (uint i = 0u; i < 8u; ++i) put(bit + 8u + i * width_a, z[i]);
      for (uint i = 0u; i < 8u; ++i) put(bit + 8u + 8u * width_a + i * width_b, z[8u + i]);
    }
    barrier();
    const bool is_last = first + kInvocations >= pairs;
    const uint whole = window_bytes / (4u * kLine) * kLine, stored = is_last ? (window_bytes + 3u) / 4u : whole;
    for (uint i = me; i < stored; i += kInvocations) payloads[to + i] = window[i];
    to += whole;
    carried = window_bytes - 4u * whole;
    rest = me < kLine ? window[whole + me] : 0u;
    barrier();
  }
}
