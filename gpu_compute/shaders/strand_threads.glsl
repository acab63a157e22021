// A strand spread over THREADS neighbouring invocations of a workgroup, PER_THREAD edges each, and the exchange of values
// between them. Protocol of an exchange: send_*(), exchangeBarrier(), received_*(), swapBank(). All invocations must run it
// together, and must call received_*() in uniform control flow.
// SHUFFLED: 0: through shared memory, alternating between two banks. An exchange then needs one barrier: an invocation
//              overwrites a bank only after the barrier of the next exchange, when all have read that bank.
//           1: from register to register, by subgroupShuffle().
const int kLast = PER_THREAD - 1;

uint me;   // number of this invocation in its workgroup
int rank;  // and in its strand, 0 at the root

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
void exchangeBarrier() {}
void swapBank() {}
#else
shared vec4 exchange_a[2 * WORKGROUP];
shared vec4 exchange_b[2 * WORKGROUP];
shared vec4 exchange_c[2 * WORKGROUP];
shared float exchange_d[2 * WORKGROUP];
uint bank;  // start of the bank that send_*() writes to
void send_a(vec4 value) { exchange_a[bank + me] = value; }
void send_b(vec4 value) { exchange_b[bank + me] = value; }
void send_c(vec4 value) { exchange_c[bank + me] = value; }
void send_d(float value) { exchange_d[bank + me] = value; }
// The values pass through global variables. Mesa (opt_tree_grafting) may move a local variable that is used once, and its
// shared-memory read, past the next barrier; the read would then see what others send next.
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
void exchangeBarrier() { barrier(); }
void swapBank() { bank ^= uint(WORKGROUP); }
#endif

// Invocations `distance` towards the root and the tip. Past the strand's ends they are this invocation itself, so that
// no value, not even a NaN, comes from another strand; callers select the boundary value.
uint rootward, tipward;  // those at distance 1, the most frequent; cached
bool has_rootward, has_tipward;
uint before(int distance) { return distance == 1 ? rootward : rank >= distance ? me - uint(distance) : me; }
uint after(int distance) { return distance == 1 ? tipward : rank + distance < THREADS ? me + uint(distance) : me; }
bool hasBefore(int distance) { return distance == 1 ? has_rootward : rank >= distance; }
bool hasAfter(int distance) { return distance == 1 ? has_tipward : rank + distance < THREADS; }

void initInvocation() {
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

// Trip count of a loop that contains an exchange, hidden from the compiler to prevent unrolling in two cases. With barriers
// Mesa's llvmpipe splits a program at each barrier, in time that grows with the square of their number. With MANY_STRANDS strands
// a GPU is full, and program length costs more than the latency of one strand.
#if SHUFFLED && !MANY_STRANDS
#define OPAQUE_COUNT(number) (number)
#else
#define OPAQUE_COUNT(number) (settings.substeps > 0u ? (number) : 0)
#endif

// log2(THREADS): rounds of a scan or reduction over the strand's invocations.
#if THREADS == 1
const int kReductionRounds = 0;
#elif THREADS == 2
const int kReductionRounds = 1;
#elif THREADS == 4
const int kReductionRounds = 2;
#elif THREADS == 8
const int kReductionRounds = 3;
#elif THREADS == 16
const int kReductionRounds = 4;
#else
const int kReductionRounds = 5;
#endif

// The maximum over the strand's invocations, in each of them.
float strandMax(float value) {
  for (int doubling = 0; doubling < OPAQUE_COUNT(kReductionRounds); ++doubling) {
    send_d(value);
    exchangeBarrier();
    value = max(value, received_d(me ^ (1u << doubling)));
    swapBank();
  }
  return value;
}
// The sum over the strand's invocations, the same bits in each of them.
float strandSum(float value) {
  for (int doubling = 0; doubling < OPAQUE_COUNT(kReductionRounds); ++doubling) {
    send_d(value);
    exchangeBarrier();
    value += received_d(me ^ (1u << doubling));
    swapBank();
  }
  return value;
}
