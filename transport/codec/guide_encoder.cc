#include "transport/codec/guide_encoder.h"

#include <algorithm>
#include <condition_variable>
#include <cstring>
#include <exception>
#include <limits>
#include <mutex>
#include <string>
#include <thread>

#include "core/error.h"
#include "core/hash.h"
#include "transport/codec/hair_codec.h"

namespace strandcast {
namespace {

/// Grid step over error bound. A component is off by at most half a step, a position by sqrt(3) times that.
/// The factor 0.95 leaves room for rounding on the way to the head's frame and back.
constexpr float kStepOfError = 0.95f * 2 / 1.7320508f;
float gridStepOf(const CodecOptions& options) { return kStepOfError * options.max_error; }
float squaredLimitOf(const CodecOptions& options) { return options.max_error * options.max_error; }
/// Likewise on a plane. The factor 0.6 leaves room for the error along the strand, which no direction can
/// correct.
constexpr float kTangentStepOfError = 0.6f * 2 / 1.4142136f;
/// An encoding is replaced by kDelta16 if more than one strand in kUnfitShare does not fit it.
constexpr size_t kUnfitShare = 8;

Encoding encodingOf(Codec codec) {
  switch (codec) {
    case Codec::kFloat32:
      return Encoding::kFloat32;
    case Codec::kOctahedral12:
      return Encoding::kOctahedral12;
    case Codec::kTangent:
    case Codec::kTemporal:
      return Encoding::kTangent;
    case Codec::kOctahedral16:
      return Encoding::kOctahedral16;
    case Codec::kDelta16:
      break;
  }
  return Encoding::kDelta16;
}

constexpr float kNotHeld = std::numeric_limits<float>::infinity();

}  // namespace

ChunkEncoder::ChunkEncoder(EncodedGroom& groom, const StrandCoder& coder)
    : groom_(&groom),
      squared_limit_(squaredLimitOf(groom.options)),
      step_(gridStepOf(groom.options)),
      tangent_step_(kTangentStepOfError * groom.options.max_error),
      coder_(coder),
      packer_(coder) {}

void ChunkEncoder::quantizeRoots(const StrandRun& run, const HeadFrame& head, Encoding encoding) {
  roots_.resize(run.strand_count);
  worst_.resize(run.strand_count);
  const bool is_tangent = encoding == Encoding::kTangent;
  const float step = is_tangent ? tangent_step_ : step_, per_step = 1 / step;
  for (uint32_t s = 0; s < run.strand_count; ++s) {
    const Vec3& wanted = positions_[groom_->geometry.offsets[run.first_strand + s]];
    const Vec3& rest = groom_->geometry.roots[run.first_strand + s];
    const Vec3 local = head.toHead(wanted);
    Vec3 decoded, index;
    bool fits = true;
    for (int c = 0; c < 3; ++c) {
      // Tangents: difference from rest; otherwise grid coordinates.
      const int32_t place = gridIndex((is_tangent ? local[c] - rest[c] : local[c]) * per_step);
      const int32_t moved = is_tangent ? place : place - restGridIndex(rest[c], step);
      const int32_t symbol = std::clamp(moved, -32767, 32767);
      fits &= symbol == moved;
      symbols_.roots[static_cast<size_t>(c) * run.strand_count + s] = static_cast<uint16_t>(symbol);
      index[c] = static_cast<float>(place);
      decoded[c] = is_tangent ? rest[c] + gridPosition(symbol, step) : gridPosition(place, step);
    }
    const float error = (head.toWorld(decoded) - wanted).squaredNorm();
    roots_[s] = encoding == Encoding::kDelta16 ? index : decoded;
    worst_[s] = fits && error <= squared_limit_ ? error : kNotHeld;  // false for NaN
  }
}

void ChunkEncoder::quantize(const GuideFrame& frame, uint32_t index, Encoding encoding,
                            const TangentHistory* history) {
  const StrandRun& run = groom_->runs[index];
  shapeSymbols(run, encoding, symbols_);
  const HeadFrame head(frame.head);
  quantizeRoots(run, head, encoding);
  StrandEncoding job{.geometry = groom_->geometry,
                     .run = run,
                     .head = head,
                     .positions = positions_.data() + run.first_vertex,
                     .roots = roots_.data(),
                     .step = encoding == Encoding::kTangent ? tangent_step_ : step_,
                     .squared_limit = squared_limit_,
                     .bits = edgeBits(encoding),
                     .rest = &groom_->rests[index],
                     .history = history,
                     .edges = symbols_.edges.data(),
                     .worst = worst_.data()};
  if (encoding == Encoding::kDelta16) {
    coder_.encode_delta(job, rows_);
  } else if (encoding != Encoding::kTangent) {
    coder_.encode_octahedral(job, rows_);
  } else {
    if (groom_->rests[index].empty()) coder_.rest_directions(groom_->geometry, run, groom_->rests[index]);
    if (!groom_->histories.empty()) job.directions = &directions_;
    coder_.encode_tangents(job, rows_);
  }
  exact_.clear();
  worst_squared_ = 0;
  for (uint32_t s = 0; s < run.strand_count; ++s) {
    if (worst_[s] != kNotHeld)
      worst_squared_ = std::max(worst_squared_, worst_[s]);
    else
      exact_.push_back(static_cast<uint16_t>(s));
  }
}

void ChunkEncoder::collectStrandEnds(const StrandRun& run) {
  strand_ends_.resize(run.strand_count);
  for (uint32_t s = 0; s < run.strand_count; ++s)
    strand_ends_[s] = groom_->geometry.offsets[run.first_strand + s + 1] - run.first_vertex - (s + 1);
}

/// The symbols of strands that are sent as float32 carry no information: zeros need the fewest bits.
void ChunkEncoder::forgetExactStrands(const StrandRun& run) {
  const size_t plane = run.vertex_count - run.strand_count;
  for (const uint16_t s : exact_) {
    const size_t begin = s == 0 ? 0 : strand_ends_[s - 1u], end = strand_ends_[s];
    for (size_t c = 0; c < 3; ++c) symbols_.roots[c * run.strand_count + s] = 0;
    for (size_t c = 0; c < static_cast<size_t>(symbols_.edge_planes); ++c)
      std::fill(symbols_.edges.begin() + static_cast<ptrdiff_t>(c * plane + begin),
                symbols_.edges.begin() + static_cast<ptrdiff_t>(c * plane + end), uint16_t{0});
  }
}

void ChunkEncoder::writeFloat32(const StrandRun& run, GuideChunk& chunk) const {
  chunk.encoding = Encoding::kFloat32;
  chunk.key_frame = 0;
  chunk.payload.resize(run.vertex_count * sizeof(Vec3));
  std::memcpy(chunk.payload.data(), positions_.data() + run.first_vertex, chunk.payload.size());
}

void ChunkEncoder::writePreamble(const StrandRun& run, uint8_t mode, float step,
                                 std::vector<uint8_t>& bytes) const {
  const auto exact_strands = static_cast<uint16_t>(exact_.size());
  bytes.resize(kPayloadHeadBytes + exact_.size() * sizeof(uint16_t));
  bytes[0] = mode;
  bytes[1] = 0;
  std::memcpy(bytes.data() + 2, &exact_strands, sizeof exact_strands);
  std::memcpy(bytes.data() + 4, &step, sizeof step);
  if (!exact_.empty())
    std::memcpy(bytes.data() + kPayloadHeadBytes, exact_.data(), exact_.size() * sizeof(uint16_t));
  for (const uint16_t s : exact_) {
    const uint32_t first = groom_->geometry.offsets[run.first_strand + s];
    const size_t length = (groom_->geometry.offsets[run.first_strand + s + 1u] - first) * sizeof(Vec3);
    bytes.resize(bytes.size() + length);
    std::memcpy(bytes.data() + bytes.size() - length, positions_.data() + first, length);
  }
}

void ChunkEncoder::writeSymbols(const StrandRun& run, GuideChunk& chunk) {
  SymbolPrediction prediction;
  prediction.edge_bits = edgeBits(chunk.encoding);
  collectStrandEnds(run);
  prediction.strand_ends = strand_ends_;
  forgetExactStrands(run);
  prediction.along_strand = SymbolPacker::prefersAlongStrand(symbols_, prediction);
  const bool zstd = groom_->options.zstd;
  const int mode = (prediction.along_strand ? kAlongStrand : 0) | (zstd ? 0 : kInBlocks);
  writePreamble(run, static_cast<uint8_t>(mode), step_, chunk.payload);
  if (zstd)
    packer_.compress(symbols_, prediction, chunk.payload);
  else
    packer_.packInBlocks(symbols_, prediction, chunk.payload);
}

void ChunkEncoder::encodeTangents(const GuideFrame& frame, uint32_t index, GuideChunk& chunk) {
  const StrandRun& run = groom_->runs[index];
  TangentHistory* const own = groom_->histories.empty() ? nullptr : &groom_->histories[index];
  const TangentHistory* history = nullptr;
  // After a gap in frame numbers another daemon may have cast, and readers may have changed: use a key frame.
  if (own && own->frame != 0 && own->frame + 1 == frame.frame) {
    // Key frames of different chunks are spread over frames, so that frames have about equal size.
    const uint64_t phase = frame.frame + uint64_t{index} * groom_->options.key_interval / groom_->runs.size();
    if (phase % groom_->options.key_interval != 0) history = own;
  }
  quantize(frame, index, Encoding::kTangent, history);
  if (exact_.size() * kUnfitShare > run.strand_count) {
    if (own) own->frame = 0;  // not sent
    chunk.encoding = Encoding::kDelta16;
    return;
  }
  chunk.key_frame = history ? history->frame : 0;
  writePreamble(run, kInBlocks, tangent_step_, chunk.payload);
  packer_.packInBlocks(symbols_, {}, chunk.payload);
  if (own) own->accept(frame.frame, history == nullptr, directions_);
}

ChunkReport ChunkEncoder::writePacked(const PackedRun& packed, const StrandRun& run, GuideChunk& chunk) {
  exact_.clear();
  writePreamble(run, static_cast<uint8_t>(kInBlocks | (packed.along_strand ? kAlongStrand : 0)), step_,
                chunk.payload);
  chunk.payload.insert(chunk.payload.end(), packed.symbols.begin(), packed.symbols.end());
  return {0, std::sqrt(double{packed.worst_squared})};
}

ChunkReport ChunkEncoder::encode(const GuideFrame& frame, const EncoderInput& guides, uint32_t index,
                                 GuideChunk& chunk) {
  positions_ = guides.positions;
  const StrandRun& run = groom_->runs[index];
  fillGuideHeader(frame, groom_->runs, index, chunk);
  chunk.encoding = encodingOf(groom_->options.codec);
  chunk.key_frame = 0;
  if (guides.isPacked(index)) return writePacked(guides.packed[index], run, chunk);
  if (chunk.encoding == Encoding::kFloat32) {
    writeFloat32(run, chunk);
    return {};
  }
  if (chunk.encoding == Encoding::kTangent) encodeTangents(frame, index, chunk);
  if (chunk.encoding != Encoding::kTangent) {
    quantize(frame, index, chunk.encoding, nullptr);
    if (chunk.encoding != Encoding::kDelta16 && exact_.size() * kUnfitShare > run.strand_count) {
      chunk.encoding = Encoding::kDelta16;
      quantize(frame, index, chunk.encoding, nullptr);
    }
    writeSymbols(run, chunk);
  }
  if (chunk.payload.size() >= run.vertex_count * sizeof(Vec3)) {
    if (!groom_->histories.empty()) groom_->histories[index].frame = 0;  // not sent
    writeFloat32(run, chunk);
    return {run.strand_count, 0};
  }
  return {exact_.size(), std::sqrt(double{worst_squared_})};
}

namespace {

int encodingThreads(int asked) {
  const int there = std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
  return std::min({asked > 0 ? asked : there, there, kMaxEncodingThreads});
}

GuideGrid gridOf(const EncodedGroom& groom) {
  GuideGrid grid;
  grid.runs = groom.runs;
  grid.step = gridStepOf(groom.options);
  grid.per_step = 1 / grid.step;
  grid.squared_limit = squaredLimitOf(groom.options);
  for (const Vec3& root : groom.geometry.roots)
    for (int c = 0; c < 3; ++c) grid.rest_roots.push_back(restGridIndex(root[c], grid.step));
  ContentHash hash;
  hash.add(grid.step);
  hash.add(grid.squared_limit);
  hash.add(grid.runs.data(), grid.runs.size() * sizeof(StrandRun));
  hash.add(grid.rest_roots.data(), grid.rest_roots.size() * sizeof(int32_t));
  grid.number = std::max<uint64_t>(1, hash.value());
  return grid;
}

}  // namespace

/// Threads that encode the chunks of a frame ahead of the thread that sends them.
class GuideEncoder::EncoderPool {
 public:
  EncoderPool(int threads, EncodedGroom& groom, const StrandCoder& coder) {
    for (int i = 0; i < 2 * threads; ++i) slots_.push_back({ChunkEncoder(groom, coder)});
    for (int i = 1; i < threads; ++i) helpers_.emplace_back([this](std::stop_token stop) { help(stop); });
  }

