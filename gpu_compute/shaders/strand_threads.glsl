// A strand spread over THREADS neighbouring invocations of a workgroup, PER_THREAD edges each, and the memory through which
// they pass values: write own entry, barrier, read a neighbour's, barrier. With one bank of memory and 32 invocations the
// second barrier costs less than a second bank would: on NVIDIA a GL program gets some 64 KB of shared memory per
// multiprocessor, so 4 KB per 32 invocations is what the whole shader may use before fewer of them run at once.
#define PER_THREAD 4
const int kLast = PER_THREAD - 1;

uint me;   // this invocation in its workgroup
int rank;  // and in its strand, from the root

shared vec4 exchange_a[WORKGROUP];
shared vec4 exchange_b[WORKGROUP];
shared vec4 exchange_c[WORKGROUP];
shared float exchange_d[WORKGROUP];

// Neighbours towards the root and the tip. Past the ends of the strand it is this invocation itself, so that nothing, not
// even a NaN, is ever read from another strand; callers select what holds there.
uint before(int distance) { return rank >= distance ? me - uint(distance) : me; }
uint after(int distance) { return rank + distance < THREADS ? me + uint(distance) : me; }
bool hasBefore(int distance) { return rank >= distance; }
bool hasAfter(int distance) { return rank + distance < THREADS; }

// Doublings from 1 to THREADS.
#if THREADS == 1
const int kDoublings = 0;
#elif THREADS == 2
const int kDoublings = 1;
#elif THREADS == 4
const int kDoublings = 2;
#elif THREADS == 8
const int kDoublings = 3;
#elif THREADS == 16
const int kDoublings = 4;
#else
const int kDoublings = 5;
#endif

// What an invocation finds of its whole strand: forget, barrier, note, barrier, ask.
shared uint noted[WORKGROUP];  // at the first invocation of each strand
shared uint any_noted;         // in the workgroup
void forgetNoted() {
  if (rank == 0) noted[me] = 0u;
  if (me == 0u) any_noted = 0u;
}
void noteStrand() { noted[me - uint(rank)] = any_noted = 1u; }
bool isNoted() { return noted[me - uint(rank)] != 0u; }

// The sum over the strand's invocations, the same bits in each of them.
float strandSum(float value) {
  for (int doubling = 0; doubling < kDoublings; ++doubling) {
    exchange_d[me] = value;
    barrier();
    value += exchange_d[me ^ (1u << doubling)];
    barrier();
  }
  return value;
}
