#include "ui/panels/panels_shared.hpp"

#include "core/inspect/scene_point.hpp"
#include "ui/session/session_view.hpp"

namespace stillpoint {

const PairGeometry& PanelsShared::geometry(const SessionView& session) {
  const auto same = [](const auto& weak, const auto& strong) {
    return !weak.owner_before(strong) && !strong.owner_before(weak);
  };
  if (same(geometry_of_, session.current) && same(geometry_run_, session.run)) return *geometry_;
  geometry_ =
      std::make_shared<const PairGeometry>(pair_geometry(*session.current, *session.run, session.camera));
  geometry_of_ = session.current;
  geometry_run_ = session.run;
  return *geometry_;
}

}  // namespace stillpoint
