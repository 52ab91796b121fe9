#include "ui/session/session_view.hpp"

#include <fmt/format.h>

#include "core/check/findings.hpp"
#include "core/inspect/frame_view.hpp"
#include "core/inspect/run_view.hpp"
#include "core/motion/methods.hpp"
#include "core/odometry/engines.hpp"
#include "core/run/removal_errors.hpp"
#include "core/run/saved_map.hpp"
#include "core/run/sweep.hpp"

namespace stillpoint {

bool shows_preview(const SessionView& session) {
  return session.debug.preview != nullptr && session.debug.preview->index == session.current->index;
}

SessionView with_preview(const SessionView& session) {
  SessionView other = session;
  other.current = session.debug.preview;
  if (session.debug.previewed) other.config = *session.debug.previewed;
  return other;
}

std::string baseline_name(const SessionView& session) { return session.baseline->name + " (baseline)"; }

const std::string& maker_of(const SessionView& session) {
  return session.outside.empty() ? session.config.run.method : session.outside;
}

const std::string& judge_of(const SessionView& session) {
  const std::string& stand_in = method_of(session.config).without_depth;
  const Frame& frame = session.current->frame;
  const bool by_run = stand_in.empty() || !frame.readable() || frame.has_depth();
  return by_run ? session.config.run.method : stand_in;
}

std::string run_words(const SessionView& session) {
  if (!session.outside.empty()) return "another program's run " + session.outside;
  const std::string& judge = judge_of(session);
  if (judge == session.config.run.method) return run_words(session.config);
  Config judged = session.config;
  judged.run.method = judge;
  return fmt::format("{} in {}'s place", run_words(judged), session.config.run.method);
}

}  // namespace stillpoint