  /// Calls send(chunk, report) on this thread, in order.
  template <class Send>
  void encodeAll(const GuideFrame& frame, const EncoderInput& guides, uint32_t count, const Send& send) {
    std::unique_lock lock(mutex_);
    frame_ = &frame;
    guides_ = guides;
    next_ = sent_ = 0;
    count_ = count;
    work_.notify_all();
    try {
      while (sent_ < count_) {
        Slot& slot = slotOf(sent_);
        if (failure_) std::rethrow_exception(failure_);
        if (slot.is_ready) {
          lock.unlock();
          send(slot.chunk, slot.report);
          lock.lock();
          slot.is_ready = false;
          ++sent_;
          work_.notify_one();
        } else if (mayBegin()) {
          encodeNext(lock);
        } else {
          ready_.wait(lock);
        }
      }
    } catch (...) {
      if (!lock.owns_lock()) lock.lock();
      count_ = 0;
      ready_.wait(lock, [&] { return under_way_ == 0; });
      for (Slot& slot : slots_) slot.is_ready = false;
      failure_ = nullptr;
      throw;
    }
  }

 private:
  struct Slot {
    ChunkEncoder encoder;
    GuideChunk chunk{};
    ChunkReport report{};
    bool is_ready = false;
  };

  /// Chunks in progress span fewer indices than there are slots, so that no two share one.
  Slot& slotOf(uint32_t index) { return slots_[index % slots_.size()]; }
  bool mayBegin() const { return next_ < count_ && next_ < sent_ + slots_.size(); }

