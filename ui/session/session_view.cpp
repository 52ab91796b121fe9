#include "ui/session/session_view.hpp"

namespace stillpoint {

SessionView with_preview(const SessionView& session) {
  SessionView other = session;
  other.current = session.debug.preview;
  if (session.debug.previewed) other.config = *session.debug.previewed;
  return other;
}

}  // namespace stillpoint
