#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace stillpoint {

/// The stamps of a topic's messages, as far as they are to be believed.
struct BagStamps {
  std::vector<std::int64_t> stamps;  ///< ns, one a message
  /// What was wrong and what was done, the end of a sentence that begins with the topic; empty = nothing.
  std::string told;
};

/// The times of recording, always there, take the stamps' place:
/// - where all stamps are the same;
/// - for messages whose stamp is 0 though others have one, less the usual time between stamp and recording;
/// - where the clock was set back once, so that the stamps of two stretches lie among one another. Messages
///   that came late are no such stretch: their stamps fill the gap that they left.
/// @param recorded ns, as many as stamps, not decreasing
[[nodiscard]] BagStamps settle_bag_stamps(std::vector<std::int64_t> stamps,
                                          const std::vector<std::int64_t>& recorded);

}  // namespace stillpoint
