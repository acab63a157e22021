// Packs and unpacks blocks of bits (bit_blocks.h). Included inside a target's namespace after
// kernels/lanes_highway.inl.

/// Four 16-bit numbers, the first in the lowest bits.
using Four = uint64_t;
constexpr Four kOnes = 0x0001000100010001, kEven = 0x0000ffff0000ffff, kTwo = 0x0000000100000001;

HWY_INLINE uint64_t lowBits(uint32_t count) { return (uint64_t{1} << count) - 1; }

/// zigzag() of each number, and its inverse.
HWY_INLINE Four folded(Four numbers) { return (numbers & 0x7fff * kOnes) << 1 ^ ((numbers >> 15 & kOnes) * 0xffff); }
HWY_INLINE Four unfolded(Four z) { return (z >> 1 & 0x7fff * kOnes) ^ ((z & kOnes) * 0xffff); }

struct BitBlock {
  Four first, second;
};

HWY_INLINE uint32_t widthOf(const BitBlock& block) {
  Four any = block.first | block.second;
  any |= any >> 32;
  any |= any >> 16;
  const auto bits = static_cast<uint32_t>(std::bit_width(any & 0xffff));
  return bits == kWidestCode ? kMaxBlockWidth : bits;
}

// Packs four numbers of `width` bits without gaps: first pairs, then both pairs. apart() is the inverse and ignores
// higher bits.
HWY_INLINE uint64_t together(Four numbers, uint32_t width) {
  const uint64_t pairs = (numbers & kEven) | (numbers >> 16 & kEven) << width;
  return (pairs & lowBits(32)) | pairs >> 32 << 2 * width;
}
HWY_INLINE Four apart(uint64_t bits, uint32_t width) {
  const uint64_t pairs = (bits & lowBits(2 * width)) | bits >> 2 * width << 32, own = lowBits(width) * kTwo;
  return (pairs & own) | (pairs >> width & own) << 16;
}

// Where `width` is odd, the second half of a block starts in the middle of a byte.
HWY_INLINE uint32_t halfByte(uint32_t width) { return 4 * (width & 1); }

/// Stores up to 8 bytes beyond the `width` bytes of the block.
HWY_INLINE uint8_t* putBlock(const BitBlock& block, uint32_t width, uint8_t* to) {
  const uint64_t first = together(block.first, width), second = together(block.second, width);
  const uint64_t shared = (width & 1) * (first >> (4 * (width - 1) & 63));
  const uint64_t from_middle = second << halfByte(width) | shared;
  std::memcpy(to, &first, sizeof first);
  std::memcpy(to + width / 2, &from_middle, sizeof from_middle);
  return to + width;
}

HWY_INLINE uint8_t* putPair(const uint16_t* numbers, uint8_t* to) {
  Four fours[4];
  std::memcpy(fours, numbers, sizeof fours);
  const BitBlock a{folded(fours[0]), folded(fours[1])}, b{folded(fours[2]), folded(fours[3])};
  const uint32_t width_a = widthOf(a), width_b = widthOf(b);
  *to = static_cast<uint8_t>(std::min(width_a, kWidestCode) | std::min(width_b, kWidestCode) << 4);
  return putBlock(b, width_b, putBlock(a, width_a, to + 1));
}

uint8_t* packNumbers(std::span<const uint16_t> numbers, uint8_t* to) {
  size_t done = 0;
  for (; done + kBitBlockPair <= numbers.size(); done += kBitBlockPair) to = putPair(numbers.data() + done, to);
  if (done == numbers.size()) return to;
  std::array<uint16_t, kBitBlockPair> rest{};
  std::copy(numbers.begin() + static_cast<ptrdiff_t>(done), numbers.end(), rest.begin());
  return putPair(rest.data(), to);
}

/// Loads up to 16 bytes, of which `width` are the block's.
HWY_INLINE void takeBlock(const uint8_t* from, uint32_t width, uint16_t* numbers) {
#if HWY_MAX_BYTES >= 32
  // All eight at once: each lane gathers the 32 bits in which its number starts.
  const hn::FixedTag<uint32_t, kBitBlock> lanes;
  const hn::Repartition<uint8_t, decltype(lanes)> bytes;
  const auto bit = hn::Mul(hn::Iota(lanes, 0), hn::Set(lanes, width));
  const auto places = hn::Add(hn::Mul(hn::ShiftRight<3>(bit), hn::Set(lanes, 0x01010101)), hn::Set(lanes, 0x03020100));
  const auto words = hn::BitCast(lanes, hn::TableLookupBytes(hn::LoadDup128(bytes, from), hn::BitCast(bytes, places)));
  const auto z = hn::And(hn::Shr(words, hn::And(bit, hn::Set(lanes, 7))), hn::Set(lanes, static_cast<uint32_t>(lowBits(width))));
  const auto sign = hn::Sub(hn::Zero(lanes), hn::And(z, hn::Set(lanes, 1)));
  const auto number = hn::And(hn::Xor(hn::ShiftRight<1>(z), sign), hn::Set(lanes, 0xffff));
  const hn::Rebind<int32_t, decltype(lanes)> whole;
  const hn::Rebind<uint16_t, decltype(lanes)> narrow;
  hn::StoreU(hn::DemoteTo(narrow, hn::BitCast(whole, number)), narrow, numbers);
#else
  uint64_t first, from_middle;
  std::memcpy(&first, from, sizeof first);
  std::memcpy(&from_middle, from + width / 2, sizeof from_middle);
  const Four fours[2] = {unfolded(apart(first, width)), unfolded(apart(from_middle >> halfByte(width), width))};
  std::memcpy(numbers, fours, sizeof fours);
#endif
}

bool unpackNumbers(std::span<const uint8_t>& bytes, std::span<uint16_t> numbers) {
  constexpr size_t kReach = kMaxPairBytes + 16;
  const auto width_of = [](uint32_t code) { return code == kWidestCode ? kMaxBlockWidth : code; };
  const uint8_t* from = bytes.data();
  size_t left = bytes.size();
  for (size_t done = 0; done < numbers.size(); done += kBitBlockPair) {
    if (left == 0) return false;
    const uint32_t width_a = width_of(*from & 15u), width_b = width_of(*from >> 4u);
    const size_t used = 1 + width_a + width_b;
    if (used > left) return false;
    const bool is_last = numbers.size() - done < kBitBlockPair;
    std::array<uint8_t, kReach> tail;
    std::array<uint16_t, kBitBlockPair> rest;
    const uint8_t* at = from;
    if (left < kReach) {
      tail.fill(0);
      std::copy_n(from, left, tail.data());
      at = tail.data();
    }
    uint16_t* const to = is_last ? rest.data() : numbers.data() + done;
    takeBlock(at + 1, width_a, to);
    takeBlock(at + 1 + width_a, width_b, to + kBitBlock);
    if (is_last) std::copy_n(rest.begin(), numbers.size() - done, numbers.data() + done);
    from += used;
    left -= used;
  }
  bytes = bytes.last(left);
  return true;
}
