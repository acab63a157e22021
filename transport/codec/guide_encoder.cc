#include "transport/codec/guide_encoder.h"

#include <algorithm>
#include <condition_variable>
#include <exception>
#include <mutex>
#include <thread>

namespace strandcast {
namespace {

int encodingThreads(int asked) {
  const int there = std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
  return std::min({asked > 0 ? asked : there, there, kMaxEncodingThreads});
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
  void encodeAll(const GuideFrame& frame, uint32_t count, const Send& send) {
    std::unique_lock lock(mutex_);
    frame_ = &frame;
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
    Slot& slot = slotOf(index);
    ++under_way_;
    lock.unlock();
    std::exception_ptr failure;
    try {
      slot.report = slot.encoder.encode(frame, index, slot.chunk);
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
  report_ = {nameOf(options.codec), options.codec == Codec::kFloat32 ? 0.0 : double{options.max_error}};
  reported_frame_ = 0;
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
  const ChunkReport report = own_.encode(frame, index, chunk);
  add(frame, chunk, report);
}

void GuideEncoder::encodeAll(const GuideFrame& frame, const std::function<void(GuideChunk&)>& send) {
  const auto count = static_cast<uint32_t>(groom_.runs.size());
  if (threads_ == 1 || count <= 1) {
    for (uint32_t i = 0; i < count; ++i) {
      encode(frame, i, own_chunk_);
      send(own_chunk_);
    }
    return;
  }
  if (!pool_) pool_ = std::make_unique<EncoderPool>(threads_, groom_, coder_);
  pool_->encodeAll(frame, count, [&](GuideChunk& chunk, const ChunkReport& report) {
    add(frame, chunk, report);
    send(chunk);
  });
}

}  // namespace strandcast
