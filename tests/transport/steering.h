#pragma once
#include <gtest/gtest.h>

#include <chrono>
#include <thread>

#include "sample_messages.h"
#include "transport/publisher.h"
#include "transport/subscriber.h"
#include "true_within.h"

namespace strandcast {

/// Expects that a subscriber without frames commands this daemon, receives no hair, and is not counted as a
/// reader.
inline void expectSteersAlone(Publisher& publisher, Subscriber& subscriber) {
  using std::chrono::milliseconds;
  const GroomDescription groom = uniformGroom(20, 4);
  publisher.announce(groom, sampleBody(60));
  Status status;
  status.backend = "simd";
  for (uint64_t number = 1; number <= 20; ++number) {
    publisher.publish(sampleFrame(groom, number));
    publisher.publishStatus(status);
    std::this_thread::sleep_for(milliseconds(20));
  }
  Command command;
  command.id = 42;
  subscriber.send(command);
  EXPECT_TRUE(trueWithin(milliseconds(5000), [&] { return publisher.takeCommand().has_value(); }));
  status.last_command = 42;
  publisher.publishStatus(status);
  EXPECT_EQ(subscriber.waitForAnswer(42, milliseconds(5000)), "");
  EXPECT_EQ(subscriber.status()->backend, "simd");
  EXPECT_EQ(publisher.matchedReaders(), 0u);
  EXPECT_FALSE(subscriber.groom());
  EXPECT_EQ(subscriber.statistics().frames_received, 0u);
  EXPECT_EQ(subscriber.statistics().chunks_rejected, 0u);
}

}  // namespace strandcast
