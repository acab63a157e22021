// A strand spread over THREADS neighbouring invocations of a workgroup, PER_THREAD edges each, and how they pass values: send
// own ones, rendezvous, receive those of another, release. All must do so together, and receive outside of conditions.
// SHUFFLED: from register to register. Else through shared memory, in two banks by turns, so that an exchange has one barrier: who
// sends again has passed the barrier that all reach once they have received what stands there.
const int kLast = PER_THREAD - 1;

uint me;   // this invocation in its workgroup
int rank;  // and in its strand, from the root

#if SHUFFLED
vec4 sent_a, sent_b, sent_c;
float sent_d;
void send_a(vec4 value) { sent_a = value; }
void send_b(vec4 value) { sent_b = value; }
void send_c(vec4 value) { sent_c = value; }
void send_d(float value) { sent_d = value; }
vec4 received_a(uint from) { return subgroupShuffle(sent_a, from); }
vec4 received_b(uint from) { return subgroupShuffle(sent_b, from); }
vec4 received_c(uint from) { return subgroupShuffle(sent_c, from); }
float received_d(uint from) { return subgroupShuffle(sent_d, from); }
void rendezvous() {}
void release() {}
#else
shared vec4 exchange_a[2 * WORKGROUP];
shared vec4 exchange_b[2 * WORKGROUP];
shared vec4 exchange_c[2 * WORKGROUP];
shared float exchange_d[2 * WORKGROUP];
uint bank;  // where the one begins that is sent to next
void send_a(vec4 value) { exchange_a[bank + me] = value; }
void send_b(vec4 value) { exchange_b[bank + me] = value; }
void send_c(vec4 value) { exchange_c[bank + me] = value; }
void send_d(float value) { exchange_d[bank + me] = value; }
// Through global variables: a local one that is used once Mesa may move, and with it the read, past the rendezvous after it
// (opt_tree_grafting), where it reads what others send next.
vec4 got_a, got_b, got_c;
float got_d;
vec4 received_a(uint from) {
  got_a = exchange_a[bank + from];
  return got_a;
}
vec4 received_b(uint from) {
  got_b = exchange_b[bank + from];
  return got_b;
}
vec4 received_c(uint from) {
  got_c = exchange_c[bank + from];
  return got_c;
}
float received_d(uint from) {
  got_d = exchange_d[bank + from];
  return got_d;
}
void rendezvous() { barrier(); }
void release() { bank ^= uint(WORKGROUP); }
#endif

// Neighbours towards the root and the tip. Past the ends of the strand it is this invocation itself, so that nothing, not
// even a NaN, is ever read from another strand; callers select what holds there.
uint rootward, tipward;  // those at distance 1, which are wanted most
bool has_rootward, has_tipward;
uint before(int distance) { return distance == 1 ? rootward : rank >= distance ? me - uint(distance) : me; }
uint after(int distance) { return distance == 1 ? tipward : rank + distance < THREADS ? me + uint(distance) : me; }
bool hasBefore(int distance) { return distance == 1 ? has_rootward : rank >= distance; }
bool hasAfter(int distance) { return distance == 1 ? has_tipward : rank + distance < THREADS; }

void placeInvocation() {
#if SHUFFLED
  me = gl_SubgroupInvocationID;
#else
  me = gl_LocalInvocationID.x;
  bank = 0u;
#endif
  rank = int(me) % THREADS;
  has_rootward = rank >= 1;
  has_tipward = rank + 1 < THREADS;
  rootward = has_rootward ? me - 1u : me;
  tipward = has_tipward ? me + 1u : me;
}

// How often a loop with a rendezvous runs. Where that is a barrier compilers are not to know the number, or they would unroll
// the loop: a processor (Mesa's llvmpipe) splits a program at every barrier, and takes as long for it as their square. Nor
// where a GPU is full of strands (MANY): there the length of a program counts more than how long one strand takes.
#if SHUFFLED && !MANY
#define REPEATS(number) (number)
#else
#define REPEATS(number) (settings.substeps > 0u ? (number) : 0)
#endif

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

// The greatest over the strand's invocations.
float strandMax(float value) {
  for (int doubling = 0; doubling < REPEATS(kDoublings); ++doubling) {
    send_d(value);
    rendezvous();
    value = max(value, received_d(me ^ (1u << doubling)));
    release();
  }
  return value;
}
// The sum over the strand's invocations, the same bits in each of them.
float strandSum(float value) {
  for (int doubling = 0; doubling < REPEATS(kDoublings); ++doubling) {
    send_d(value);
    rendezvous();
    value += received_d(me ^ (1u << doubling));
    release();
  }
  return value;
}
