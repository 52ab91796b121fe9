#include "ui/session/session_view.hpp"

#include "core/check/findings.hpp"
#include "core/inspect/frame_view.hpp"
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

}  // namespace stillpoint