  void encodeNext(std::unique_lock<std::mutex>& lock) {
    const uint32_t index = next_++;
    const GuideFrame& frame = *frame_;
    const EncoderInput guides = guides_;
    Slot& slot = slotOf(index);
    ++under_way_;
    lock.unlock();
    std::exception_ptr failure;
    try {
      slot.report = slot.encoder.encode(frame, guides, index, slot.chunk);
    } catch (...) {
      failure = std::current_exception();
    }
    lock.lock();
    --under_way_;
    slot.is_ready = true;
    if (failure) failure_ = failure;
    ready_.notify_one();
  }

  void help(const std::stop_token& stop) {
    std::unique_lock lock(mutex_);
    while (work_.wait(lock, stop, [this] { return mayBegin(); })) encodeNext(lock);
  }

  std::mutex mutex_;
  std::condition_variable_any work_;  // a chunk may be started
  std::condition_variable ready_;     // a chunk is ready
  const GuideFrame* frame_ = nullptr;
  EncoderInput guides_;
  uint32_t next_ = 0, sent_ = 0, count_ = 0, under_way_ = 0;
  std::exception_ptr failure_;
  std::vector<Slot> slots_;
  // Last, so that they are joined before the members that they use are destroyed
  std::vector<std::jthread> helpers_;
};

GuideEncoder::GuideEncoder(const CodecOptions& options, const StrandCoder& coder)
    : groom_{options, {}, {}, {}, {}},
      coder_(coder),
      threads_(encodingThreads(options.threads)),
      own_(groom_, coder) {}

GuideEncoder::~GuideEncoder() = default;

void GuideEncoder::setGroom(const StrandSet& guides) {
  const CodecOptions& options = groom_.options;
  groom_.geometry = GuideGeometry(guides);
  groom_.runs = divideGuides(guides);
  groom_.rests.assign(groom_.runs.size(), {});
  groom_.histories.assign(options.codec == Codec::kTemporal ? groom_.runs.size() : 0, {});
  grid_ = options.codec == Codec::kDelta16 && !options.zstd ? gridOf(groom_) : GuideGrid();
  report_ = {nameOf(options.codec), options.codec == Codec::kFloat32 ? 0.0 : double{options.max_error}};
  reported_frame_ = 0;
}

EncoderInput GuideEncoder::inputOf(const GuideFrame& frame, GuideSource& guides) const {
  EncoderInput out;
  if (grid_.number != 0) {
    const HeadFrame head(frame.head);
    out.packed = guides.packed(grid_, {head.rotation(), head.position()});
  }
  size_t begin = guides.vertices(), end = 0;  // of all runs that are not packed
  for (size_t r = 0; r < groom_.runs.size(); ++r) {
    const StrandRun& run = groom_.runs[r];
    if (out.isPacked(r)) continue;
    begin = std::min<size_t>(begin, run.first_vertex);
    end = run.first_vertex + run.vertex_count;
  }
  if (end > begin) out.positions = guides.positions(begin, end - begin);
  return out;
}

void GuideEncoder::add(const GuideFrame& frame, const GuideChunk& chunk, const ChunkReport& report) {
  if (frame.frame != reported_frame_) {
    reported_frame_ = frame.frame;
    report_.frame_bytes = report_.strands_sent_finer = 0;
    report_.worst_error = 0;
  }
  report_.frame_bytes += chunk.payload.size();
  report_.strands_sent_finer += report.strands_sent_finer;
  report_.worst_error = std::max(report_.worst_error, report.worst_error);
}

void GuideEncoder::encode(const GuideFrame& frame, uint32_t index, GuideChunk& chunk) {
  const ChunkReport report = own_.encode(frame, {frame.positions}, index, chunk);
  add(frame, chunk, report);
}

void GuideEncoder::encodeAll(const GuideFrame& frame, const std::function<void(GuideChunk&)>& send) {
  FrameGuides guides(frame);
  encodeAll(frame, guides, send);
}

void GuideEncoder::encodeAll(const GuideFrame& frame, GuideSource& guides,
                             const std::function<void(GuideChunk&)>& send) {
  const auto count = static_cast<uint32_t>(groom_.runs.size());
  const EncoderInput input = inputOf(frame, guides);
  if (threads_ == 1 || count <= 1) {
    for (uint32_t i = 0; i < count; ++i) {
      const ChunkReport report = own_.encode(frame, input, i, own_chunk_);
      add(frame, own_chunk_, report);
      send(own_chunk_);
    }
    return;
  }
  if (!pool_) pool_ = std::make_unique<EncoderPool>(threads_, groom_, coder_);
  pool_->encodeAll(frame, input, count, [&](GuideChunk& chunk, const ChunkReport& report) {
    add(frame, chunk, report);
    send(chunk);
  });
}

AnnouncedGroom::Chunks AnnouncedGroom::chunksOf(const GroomDescription& groom,
                                                const BodyDescription& body) const {
  checkAnnouncement(groom, body, "groom " + groom.name);
  GroomDescription own_groom = groom;
  own_groom.groom_id = groom_id_;
  own_groom.session = session_;
  checkSuccession(accepted_ ? &*accepted_ : nullptr, own_groom);
  BodyDescription own_body = body;
  own_body.groom_id = groom_id_;
  own_body.session = session_;
  own_body.revision = groom.revision;
  return {splitGroom(own_groom), splitBody(own_body)};
}

void AnnouncedGroom::accept(const GroomDescription& groom) {
  encoder_.setGroom(groom.guides);
  accepted_ = groom;
  accepted_->groom_id = groom_id_;
  accepted_->session = session_;
}

std::vector<HairChunk> AnnouncedGroom::chunksOf(const HairDescription& hairs) const {
  const std::string where = "hairs of groom " + std::to_string(groom_id_);
  if (!accepted_) throw Error("no groom was announced", where, "announce the groom first");
  checkHairs(hairs, accepted_->guides, hairs.source.empty() ? where : hairs.source);
  std::vector<HairChunk> chunks = encodeHairs(hairs, accepted_->guides, hair_error_);
  for (HairChunk& chunk : chunks) {
    chunk.groom_id = groom_id_;
    chunk.session = session_;
    chunk.revision = accepted_->revision;
  }
  return chunks;
}

void AnnouncedGroom::divide(const GuideFrame& frame, const std::function<void(GuideChunk&)>& send) {
  FrameGuides guides(frame);
  divide(frame, guides, send);
}

void AnnouncedGroom::divide(const GuideFrame& frame, GuideSource& guides,
                            const std::function<void(GuideChunk&)>& send) {
  if (!accepted_ || frame.revision != accepted_->revision ||
      guides.vertices() != accepted_->guides.vertices())
    return;
  encoder_.encodeAll(frame, guides, [&](GuideChunk& chunk) {
    chunk.groom_id = groom_id_;
    chunk.session = session_;
    send(chunk);
  });
}

}  // namespace strandcast
