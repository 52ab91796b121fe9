#pragma once

#include <chrono>
#include <memory>
#include <string>
#include <thread>
#include <utility>

#include "core/sequence/source.hpp"
#include "ui/workbench/app_controller.hpp"

namespace stillpoint::testing {

inline constexpr int kDemoFrames = 10;

/// Without times, which differ from run to run.
inline OpenedSource untimed(std::shared_ptr<const FrameSource> source, const Config& config) {
  OpenedSource place{.source = std::move(source), .config = config, .options = {}, .problem = {}};
  place.options.keep_times = false;
  return place;
}

inline ControllerOptions controller_options() {
  Config config;
  config.run.method = "stillpoint";
  return {.open_source =
              [](const std::string& where, const Config& wanted, const std::vector<std::string>&) {
                OpenOptions options;
                options.frames = where.starts_with("generated:") ? kDemoFrames : 0;
                return untimed(open_sequence(where, options), wanted);
              },
          .config = config,
          .settings = {},
          .marks_folder = {},
          .plays_when_opened = "generated:walking_static",
          .wake = {}};
}

/// Draws until `holds()`, for five minutes at the most.
template <typename Draw, typename Condition>
bool draw_until(Draw draw, Condition holds) {
  const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(300);
  while (!holds() && std::chrono::steady_clock::now() < end) {
    draw();
    std::this_thread::sleep_for(std::chrono::milliseconds(3));
  }
  return holds();
}

}  // namespace stillpoint::testing
