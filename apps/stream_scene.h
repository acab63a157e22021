#pragma once
#include <memory>

#include "transport/subscriber.h"

namespace strandcast {

/// The groom and body that a stream's frames are drawn or recorded with.
struct StreamScene {
  std::shared_ptr<const GroomDescription> groom;
  std::shared_ptr<const BodyDescription> body;

  /// What has arrived so far. Groom and body arrive separately: one may be missing, or they may be of two
  /// daemons.
  static StreamScene of(const Subscriber& subscriber) { return {subscriber.groom(), subscriber.body()}; }

  /// Whether both have arrived and match the frame's session and revision.
  bool fits(const GuideFrame& frame) const {
    const auto is_of_it = [&](const auto& description) {
      return description && description->session == frame.session && description->revision == frame.revision;
    };
    return is_of_it(groom) && is_of_it(body);
  }
  bool operator==(const StreamScene&) const = default;
};

}  // namespace strandcast
