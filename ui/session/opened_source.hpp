#pragma once

#include <memory>
#include <string>
#include <vector>

#include "ui/session/session.hpp"

namespace stillpoint {

/// A sequence or a finished run, ready for a Session.
struct OpenedSource {
  std::shared_ptr<const FrameSource> source;
  Config config;
  int frames = 0;          ///< to look at: the sequence's, or those of the finished run
  SessionOptions options;  ///< with the finished run and its baseline in it
  std::string problem;  ///< what is missing though it could be opened, one sentence; empty when all is well
  std::vector<std::string> runs_missing{};  ///< why a run that was to stand beside does not, a sentence each
};

}  // namespace stillpoint
